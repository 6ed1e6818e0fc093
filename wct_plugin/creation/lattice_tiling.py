"""The tilings of space by two tetrahedra, on the lattice of (1, 0, 0), (1/2, a, 0) and (1/2, 0, b).

Vertices are (X / 2, a j, b k) with X = j + k modulo 2. Round each edge from X to X + 2 there are four tets of type 1;
two of type 2 fill what is left beside it. No tet reaches over a plane of constant j or k, so that slabs and prisms
need no cutting. Every tet is completely well-centered if and only if a > 1/2 and b > 1/2.
"""

import numpy as np

from wct_plugin.types import Ints


def block(periods: int, p: int, q: int) -> tuple[Ints, Ints]:
    """The vertices (n, 3), as rows X, j, k, and positive tets (6 ``periods`` ``p`` ``q``, 4) of a block of the tiling.

    It is p cells wide and q cells high, flat on these four sides, and ragged on the other two, which a shift by
    ``periods`` edges along x takes to each other.
    """
    j, k, along = (axis.ravel() for axis in np.indices((p, q, periods)))
    parity = (j + k) % 2
    corners = np.array([_cell(0), _cell(1)])[parity]  # (cells, 6, 4, 3)
    corners += np.stack([2 * along, j, k], axis=1)[:, None, None]
    width = 2 * periods + 3
    keys = (corners[..., 1] * (q + 1) + corners[..., 2]) * width + corners[..., 0]
    found, tets = np.unique(keys, return_inverse=True)
    rows = found // width
    return np.stack([found % width, rows // (q + 1), rows % (q + 1)], axis=1), tets.reshape(-1, 4)


def _cell(parity: int) -> Ints:
    """The six tets (6, 4, 3) of one period between j, j + 1, k and k + 1 with j + k of that parity."""
    tets = []
    for j, k in ((0, 0), (0, 1), (1, 0), (1, 1)):
        x = (parity + j + k) % 2  # where edges along x begin in this row
        beside, above = (x + 1, 1 - j, k), (x + 1, j, 1 - k)
        tets.append([(x, j, k), (x + 2, j, k), *((beside, above) if j == k else (above, beside))])
    x = parity
    tets.append([(x, 0, 0), (x + 1, 1, 0), (x, 1, 1), (x + 1, 0, 1)])
    tets.append([(x + 1, 1, 0), (x + 2, 0, 0), (x + 2, 1, 1), (x + 1, 0, 1)])
    return np.array(tets)


def shift(layers: int, axis: int) -> tuple[int, int, int]:
    """The lattice vector, as X, j, k, that takes a vertex ``layers`` planes up along ``axis`` 1 or 2, next above it."""
    return (layers % 2, layers, 0) if axis == 1 else (layers % 2, 0, layers)


def classes(vertices: Ints, periods: int, layers: tuple[int, int]) -> Ints:
    """(n,) a number per vertex, equal for those that periods of the tiling take to each other.

    One period is ``periods`` edges along x; ``layers`` counts planes along j and k after which it repeats there,
    0 where it does not.
    """
    reduced = vertices.copy()
    for axis, count in enumerate(layers, start=1):
        if count:
            reduced -= (reduced[:, axis] // count)[:, None] * np.array(shift(count, axis))
    reduced[:, 0] %= 2 * periods
    return np.unique(reduced, axis=0, return_inverse=True)[1].ravel().astype(np.int64)
