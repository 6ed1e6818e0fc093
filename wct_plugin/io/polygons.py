"""Quads and polygons of surfaces, split into triangles on the corners they have."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import read_limit
from wct_plugin.io.raw_mesh import RawBlock, RawMesh

Corners = NDArray[np.int64]

#: Corners of a face that a message shows all of.
_SHOWN = 12


def as_triangles(raw: RawMesh) -> RawMesh:
    """A surface with its quads and polygons split, which a note says; any other mesh as it is.

    Data and sets of a face are those of each of its triangles.
    """
    kinds = {block.type for block in raw.cells if len(block)}
    if not kinds & {"quad", "polygon"} or kinds - {"quad", "polygon", "triangle", "line", "vertex"}:
        return raw
    pieces = [block.data.shape[1] - 2 if block.type in ("quad", "polygon") else 1 for block in raw.cells]
    counts = {"quads": 0, "polygons": 0}
    cells = []
    for block in raw.cells:
        if block.type in ("quad", "polygon"):
            counts[f"{block.type}s"] += len(block)
            cells.append(RawBlock("triangle", split(raw.points, block.data).reshape(-1, 3)))
        else:
            cells.append(block)
    said = " and ".join(f"{count} {name if count > 1 else name[:-1]}" for name, count in counts.items() if count)
    raw.notes.append(f"{said} split into triangles")
    return replace(
        raw,
        cells=cells,
        cell_data={name: _each(columns, pieces, _repeated) for name, columns in raw.cell_data.items()},
        cell_sets={name: _each(columns, pieces, _members) for name, columns in raw.cell_sets.items()},
    )


def _each(columns: list[Any], pieces: list[int], change: Any) -> list[Any]:
    return [
        values if values is None or count == 1 else change(np.asarray(values), count)
        for values, count in zip(columns, pieces, strict=False)
    ]


def _repeated(values: NDArray[Any], count: int) -> NDArray[Any]:
    read_limit.claim(values.nbytes * (count - 1), "data of faces, for each of their triangles")
    return np.repeat(values, count, axis=0)


def _members(members: NDArray[Any], count: int) -> NDArray[Any]:
    return (members[:, None] * count + np.arange(count)).ravel()


def split(points: NDArray[np.floating], faces: Corners) -> Corners:
    """Triangles of faces with one number of corners, (k, n) to (k, n - 2, 3), turned as the faces are.

    A quad is split by its shorter diagonal, or by the one that lies inside; a polygon with more corners from one of
    them, or by cutting ears where it is not convex.
    """
    count = faces.shape[1]
    if count < 3:
        raise InputError(f"face 0 has {count} corners; allowed are 3 and more")
    if len(faces) and (faces.min() < 0 or faces.max() >= len(points)):
        row = int(np.flatnonzero(((faces < 0) | (faces >= len(points))).any(axis=1))[0])
        wrong = next(index for index in faces[row].tolist() if not 0 <= index < len(points))
        shown = f"is {tuple(faces[row].tolist())}" if count <= _SHOWN else f"of {count} corners has {wrong}"
        raise InputError(f"face {row} {shown}; indices must lie in 0..{len(points) - 1}")
    if count == 3:
        return faces[:, None]
    places = np.asarray(points, dtype=np.float64)[faces]
    made = _quads(places) if count == 4 else _fans(places)
    return np.take_along_axis(faces[:, None], made.reshape(len(faces), 1, -1), axis=2).reshape(len(faces), -1, 3)


def _quads(places: NDArray[np.float64]) -> NDArray[np.int64]:
    """By the shorter diagonal of those whose two triangles are turned alike; places of the corners, (k, 2, 3)."""
    ways = np.array([[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]])
    areas = _areas(places[:, ways.reshape(4, 3)]).reshape(-1, 2, 2, 3)
    inside = (areas[:, :, 0] * areas[:, :, 1]).sum(axis=2) > 0
    lengths = np.linalg.norm(places[:, [2, 3]] - places[:, [0, 1]], axis=2)
    lengths[~inside & inside.any(axis=1)[:, None]] = np.inf
    chosen: NDArray[np.int64] = ways[(lengths[:, 1] < lengths[:, 0]).astype(int)]
    return chosen


def _fans(places: NDArray[np.float64]) -> NDArray[np.int64]:
    """From the first corner where all triangles are turned as the face is; else by ears."""
    size = places.shape[1]
    fan = np.column_stack([np.zeros(size - 2, int), np.arange(1, size - 1), np.arange(2, size)])
    made = np.repeat(fan[None], len(places), axis=0)
    normals = _normals(places)
    turned = np.einsum("kti,ki->kt", _areas(places[:, fan]), normals)
    for row in np.flatnonzero((turned <= 0).any(axis=1)).tolist():
        made[row] = _ears(_flat(places[row], normals[row]))
    return made


def _areas(triangles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Twice the areas, along the normals."""
    a, b, c = np.moveaxis(triangles, -2, 0)
    areas: NDArray[np.float64] = np.cross(b - a, c - a)
    return areas


def _normals(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Newell's normals, which need neither planar nor convex faces."""
    middle = places - places.mean(axis=1, keepdims=True)
    normals: NDArray[np.float64] = np.cross(middle, np.roll(middle, -1, axis=1)).sum(axis=1)
    return normals


def _flat(places: NDArray[np.float64], normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """The corners seen against the normal: in the plane without its largest coordinate, turned to the left."""
    axis = int(np.abs(normal).argmax())
    others = [(axis + 1) % 3, (axis + 2) % 3]
    flat: NDArray[np.float64] = places[:, others if normal[axis] >= 0 else others[::-1]]
    return flat


def _ears(flat: NDArray[np.float64]) -> list[list[int]]:
    """Triangles of a polygon turned to the left: again and again the ear with the shortest new edge is cut off.

    Where there is no ear, as in polygons that cross themselves, the corner that turns most to the left is one.
    """
    left = list(range(len(flat)))
    triangles = []
    while len(left) > 3:
        best: tuple[bool, float, int] | None = None
        for place in range(len(left)):
            before, corner, after = left[place - 1], left[place], left[(place + 1) % len(left)]
            turn = _turn(flat[before], flat[corner], flat[after])
            ear = turn > 0 and not _holds(flat, (before, corner, after), left)
            cost = float(np.linalg.norm(flat[after] - flat[before]) if ear else -turn)
            if best is None or (not ear, cost) < best[:2]:
                best = (not ear, cost, place)
        assert best is not None
        place = best[2]
        triangles.append([left[place - 1], left[place], left[(place + 1) % len(left)]])
        del left[place]
    return [*triangles, left]


def _holds(flat: NDArray[np.float64], ear: tuple[int, int, int], left: list[int]) -> bool:
    """Whether another corner lies in the triangle or on it, at none of its corners."""
    a, b, c = flat[list(ear)]
    others = flat[[corner for corner in left if corner not in ear]]
    inside = (_turn(a, b, others) >= 0) & (_turn(b, c, others) >= 0) & (_turn(c, a, others) >= 0)
    at_corner = (others[:, None] == flat[list(ear)]).all(axis=2).any(axis=1)
    return bool((inside & ~at_corner).any())


def _turn(a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]) -> NDArray[np.float64]:
    """Twice the signed area of a triangle in the plane."""
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
