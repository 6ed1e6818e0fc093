"""Meshes for the tests of the core, and measures written independently of it."""

from dataclasses import dataclass
from itertools import permutations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from wct_plugin.core import _core
from wct_plugin.core.domain import RegionMesh
from wct_plugin.core.requests import ResampleOptions

FACETS = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
NO_TRIANGLES = np.zeros((0, 3), dtype=np.int64)
NO_SEGMENTS = np.zeros((0, 2), dtype=np.int64)
NO_LABELS = np.zeros(0, dtype=np.int64)


@dataclass(frozen=True)
class Movable:
    """A mesh with what ``move_vertices`` wants to know of its boundary."""

    points: NDArray[np.float64]
    tets: NDArray[np.int64]
    stratum: NDArray[np.int8]
    label: NDArray[np.int64]
    triangles: NDArray[np.int64]
    patch: NDArray[np.int64]
    segments: NDArray[np.int64]
    curve: NDArray[np.int64]

    def arguments(self, *, slide: bool):
        return self.points, self.tets, self if slide else self.pinned

    @property
    def pinned(self):
        """The same whose surface stays."""
        stratum = np.where(self.stratum > 0, 3, 0).astype(np.int8)
        label = np.full(len(self.points), -1)
        return Movable(self.points, self.tets, stratum, label, NO_TRIANGLES, NO_LABELS, NO_SEGMENTS, NO_LABELS)


def positive(points, tets):
    tets = np.array(tets, dtype=np.int64)
    negative = volumes(points, tets) < 0
    tets[negative] = tets[negative][:, [0, 1, 3, 2]]
    return tets


def ball(count: int = 400, seed: int = 0) -> Movable:
    """Delaunay mesh of a ball: scattered points inside, a spiral of points on the sphere. Its boundary is its hull."""
    rng = np.random.default_rng(seed)
    shell = int(1.6 * count ** (2 / 3))
    height = 1 - 2 * (np.arange(shell) + 0.5) / shell
    turn = np.pi * (1 + 5**0.5) * np.arange(shell)
    ring = np.sqrt(1 - height**2)
    outer = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    inner = rng.standard_normal((count, 3))
    inner *= (0.85 * rng.random(count) ** (1 / 3) / np.linalg.norm(inner, axis=1))[:, None]
    points = np.concatenate([outer, inner])
    tets = positive(points, Delaunay(points).simplices)
    tets = tets[flatness(points, tets) > 1e-6]
    triangles = boundary(tets)
    on_hull = np.zeros(len(points), dtype=bool)
    on_hull[triangles] = True
    return Movable(
        points,
        tets,
        on_hull.astype(np.int8),
        np.where(on_hull, 7, -1).astype(np.int64),
        triangles,
        np.full(len(triangles), 7),
        NO_SEGMENTS,
        NO_LABELS,
    )


def cube(cells: int = 4, jitter: float = 0.15, seed: int = 0, turned: bool = False) -> Movable:
    """Kuhn's mesh of the unit cube, six tets per cell, its points jittered within their face or edge."""
    rng = np.random.default_rng(seed)
    side = np.arange(cells + 1)
    grid = np.stack(np.meshgrid(side, side, side, indexing="ij"), axis=-1).reshape(-1, 3)
    outer = (grid == 0) | (grid == cells)
    points = (grid + np.where(outer, 0.0, jitter * rng.uniform(-1, 1, grid.shape))) / cells
    number = np.arange(len(grid)).reshape((cells + 1,) * 3)
    tets = []
    corner = np.stack(np.meshgrid(*[np.arange(cells)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    for order in permutations(range(3)):
        path = [corner]
        for axis in order:
            path.append(path[-1] + np.eye(3, dtype=int)[axis])
        tets.append(np.stack([number[tuple(step.T)] for step in path], axis=1))
    tets = positive(points, np.concatenate(tets))
    triangles = boundary(tets)
    flags = (grid == 0) + 2 * (grid == cells)  # per axis: 0 inside, 1 low, 2 high
    stratum = outer.sum(axis=1).astype(np.int8)
    label = np.where(stratum > 0, flags @ [1, 3, 9], -1)
    same = np.bitwise_and.reduce(np.stack([1 * (grid[triangles] == 0), 1 * (grid[triangles] == cells)]), axis=2)
    patch = ((same[0] + 2 * same[1]) @ [1, 3, 9]).astype(np.int64)
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    ends = np.unique(ends, axis=0)
    low, high = (grid[ends] == 0).all(axis=1), (grid[ends] == cells).all(axis=1)
    along = (low | high).sum(axis=1) == 2
    segments, curve = ends[along], ((1 * low + 2 * high) @ [1, 3, 9])[along]
    if turned:
        points = points @ rotation(seed).T + [3.0, -1.0, 0.5]
    return Movable(points, tets, stratum, label.astype(np.int64), triangles, patch, segments, curve.astype(np.int64))


def rotation(seed: int) -> NDArray[np.float64]:
    q, r = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def boundary(tets):
    facets = tets[:, FACETS].reshape(-1, 3)
    _, first, times = np.unique(np.sort(facets, axis=1), axis=0, return_index=True, return_counts=True)
    return np.ascontiguousarray(facets[first[times == 1]])


def volumes(points, tets):
    x = points[tets]
    return np.linalg.det(x[:, 1:] - x[:, :1]) / 6


def flatness(points, tets):
    x = points[tets]
    longest = np.max([np.linalg.norm(x[:, i] - x[:, j], axis=1) for i in range(4) for j in range(i)], axis=0)
    return 6 * volumes(points, tets) / longest**3


def circumcenters(points, tets):
    x = points[tets]
    edges = x[:, 1:] - x[:, :1]
    return np.linalg.solve(edges, 0.5 * (edges**2).sum(axis=2)[:, :, None])[:, :, 0] + x[:, 0]


def heights(points, tets):
    """(m, 4) signed height of the circumcenter over each facet, over the circumradius."""
    x = points[tets]
    center = circumcenters(points, tets)
    radius = np.linalg.norm(center - x[:, 0], axis=1)
    out = []
    for i, facet in enumerate(FACETS):
        a, b, c = (x[:, k] for k in facet)
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        side = np.sign(np.einsum("ij,ij->i", normal, x[:, i] - a))
        out.append(side * np.einsum("ij,ij->i", normal, center - a) / radius)
    return np.stack(out, axis=1)


def cosines(points, tets):
    """(m, 12) cosines of the facet angles."""
    x = points[tets]
    out = []
    for facet in FACETS:
        for k in range(3):
            a, b, c = (x[:, facet[(k + j) % 3]] for j in range(3))
            p, q = b - a, c - a
            out.append(np.einsum("ij,ij->i", p, q) / np.linalg.norm(p, axis=1) / np.linalg.norm(q, axis=1))
    return np.stack(out, axis=1)


def well_centered(points, tets):
    """(m,) by another way than heights: are all barycentric coordinates of the circumcenter positive?"""
    x = points[tets]
    rest = np.linalg.solve(np.swapaxes(x[:, 1:] - x[:, :1], 1, 2), (circumcenters(points, tets) - x[:, 0])[:, :, None])[
        :, :, 0
    ]
    return (rest > 0).all(axis=1) & (rest.sum(axis=1) < 1)


def completely_well_centered(points, tets):
    return well_centered(points, tets) & (cosines(points, tets) > 0).all(axis=1)


def sampled(surface, points, tets, tolerance=1e-3, progress=None, **options):
    """What ``resample`` makes of tets of one region; ``tolerance`` is a length."""
    mesh = RegionMesh(points, tets, np.zeros(len(tets), dtype=np.int64))
    return _core.resample(surface, mesh, ResampleOptions(tolerance, **options), progress=progress)


def start(mesh, own, tolerance=1e-3, progress=None, threads=0, **options):
    """What ``resample`` makes of a mesh near its boundary ``own``; ``tolerance`` by the diagonal."""
    return _core.resample(
        own.surface,
        RegionMesh(mesh.points, mesh.tets, np.searchsorted(own.regions, mesh.regions)),
        ResampleOptions(tolerance * own.diagonal, **options),
        progress=progress,
        threads=threads,
    )
