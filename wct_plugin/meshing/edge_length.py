"""The option of a wanted edge length: one number, one per point, the name of a field of the mesh, or one per group."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from wct_plugin.errors import OptionError
from wct_plugin.mesh import TetMesh
from wct_plugin.meshing import per_group
from wct_plugin.meshing.grouped_lengths import lengths_of_groups
from wct_plugin.types import Floats

EdgeLength = float | str | dict[str, float] | Floats | None

_KINDS = "must be a number, an array of one per point, the name of point data, or a number per region or group"


def parse(value: Any) -> EdgeLength:
    """Check what can be checked without the mesh; the command line gives numbers and mappings as text.

    Raises :class:`ValueError`, naming index or group and value where one of many is wrong.
    """
    if value is None:
        return None
    if isinstance(value, str):
        if "=" in value:
            return _per_group(per_group.parse(value))
        try:
            value = float(value)
        except ValueError:
            return str(value)
    if isinstance(value, Mapping):
        return _per_group(value)
    try:
        lengths = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(_KINDS) from None
    if isinstance(value, bool) or lengths.ndim > 1:
        raise ValueError(_KINDS)
    if lengths.ndim == 0:
        if not 0 < lengths < np.inf:
            raise ValueError("input should be greater than 0 and finite")
        return float(lengths)
    _check(lengths)
    lengths.setflags(write=False)
    return lengths


def at_points(wanted: EdgeLength, mesh: TetMesh) -> Floats | None:
    """(n,) the wanted length at each point of the mesh, None where none is wanted.

    Raises :class:`OptionError` for an array of another length, for a field that is missing or has no use as lengths,
    and for a group that the mesh has not.
    """
    if wanted is None:
        return None
    if isinstance(wanted, float):
        return np.full(len(mesh.points), wanted)
    if isinstance(wanted, dict):
        return lengths_of_groups(wanted, mesh)
    what = "option 'edge_length'"
    if isinstance(wanted, str):
        if wanted not in mesh.point_data:
            known = ", ".join(map(repr, mesh.point_data)) or "none"
            raise OptionError(f"{what} is {wanted!r}; it must be a number or one of the mesh's point data: {known}")
        values = mesh.point_data[wanted]
        what = f"{what}: point data {wanted!r}"
        if values.dtype.kind not in "fiu":
            raise OptionError(f"{what} has type {values.dtype}; numbers are needed")
        wanted = values.astype(np.float64)
    if wanted.shape != (len(mesh.points),):
        raise OptionError(f"{what} has shape {wanted.shape}; the mesh needs ({len(mesh.points)},), one per point")
    try:
        _check(wanted)
    except ValueError as error:
        raise OptionError(f"{what} {error}") from None
    return wanted


def _per_group(given: Mapping[Any, Any]) -> dict[str, float]:
    if not given:
        raise ValueError("names no region or group")
    found = {}
    for name, value in given.items():
        try:
            length = np.nan if isinstance(value, bool) else float(value)
        except (TypeError, ValueError):
            length = np.nan
        if not 0 < length < np.inf:
            raise ValueError(f"says {value!r} of {name!r}; a number greater than 0 and finite is needed")
        found[str(name)] = length
    return found


def _check(lengths: Floats) -> None:
    bad = np.flatnonzero(~((lengths > 0) & (lengths < np.inf)))
    if len(bad):
        raise ValueError(f"holds {lengths[bad[0]]:g} at index {bad[0]}; all must be positive and finite")
