"""The option of a wanted edge length: one number, one per point, or the name of a field of the mesh."""

from typing import Any

import numpy as np

from wct_plugin.errors import OptionError
from wct_plugin.mesh import TetMesh
from wct_plugin.types import Floats

EdgeLength = float | str | Floats | None


def parse(value: Any) -> EdgeLength:
    """Check what can be checked without the mesh; the command line gives numbers as text.

    Raises :class:`ValueError`, naming index and value where one of many is wrong.
    """
    if value is None:
        return None
    if isinstance(value, str):
        try:
            value = float(value)
        except ValueError:
            return str(value)
    try:
        lengths = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError("must be a number, an array of one per point, or the name of point data") from None
    if isinstance(value, bool) or lengths.ndim > 1:
        raise ValueError("must be a number, an array of one per point, or the name of point data")
    if lengths.ndim == 0:
        if not 0 < lengths < np.inf:
            raise ValueError("input should be greater than 0 and finite")
        return float(lengths)
    _check(lengths)
    lengths.setflags(write=False)
    return lengths


def at_points(wanted: EdgeLength, mesh: TetMesh) -> Floats | None:
    """(n,) the wanted length at each point of the mesh, None where none is wanted.

    Raises :class:`OptionError` for an array of another length and for a field that is missing or has no use as lengths.
    """
    if wanted is None:
        return None
    if isinstance(wanted, float):
        return np.full(len(mesh.points), wanted)
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


def _check(lengths: Floats) -> None:
    bad = np.flatnonzero(~((lengths > 0) & (lengths < np.inf)))
    if len(bad):
        raise ValueError(f"holds {lengths[bad[0]]:g} at index {bad[0]}; all must be positive and finite")
