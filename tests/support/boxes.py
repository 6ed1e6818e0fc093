"""Boxes and their surfaces, as the core takes them."""

import numpy as np

from wct_plugin.core.domain import StratifiedSurface


def box(n, turn=None):
    """A unit cube of n^3 cells of six tets, and its surface in strata; region 1 where x > 1/2 if n is even."""
    axis = np.arange(n + 1)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    points = np.stack([x, y, z], -1).reshape(-1, 3) / n
    number = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    tets = []
    for order in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)):
        at, path = np.zeros(3, dtype=int), []
        for step in (None, *order):
            if step is not None:
                at[step] += 1
            i, j, k = at
            path.append(number[i : i + n, j : j + n, k : k + n].ravel())
        tets.append(np.stack(path, -1))
    tets = np.concatenate(tets)
    a, b, c, d = np.moveaxis(points[tets], 1, 0)
    flip = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) < 0
    tets[flip] = tets[flip][:, [0, 1, 3, 2]]
    return points if turn is None else points @ turn.T, tets


CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])


def cube_surface(turn=None):
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    segments = np.array([[a, b] for a in range(8) for b in range(a + 1, 8) if (CUBE[a] != CUBE[b]).sum() == 1])
    return StratifiedSurface(
        points=CUBE if turn is None else CUBE @ turn.T,
        triangles=triangles,
        patch=np.repeat(np.arange(6), 2),
        segments=segments,
        curve=np.arange(12),
        sides=np.tile([0, -1], (6, 1)),
        corners=np.arange(8),
    )
