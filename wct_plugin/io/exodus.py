"""Exodus II files of Cubit, MOOSE and Sierra: blocks are regions, side sets tagged facets, node sets named points."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import netcdf
from wct_plugin.io.assembly import NAME
from wct_plugin.io.netcdf import Variables
from wct_plugin.io.node_orders import from_sides_first
from wct_plugin.io.raw_mesh import RawBlock, RawMesh

_WANTED = (
    "coord",
    "connect",
    "eb_",
    "ss_",
    "ns_",
    "elem_ss",
    "side_ss",
    "node_ns",
    "name_",
    "vals_",
    "time_",
    "attrib",
)
#: By the beginning of a type's name and the number of points: meshio's name, and the dimension.
_KINDS = {
    ("TET", 4): ("tetra", 3), ("TET", 10): ("tetra10", 3), ("TRI", 3): ("triangle", 2), ("TRI", 6): ("triangle6", 2),
    ("SHE", 3): ("triangle", 2), ("SHE", 6): ("triangle6", 2), ("SHE", 4): ("quad", 2), ("SHE", 8): ("quad8", 2),
    ("SHE", 9): ("quad9", 2), ("QUA", 4): ("quad", 2), ("QUA", 8): ("quad8", 2), ("QUA", 9): ("quad9", 2),
    ("HEX", 8): ("hexahedron", 3), ("HEX", 20): ("hexahedron20", 3), ("HEX", 27): ("hexahedron27", 3),
    ("WED", 6): ("wedge", 3), ("WED", 15): ("wedge15", 3), ("PYR", 5): ("pyramid", 3), ("PYR", 13): ("pyramid13", 3),
    ("BAR", 2): ("line", 1), ("BEA", 2): ("line", 1), ("TRU", 2): ("line", 1), ("ROD", 2): ("line", 1),
    ("EDG", 2): ("line", 1), ("BAR", 3): ("line3", 1), ("BEA", 3): ("line3", 1), ("TRU", 3): ("line3", 1),
    ("EDG", 3): ("line3", 1), ("SPH", 1): ("vertex", 0), ("CIR", 1): ("vertex", 0), ("POI", 1): ("vertex", 0),
}  # fmt: skip
#: Corners of the sides of a cell, in Exodus's order; shells have two faces before their edges.
_SIDES: dict[str, list[tuple[int, ...]]] = {
    "tetra": [(0, 1, 3), (1, 2, 3), (0, 3, 2), (0, 2, 1)],
    "tetra10": [(0, 1, 3), (1, 2, 3), (0, 3, 2), (0, 2, 1)],
    "hexahedron": [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (0, 4, 7, 3), (0, 3, 2, 1), (4, 5, 6, 7)],
    "wedge": [(0, 1, 4, 3), (1, 2, 5, 4), (0, 3, 5, 2), (0, 2, 1), (3, 4, 5)],
    "pyramid": [(0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 4, 3), (0, 3, 2, 1)],
    "triangle": [(0, 1, 2), (0, 2, 1), (0, 1), (1, 2), (2, 0)],
}
_FACETS = {2: "line", 3: "triangle", 4: "quad"}
#: The array of the numbers of blocks and side sets.
_TAGS = "cell_tags"


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the file holds, and what of it is left out. Raises :class:`InputError` without the file's name."""
    found = netcdf.read(path, _WANTED)
    lost: list[str] = []
    raw = RawMesh(_points(found), [])
    tags: list[NDArray[Any]] = []
    _blocks(raw, found, tags)
    raw.cell_data = {_TAGS: tags, **_cell_data(raw, found)}  # type: ignore[dict-item]
    _side_sets(raw, found)
    _node_sets(raw, found)
    for name, values in zip(found.texts("name_nod_var"), _node_values(found), strict=False):
        raw.point_data[name] = values
    times = _list_of(found, "time_whole")
    if len(times) > 1 and any(name.startswith("vals_") for name in found):
        raw.notes.append(f"has {len(times)} steps; the last at time {times[-1]:g} is taken")
    if kept := [name for name in found if name.startswith("attrib")]:
        lost.append(f"attributes of {len(kept)} blocks")
    return raw, lost


def _points(found: Variables) -> NDArray[Any]:
    if "coord" in found:
        if found["coord"].ndim != 2:
            raise InputError(f"has coordinates of shape {found['coord'].shape}; expected rows of x, y and z")
        return found["coord"].T
    axes = [found[f"coord{axis}"] for axis in "xyz" if f"coord{axis}" in found]
    if not axes:
        raise InputError("has no coordinates; is it an Exodus file?")
    if len({axis.shape for axis in axes}) > 1 or axes[0].ndim != 1:
        raise InputError(f"has coordinates of shapes {' and '.join(str(axis.shape) for axis in axes)}")
    return np.column_stack(axes)


def _ids(found: Variables, what: str, count: int) -> list[int]:
    """The numbers of blocks or sets; Exodus counts from 1 where it has none."""
    given = _list_of(found, f"{what}_prop1").tolist()
    if not given and count > len(found):  # numbers in names need not be those of variables that are there
        raise InputError(f"has {what}_{count} among {len(found)} variables; they must be numbered one after the other")
    if given and count > len(given):
        raise InputError(f"has {what}_{count}, but {what}_prop1 numbers {len(given)} of them")
    return [int(number) for number in given] or list(range(1, count + 1))


def _list_of(found: Variables, name: str) -> NDArray[Any]:
    """The numbers of a variable, or none where there is no such. Raises :class:`InputError` for what is no list."""
    values = found.get(name, np.empty(0))
    if values.ndim != 1 or values.dtype.kind not in "iuf":
        raise InputError(f"has {values.dtype} of shape {values.shape} as variable {name!r}; expected a list of numbers")
    return values


def _names(found: Variables, what: str, ids: list[int]) -> list[str]:
    given = found.texts(f"{what}_names") + [""] * len(ids)
    return given[: len(ids)]


def _numbered(found: Variables, prefix: str) -> list[int]:
    """The numbers behind the prefix in the names of variables: of blocks or sets that are there, empty ones are not."""
    return sorted(int(name.removeprefix(prefix)) for name in found if name.removeprefix(prefix).isdigit())


def _name(raw: RawMesh, name: str, tag: int, dimension: int) -> None:
    if name and NAME + name not in raw.field_data:
        raw.field_data[NAME + name] = np.array([tag, dimension])


def _blocks(raw: RawMesh, found: Variables, tags: list[NDArray[Any]]) -> None:
    numbers = _numbered(found, "connect")
    ids = _ids(found, "eb", max(numbers, default=0))
    names = _names(found, "eb", ids)
    for number in numbers:
        cells = found[f"connect{number}"]
        if cells.ndim != 2:
            raise InputError(f"has variable 'connect{number}' of shape {cells.shape}; expected rows of points")
        given = found.types.get(f"connect{number}", "")
        key = given.upper()[:3], cells.shape[-1]
        if key not in _KINDS:
            raise InputError(f"block {ids[number - 1]} has cells of type {given!r} with {cells.shape[-1]} points")
        kind, dimension = _KINDS[key]
        raw.cells.append(RawBlock(kind, from_sides_first(kind, cells.astype(np.int64) - 1)))
        tags.append(np.full(len(cells), ids[number - 1]))
        _name(raw, names[number - 1], ids[number - 1], dimension)


def _cell_data(raw: RawMesh, found: Variables) -> dict[str, list[NDArray[Any] | None]]:
    """The variables of cells at the last step; a block need not have each."""
    made: dict[str, list[NDArray[Any] | None]] = {}
    for k, name in enumerate(found.texts("name_elem_var"), start=1):
        columns = [found.get(f"vals_elem_var{k}eb{block}") for block in _numbered(found, "connect")]
        if any(column is not None and len(column) for column in columns):
            made[name] = [
                np.full(len(block), np.nan) if column is None or not len(column) else column[-1]
                for block, column in zip(raw.cells, columns, strict=True)
            ]
    return made


def _node_values(found: Variables) -> list[NDArray[Any]]:
    if "vals_nod_var" in found:  # an older form: steps, variables, points
        return list(found["vals_nod_var"][-1]) if len(found["vals_nod_var"]) else []
    arrays = [found[f"vals_nod_var{k}"] for k in _numbered(found, "vals_nod_var")]
    return [array[-1] for array in arrays if len(array)]


def _side_sets(raw: RawMesh, found: Variables) -> None:
    """Facets of all side sets, each once, tagged by the first set it is in; sets that lose by this are sets too."""
    numbers = _numbered(found, "elem_ss")
    ids = _ids(found, "ss", max(numbers, default=0))
    names = _names(found, "ss", ids)
    owned = list(raw.cells)
    gathered: dict[str, list[tuple[int, NDArray[np.int64]]]] = {}
    for number in numbers:
        cells, places = (_list_of(found, f"{what}_ss{number}") for what in ("elem", "side"))
        if cells.shape != places.shape:
            raise InputError(f"side set {ids[number - 1]} has {cells.size} cells but {places.size} sides")
        sides = _sides(owned, cells - 1, places - 1, ids[number - 1])
        for kind, facets in sides:
            gathered.setdefault(kind, []).append((number, facets))
            _name(raw, names[number - 1], ids[number - 1], 1 if kind == "line" else 2)
    for kind, parts in gathered.items():
        facets = np.concatenate([cells for _, cells in parts])
        owner = np.repeat([number for number, _ in parts], [len(cells) for _, cells in parts])
        _, first, place = np.unique(np.sort(facets, axis=1), axis=0, return_index=True, return_inverse=True)
        order = np.argsort(first)
        place = np.argsort(order)[place.ravel()]
        first = first[order]
        raw.cells.append(RawBlock(kind, facets[first]))
        for columns in raw.cell_data.values():
            columns.append(None)
        raw.cell_data[_TAGS][-1] = np.array(ids)[owner[first] - 1]
        for sets in raw.cell_sets.values():
            sets.append(None)
        for number in dict.fromkeys(owner.tolist()):
            inside = np.unique(place[owner == number])
            if not names[number - 1] or len(inside) > (owner[first] == number).sum():
                name = names[number - 1] or f"side set {ids[number - 1]}"
                raw.cell_sets.setdefault(name, [None] * len(raw.cells))[-1] = inside


def _sides(
    blocks: list[RawBlock], cells: NDArray[Any], sides: NDArray[Any], name: int
) -> list[tuple[str, NDArray[np.int64]]]:
    """Facets by the numbers of cells, counted over all blocks, and of their sides."""
    starts = np.cumsum([0, *(len(block) for block in blocks)])
    made = []
    if len(cells) and (cells.min() < 0 or cells.max() >= starts[-1]):
        raise InputError(f"side set {name} names cells {cells.min() + 1}..{cells.max() + 1}; there are {starts[-1]}")
    for block, start in zip(blocks, starts, strict=False):
        mine = (cells >= start) & (cells < start + len(block))
        for side in np.unique(sides[mine]).tolist():
            known = _SIDES.get(block.type, [])
            if not 0 <= side < len(known):
                raise InputError(
                    f"side set {name} names side {side + 1} of {block.type} cells, which have {len(known)}"
                )
            corners = known[side]
            rows = (cells[mine & (sides == side)] - start).astype(np.int64)
            made.append((_FACETS[len(corners)], block.data[rows][:, corners]))
    return made


def _node_sets(raw: RawMesh, found: Variables) -> None:
    numbers = _numbered(found, "node_ns")
    ids = _ids(found, "ns", max(numbers, default=0))
    names = _names(found, "ns", ids)
    for number in numbers:
        name = names[number - 1] or f"node set {ids[number - 1]}"
        raw.point_sets[name] = _list_of(found, f"node_ns{number}").astype(np.int64) - 1
