"""Copies of one mesh of the unit cube, one per voxel, joined into a mesh without a seam.

A voxel whose index along an axis is odd has the copy reflected along that axis, so that two neighbours are always each
other's mirror image and any cube's faces match. The vertices of the cube lie on its corners, edges, faces and inside;
those of the joined mesh are numbered by where in the grid that is, in integers: no two are compared as numbers with
decimals.
"""

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.mesh import Cells
from wct_plugin.mesh.topology import FACETS
from wct_plugin.types import Floats, Ints

#: Coordinates of the cube become multiples of this, so that sums with a voxel's index are exact, all copies congruent.
_GRAIN = 2.0**-20
_CHUNK = 1024  # voxels
#: All that a voxel has of the grid: low side, inside, high side of each axis.
_GRID = np.array(list(np.ndindex(3, 3, 3)))


def snapped(points: Floats) -> Floats:
    """Points of the unit cube in multiples of 2 ** -20."""
    rounded: Floats = np.round(points / _GRAIN) * _GRAIN
    return rounded


@dataclass(frozen=True, eq=False)
class _Cube:
    """The vertices of a cube's mesh by what they lie on: low side, inside or high side (0, 1, 2) of each axis."""

    sides: NDArray[np.int8]  #: (v, 3)
    place: Ints  #: (v,) which of the vertices on the same corner, edge, face or inside it is
    count: Ints  #: (3, 3, 3) how many there are

    @classmethod
    def of(cls, points: Floats) -> "_Cube":
        sides = (1 - (points == 0) + (points == 1)).astype(np.int8)
        count = np.zeros((3, 3, 3), dtype=np.int64)
        place = np.empty(len(points), dtype=np.int64)
        for vertex, side in enumerate(map(tuple, sides)):
            place[vertex] = count[side]
            count[side] += 1
        return cls(sides, place, count)


def assemble(cells: Ints, points: Floats, tets: Ints) -> tuple[Floats, NDArray[Any], Cells]:
    """Points (n, 3), in voxels, positive tets (m k, 4) of the voxels ``cells`` (k, 3), in their order; the boundary.

    Its facets are tagged by the way they face, 1 to 6: down and up each axis.

    The tets come as int32 where that suffices: with as little as that beside it a mesh of them can be made.
    ``points`` (v, 3) and ``tets`` (m, 4) mesh the unit cube, :func:`snapped`.
    """
    cube = _Cube.of(points)
    shape = 2 * cells.max(axis=0) + 3  # of the grid whose even numbers are the planes between voxels
    keys, counts = _numbering(cells, cube, shape)
    total = int(counts.sum())
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    outside = _without_neighbour(cells)
    facets, tags = [], []
    index = np.int32 if total < 2**31 else np.int64
    made_points = np.empty((total, 3))
    made_tets = np.empty((len(cells), len(tets), 4), dtype=index)
    for flips in product((0, 1), repeat=3):
        mine = np.flatnonzero((cells % 2 == flips).all(axis=1))
        reflected = np.where(flips, 1.0 - points, points)
        sides = np.where(flips, 2 - cube.sides, cube.sides)
        corners = tets[:, [0, 1, 3, 2]] if sum(flips) % 2 else tets
        on_sides = _facets_on_sides(reflected, corners)
        for chunk in np.split(mine, range(_CHUNK, len(mine), _CHUNK)):
            begin = first[np.searchsorted(keys, _keys(2 * cells[chunk, None] + _GRID, shape))]
            vertices = begin[:, sides @ (9, 3, 1)] + cube.place
            made_points[vertices] = cells[chunk, None] + reflected
            made_tets[chunk] = vertices.astype(index)[:, corners]
            for side, triangles in enumerate(on_sides):
                found = vertices[outside[chunk, side]][:, triangles].reshape(-1, 3)
                facets.append(found)
                tags.append(np.full(len(found), side + 1))
    return made_points, made_tets.reshape(-1, 4), Cells(np.concatenate(facets), np.concatenate(tags))


def _facets_on_sides(points: Floats, tets: Ints) -> list[Ints]:
    """The triangles of a mesh of the unit cube on each side of it, down and up each axis, oriented outward."""
    triangles = tets[:, FACETS].reshape(-1, 3)
    corners = points[triangles]
    return [triangles[(corners[:, :, axis] == end).all(axis=1)] for axis in range(3) for end in (0.0, 1.0)]


def _without_neighbour(cells: Ints) -> NDArray[np.bool_]:
    """(k, 6) on which sides, down and up each axis, there is no voxel."""
    shape = cells.max(axis=0) + 3
    keys = np.sort(_keys(cells + 1, shape))
    steps = np.repeat(np.eye(3, dtype=np.int64), 2, axis=0) * np.tile([[-1], [1]], (3, 1))
    beside = _keys(cells[:, None] + 1 + steps, shape)
    at = np.minimum(np.searchsorted(keys, beside), len(keys) - 1)
    found: NDArray[np.bool_] = keys[at] != beside
    return found


def _numbering(cells: Ints, cube: _Cube, shape: Ints) -> tuple[Ints, Ints]:
    """The keys, ascending, of all corners, edges, faces and insides of the voxels, and how many vertices each has."""
    keys = np.unique(np.concatenate([np.unique(_keys(2 * cells + offset, shape)) for offset in _GRID]))
    at = np.stack(np.unravel_index(keys, tuple(shape)), axis=1)
    half = at // 2
    # Even: on the plane `half`, which is the low side of the cube where even. Odd: within a voxel.
    i, j, k = np.where(at % 2, 1, 2 * (half % 2)).T
    return keys, cube.count[i, j, k]


def _keys(at: Ints, shape: Ints) -> Ints:
    keys: Ints = (at[..., 0] * shape[1] + at[..., 1]) * shape[2] + at[..., 2]
    return keys
