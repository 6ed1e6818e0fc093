"""A mesh in several pieces, as parallel programs write them: ghosts are dropped, shared points become one."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io.raw_mesh import RawBlock, RawMesh

#: VTK's array of bits that says why a cell or point does not count, and its older form, a level.
_GHOSTS = ("vtkGhostType", "vtkGhostLevels")
#: The number of a point in the whole, as VTK and ParaView keep it.
_GLOBAL = "GlobalPointIds"
#: The faces of a tet, by the corners' places, and of a triangle, which are its edges.
_SIDES = {"tetra": ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)), "triangle": ((0, 1), (0, 2), (1, 2))}


def without_ghosts(raw: RawMesh) -> RawMesh:
    """The mesh without the cells that are another piece's too, and without the points that only these had."""
    name = next((name for name in _GHOSTS if name in raw.cell_data), None)
    for given in _GHOSTS:
        raw.point_data.pop(given, None)
    if name is None:
        return raw
    columns = raw.cell_data.pop(name)
    keep = [
        np.ones(len(block), bool) if ghost is None else ghost == 0
        for block, ghost in zip(raw.cells, columns, strict=True)
    ]
    dropped = sum(int((~kept).sum()) for kept in keep)
    if not dropped:
        return raw
    _checked(raw)
    ghostly, needed = np.zeros(len(raw.points), bool), np.zeros(len(raw.points), bool)
    for block, kept in zip(raw.cells, keep, strict=True):
        ghostly[block.data[~kept].ravel()] = True
        needed[block.data[kept].ravel()] = True
    stay = needed | ~ghostly
    number = np.cumsum(stay) - 1
    return replace(
        raw,
        points=raw.points[stay],
        cells=[RawBlock(block.type, number[block.data[kept]]) for block, kept in zip(raw.cells, keep, strict=True)],
        point_data={name: values[stay] for name, values in raw.point_data.items()},
        cell_data={
            name: [None if values is None else values[kept] for values, kept in zip(columns, keep, strict=True)]
            for name, columns in raw.cell_data.items()
        },
        notes=[*raw.notes, f"{dropped} ghost cells dropped"],
    )


def _checked(raw: RawMesh) -> RawMesh:
    """The mesh, whose cells name none but its own points."""
    for block in raw.cells:
        if len(block) and not 0 <= block.data.min() <= block.data.max() < len(raw.points):
            outside = block.data.max() if block.data.max() >= len(raw.points) else block.data.min()
            raise InputError(f"has a {block.type} cell with point {outside}; allowed are 0 to {len(raw.points) - 1}")
    return raw


def joined(pieces: list[RawMesh], lost: list[str]) -> RawMesh:
    """The pieces as one mesh. ``lost`` grows by arrays that only some pieces have.

    Points of different pieces become one where both have the same global number; without such numbers where both lie
    on the boundary of their pieces, at the same coordinates to the bit.
    """
    pieces = [without_ghosts(piece) for piece in pieces]
    filled = [piece for piece in pieces if sum(len(block) for block in piece.cells) or len(piece.points)]
    if len(filled) <= 1:
        return (filled or pieces)[0]
    starts = np.cumsum([0, *(len(_checked(piece).points) for piece in filled)])
    made = RawMesh(np.concatenate([piece.points for piece in filled]), [])
    for start, piece in zip(starts, filled, strict=False):
        made.cells += [RawBlock(block.type, block.data + start) for block in piece.cells]
    for name, parts in _common("point data", [piece.point_data for piece in filled], lost).items():
        made.point_data[name] = np.concatenate(parts)
    for name, columns in _common("cell data", [piece.cell_data for piece in filled], lost).items():
        made.cell_data[name] = [values for part in columns for values in part]
    for piece in filled:
        made.field_data |= piece.field_data
    made.notes = list(dict.fromkeys(note for piece in filled for note in piece.notes))
    merged = _merge(made, filled, starts)
    made.notes.append(f"{len(filled)} pieces joined, {merged} points that two or more of them have made one")
    return made


def _common(what: str, given: list[dict[str, Any]], lost: list[str]) -> dict[str, list[Any]]:
    names = list(dict.fromkeys(name for data in given for name in data))
    everywhere = [name for name in names if all(name in data for data in given)]
    lost += [f"{what} {name!r}, which some pieces lack" for name in names if name not in everywhere]
    return {name: [data[name] for data in given] for name in everywhere}


def _merge(made: RawMesh, pieces: list[RawMesh], starts: NDArray[np.int64]) -> int:
    """Make shared points one, the first; returns how many went."""
    piece = np.repeat(np.arange(len(pieces)), np.diff(starts))
    if all(_GLOBAL in one.point_data for one in pieces):
        rows, keys = np.arange(len(made.points)), made.point_data[_GLOBAL]
        if any(len(np.unique(one.point_data[_GLOBAL])) < len(one.points) for one in pieces):
            raise InputError(f"has pieces in which points share a number in {_GLOBAL!r}; allowed are different ones")
    else:
        rows = np.concatenate([_boundary(one) + start for one, start in zip(pieces, starts, strict=False)])
        points = np.ascontiguousarray(made.points[rows] + 0.0)  # -0 is 0
        keys = points.view(np.dtype((np.void, points.dtype.itemsize * points.shape[1]))).ravel()
    _, place = np.unique(keys, return_inverse=True)
    # Points of one piece that lie at the same place, as on both sides of a crack, stay as they are.
    _, first, among = np.unique(np.column_stack([place, piece[rows]]), axis=0, return_index=True, return_counts=True)
    alone = np.ones(place.max(initial=-1) + 1, bool)
    alone[place[first[among > 1]]] = False
    take = np.flatnonzero(alone[place])
    first_at = np.full(len(alone), len(made.points))
    np.minimum.at(first_at, place[take], rows[take])
    target = np.arange(len(made.points))
    target[rows[take]] = first_at[place[take]]
    stay = target == np.arange(len(target))
    number = (np.cumsum(stay) - 1)[target]
    made.points = made.points[stay]
    made.point_data = {name: values[stay] for name, values in made.point_data.items()}
    made.cells = [RawBlock(block.type, number[block.data]) for block in made.cells]
    return int((~stay).sum())


def _boundary(raw: RawMesh) -> NDArray[np.int64]:
    """The points on sides that only one cell of the piece has; all points where there are other kinds of cells."""
    kinds = {block.type for block in raw.cells if len(block)}
    main = next((kind for kind in _SIDES if kind in kinds), None)
    if main is None or kinds - {"tetra", "triangle", "line", "vertex"}:
        return np.arange(len(raw.points))
    cells = np.concatenate([block.data for block in raw.cells if block.type == main])
    sides = np.sort(np.concatenate([cells[:, side] for side in _SIDES[main]]), axis=1)
    distinct, counts = np.unique(sides, axis=0, return_counts=True)
    return np.unique(distinct[counts == 1])
