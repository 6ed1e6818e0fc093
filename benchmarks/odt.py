"""Optimal Delaunay triangulation with the boundary kept: what thirty lines of SciPy do."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from wct_plugin.measure.quality import circumcenters, volumes
from wct_plugin.mesh import TetMesh
from wct_plugin.types import Floats, Ints


def odt_delaunay(points: Floats, tets: Ints, sweeps: int = 60, step: float = 0.7) -> tuple[Floats, Ints]:
    """Interior points move to the volume-weighted mean of their tets' circumcenters, then Delaunay; ``sweeps`` times.

    A circumcenter outside its tet is pulled to the centroid's side, no farther than the circumradius of a regular tet
    of that volume. Boundary points stay; facets stay where the Delaunay triangulation has them.
    """
    surface = TetMesh(points, tets).topology.boundary
    inner = np.setdiff1d(np.arange(len(points)), surface)
    facets = points[surface]
    known: dict[tuple[int, ...], bool] = {}
    points = points.copy()
    for _ in range(sweeps):
        size = np.abs(volumes(points, tets))
        middle = points[tets].mean(axis=1)
        shift = circumcenters(points, tets) - middle
        reach = 1.2 * np.cbrt(size)[:, None] / np.maximum(np.linalg.norm(shift, axis=1), 1e-300)[:, None]
        goal = (middle + shift * np.minimum(1.0, reach)) * size[:, None]
        total = np.bincount(tets.ravel(), np.repeat(size, 4), len(points))
        mean = np.stack([np.bincount(tets.ravel(), np.repeat(goal[:, k], 4), len(points)) for k in range(3)], axis=1)
        points[inner] += step * (mean[inner] / total[inner, None] - points[inner])
        tets = _inside(points, Delaunay(points).simplices.astype(np.int64), inner, facets, known)
    return points, tets


def _inside(points: Floats, tets: Ints, inner: Ints, facets: Floats, known: dict[tuple[int, ...], bool]) -> Ints:
    """The tets with an interior vertex, and of the others those whose centroid the boundary facets enclose.

    Boundary points stay, so what was found out about a tet of theirs is ``known`` for later sweeps.
    """
    outer = ~np.isin(tets, inner).any(axis=1)
    names = [tuple(sorted(tet)) for tet in tets[outer].tolist()]
    new = [name for name in names if name not in known]
    x = points[np.array(new, dtype=np.int64).reshape(-1, 4)]
    longest = np.linalg.norm(x[:, 1:] - x[:, :1], axis=2).max(axis=1)
    solid = np.abs(np.linalg.det(x[:, 1:] - x[:, :1])) > 6e-6 * longest**3
    known.update(zip(new, (solid & _enclosed(x.mean(axis=1), facets)).tolist(), strict=True))
    keep = ~outer
    keep[outer] = [known[name] for name in names]
    tets = tets[keep]
    turned = volumes(points, tets) < 0.0
    tets[turned] = tets[turned][:, [0, 1, 3, 2]]
    return tets


def _enclosed(queries: Floats, facets: Floats) -> NDArray[np.bool_]:
    """Winding number (solid angles summed) above one half, for each query (q, 3)."""
    inside = np.empty(len(queries), dtype=bool)
    for part in np.array_split(np.arange(len(queries)), 1 + len(queries) * len(facets) // 1_000_000):
        a, b, c = np.moveaxis(facets[None] - queries[part, None, None], 2, 0)
        la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
        dots = [np.einsum("qfk,qfk->qf", u, v) for u, v in ((a, b), (b, c), (c, a))]
        below = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
        angle = 2.0 * np.arctan2(np.einsum("qfk,qfk->qf", a, np.cross(b, c)), below)
        inside[part] = np.abs(angle.sum(axis=1)) > 2.0 * np.pi
    return inside
