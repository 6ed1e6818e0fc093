"""MED's fields: values per point or cell, at one time or several, for all of a kind or those of a profile."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import hdf5, read_limit
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.text_lines import decoded

_WHOLE = "MED_NO_PROFILE_INTERNAL"


def put(raw: RawMesh, kinds: list[str], file: Any, mesh: str, lost: list[str]) -> None:
    """Give the mesh its fields as arrays; ``kinds`` are MED's names of its blocks, ``lost`` grows by other fields."""
    for name, group in hdf5.children(file.get("CHA", {})):
        of = group.attrs.get("MAI", mesh)
        if (of if isinstance(of, str) else decoded(bytes(of))).strip("\0 ") != mesh:
            lost.append(f"field {name!r}, which is of another mesh")
        else:
            _put_steps(raw, kinds, name, group, file.get("PROFILS", {}), lost)


def _put_steps(raw: RawMesh, kinds: list[str], name: str, group: Any, profiles: Any, lost: list[str]) -> None:
    """All steps of a field: under its name where there is one, else with number and time."""
    steps = sorted(hdf5.children(group))
    for k, (_, step) in enumerate(steps):
        title = name if len(steps) == 1 else f"{name}[{k}] - {float(step.attrs['PDT']):g}"
        for support, data in hdf5.children(step):
            where, _, kind = support.partition(".")
            if where == "NOE" and not kind:
                raw.point_data[title] = _values(data, len(raw.points), profiles)
            elif kinds.count(kind) == 1:
                columns = raw.cell_data.setdefault(title, [None] * len(raw.cells))
                block = kinds.index(kind)
                columns[block] = _values(data, len(raw.cells[block]), profiles)
            else:
                lost.append(f"field {title!r} on {support}")


def _values(data: Any, count: int, profiles: Any) -> NDArray[Any]:
    """A value per entity, NaN where no profile has the entity; several per entity at Gauss points or corners."""
    made: NDArray[Any] | None = None
    for name, part in hdf5.children(data):
        points = hdf5.number(part, "NGA") if "NGA" in part.attrs else 1
        values = hdf5.array(part, "CO")
        rows = np.arange(count) if name == _WHOLE else hdf5.array(profiles[name], "PFL", "iu").astype(np.int64) - 1
        if points < 1 or values.size % (len(rows) * points or 1):
            raise InputError(f"has a field of {values.size} values for {len(rows)} entities")
        if len(rows) and not 0 <= rows.min() <= rows.max() < count:
            raise InputError(
                f"has a profile {name!r} of {rows.min() + 1} to {rows.max() + 1}; allowed are 1 to {count}"
            )
        values = np.moveaxis(values.reshape(-1, len(rows), points), 0, 2)
        if made is None:
            whole = name == _WHOLE
            if not whole:
                size = count * int(np.prod(values.shape[1:])) * values.dtype.itemsize
                read_limit.claim_more(size, values.nbytes, "a field on a profile")
            fill = np.nan if values.dtype.kind == "f" else 0
            made = np.array(values) if whole else np.full((count, *values.shape[1:]), fill, dtype=values.dtype)
        made[rows] = values
    if made is None:
        raise InputError("has a field without values")
    made = made[:, 0] if made.shape[1] == 1 else made
    return made[..., 0] if made.shape[-1] == 1 else made
