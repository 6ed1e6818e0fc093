"""How far one surface is from another."""

import math
from dataclasses import dataclass

import numpy as np

from wct_plugin.core import _core
from wct_plugin.mesh import SurfaceMesh, unit_scaling
from wct_plugin.types import Floats, Ints


@dataclass(frozen=True, eq=False)
class Deviation:
    """How far two surfaces are apart, both ways: exact distances from samples. All in the surfaces' own unit.

    Distance to a surface changes no faster than one moves, so the true maximum lies between ``max_ab`` and
    ``max_ab + error_ab``, and likewise the other way.
    """

    max_ab: float  #: largest distance from a sample of a to the surface b
    max_ba: float  #: largest distance from a sample of b to the surface a
    at_ab: tuple[float, float, float]  #: the sample of a that is farthest from b
    at_ba: tuple[float, float, float]  #: the sample of b that is farthest from a
    error_ab: float  #: the farthest any point of a is from a sample: spacing / sqrt(3)
    error_ba: float  #: likewise for b

    @property
    def max(self) -> float:
        """The larger of both directions: the sampled Hausdorff distance."""
        return max(self.max_ab, self.max_ba)

    def to_dict(self, diagonal: float) -> dict[str, float]:
        """Plain numbers where b is the reference, whose bounding box has this diagonal."""
        return {
            "to_reference": self.max_ab,
            "from_reference": self.max_ba,
            "max": self.max,
            "fraction_of_diagonal": self.max / diagonal,
            "sampling_error": max(self.error_ab, self.error_ba),
        }


def measure_deviation(
    a: SurfaceMesh, b: SurfaceMesh, spacing: float | None = None, *, compiled: bool = False
) -> Deviation:
    """Two-sided distance between surfaces, from samples at all vertices and regularly inside the triangles.

    ``spacing`` is the largest step between neighbouring samples of one triangle, in the surfaces' unit. Without it a
    quarter of the sampled surface's own mean edge length, or more where its triangles are so uneven that this would
    take over 64 samples per triangle on average. See :class:`Deviation` for the sampling error. ``compiled``: measure
    the same samples by :mod:`wct_plugin.core._core` instead of NumPy, in a tenth of the time. Raises
    :class:`ValueError` for a spacing that is not positive.
    """
    unit = unit_scaling.exponent(np.concatenate([a.points, b.points]))
    a, b = unit_scaling.scaled(a, -unit), unit_scaling.scaled(b, -unit)
    step_a, step_b = (_step(one, spacing and math.ldexp(spacing, -unit)) for one in (a, b))
    farthest = _farthest_compiled if compiled else _farthest
    max_ab, at_ab = farthest(a, step_a, b)
    max_ba, at_ba = farthest(b, step_b, a)
    error_ab, error_ba = step_a / math.sqrt(3.0), step_b / math.sqrt(3.0)
    lengths = (max_ab, max_ba, *at_ab, *at_ba, error_ab, error_ba)
    max_ab, max_ba, *at, error_ab, error_ba = (math.ldexp(one, unit) for one in lengths)
    return Deviation(max_ab, max_ba, (at[0], at[1], at[2]), (at[3], at[4], at[5]), error_ab, error_ba)


def _farthest(a: SurfaceMesh, step: float, b: SurfaceMesh) -> tuple[float, tuple[float, float, float]]:
    """The sample of ``a`` farthest from ``b``: its distance and where it is."""
    samples = _samples(a, step)
    far = distances(samples, b)
    worst = int(np.argmax(far))
    x, y, z = samples[worst]
    return float(far[worst]), (float(x), float(y), float(z))


def _farthest_compiled(a: SurfaceMesh, step: float, b: SurfaceMesh) -> tuple[float, tuple[float, float, float]]:
    return _core.farthest_sample(a.points, a.triangles, step, b.points, b.triangles)


def distances(queries: Floats, surface: SurfaceMesh) -> Floats:
    """Exact distance (q,) from each query point (q, 3) to the nearest point of the surface.

    The triangles are bisected into pieces, and the pieces' centers are searched in order of distance. A center is on
    the surface and its piece within a known radius, so once the next center is farther than the best distance so far
    plus the largest radius, no unseen triangle can be nearer.
    """
    from scipy.spatial import cKDTree  # here: only this needs it, and it takes long to import

    corners = surface.points[surface.triangles]
    centers, owner, radius = _pieces(corners)
    tree, triangles = cKDTree(centers), _Triangles(corners)
    best = np.full(len(queries), np.inf)
    pending, seen, width = np.arange(len(queries)), 0, 4
    while len(pending):
        width = min(width, len(centers))
        left = []
        for part in np.array_split(pending, 1 + len(pending) * width // 30_000):
            reach, found = tree.query(queries[part], k=list(range(seen + 1, width + 1)))
            row, column = np.nonzero(reach - radius[found] < best[part, None])
            square = triangles.square_distances(queries[part[row]], owner[found[row, column]])
            np.minimum.at(best, part[row], np.sqrt(square))
            left.append(part[reach[:, -1] < best[part] + radius.max()])
        pending = np.concatenate(left) if width < len(centers) else pending[:0]
        seen, width = width, 2 * width
    return best


def _step(surface: SurfaceMesh, spacing: float | None) -> float:
    """Largest step between samples; 0 where every triangle is a point."""
    edges = _edges(surface.points[surface.triangles])
    if spacing is None:
        return max(float(edges.mean()) / 4.0, math.sqrt(float((edges.max(axis=1) ** 2).mean()) / 128.0))
    if spacing > 0.0:
        return spacing
    raise ValueError(f"spacing is {spacing}; it must be positive")


def _edges(corners: Floats) -> Floats:
    out: Floats = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    return out


def _samples(surface: SurfaceMesh, step: float) -> Floats:
    """Vertices and a regular triangular grid in each triangle with steps of at most ``step``."""
    corners = surface.points[surface.triangles]
    out = [surface.points[np.unique(surface.triangles)]]
    if step == 0.0:
        return out[0]
    counts = np.ceil(_edges(corners).max(axis=1) / step).astype(np.int64)
    for count in np.unique(counts[counts > 1]):
        i, j = np.nonzero(np.add.outer(np.arange(count + 1), np.arange(count + 1)) <= count)
        weights = np.column_stack([i, j, count - i - j]) / count
        weights = weights[weights.max(axis=1) < 1.0]  # the vertices are in already
        out.append((weights @ corners[counts == count]).reshape(-1, 3))
    return np.concatenate(out)


def _pieces(corners: Floats) -> tuple[Floats, Ints, Floats]:
    """Centers (p, 3) of pieces of triangles (t, 3, 3), the triangle each is part of, and the radius each lies within.

    Pieces are about as large as the mean edge, or larger where that would make many more pieces than triangles.
    """
    edges = _edges(corners)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2.0
    limit = max(0.75 * float(edges.mean()), math.sqrt(area / (4.0 * len(corners))))
    out = []
    owner = np.arange(len(corners))
    while len(corners):
        middle = corners.mean(axis=1)
        radius = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
        small = radius <= limit
        out.append((middle[small], owner[small], radius[small]))
        corners, owner = corners[~small], owner[~small]
        # Cut the longest edge in half; roll the triangles so that it runs from corner 0 to corner 1.
        lengths = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        turn = (np.argmax(lengths, axis=1)[:, None] + np.arange(3)) % 3
        p, q, r = np.moveaxis(np.take_along_axis(corners, turn[..., None], axis=1), 1, 0)
        half = (p + q) / 2.0
        corners = np.concatenate([np.stack([p, half, r], axis=1), np.stack([half, q, r], axis=1)])
        owner = np.tile(owner, 2)
    centers, owners, radii = (np.concatenate(column) for column in zip(*out, strict=True))
    return centers, owners, radii * (1.0 + 1e-12) + 1e-300  # never too small by rounding


class _Triangles:
    """Triangles (t, 3, 3) prepared for many distances; component arrays (3, t), so that memory runs contiguously."""

    def __init__(self, corners: Floats) -> None:
        ends = [np.ascontiguousarray(corners[:, k].T) for k in range(3)]
        self.starts = ends
        self.edges = [ends[(k + 1) % 3] - ends[k] for k in range(3)]
        squares = [_dot(edge, edge) for edge in self.edges]
        self.inverse = [1.0 / np.where(square > 0.0, square, 1.0) for square in squares]
        normal = np.cross(self.edges[0], self.edges[1], axis=0)
        self.inward = [np.cross(normal, edge, axis=0) for edge in self.edges]

    def square_distances(self, queries: Floats, which: Ints) -> Floats:
        """Squared distance (k,) from each query (k, 3) to the triangle numbered ``which`` (k,)."""
        x = np.ascontiguousarray(queries.T)
        starts = [start[:, which] for start in self.starts]
        square = np.full(len(which), np.inf)
        weights = []  # of the corner opposite each edge: all positive where the query is above the inside
        for start, edges, inverse, inward in zip(starts, self.edges, self.inverse, self.inward, strict=True):
            offset, edge = x - start, edges[:, which]
            weights.append(_dot(offset, inward[:, which]))
            gap = offset - np.clip(_dot(offset, edge) * inverse[which], 0.0, 1.0) * edge
            np.minimum(square, _dot(gap, gap), out=square)
        total = weights[0] + weights[1] + weights[2]
        above = np.flatnonzero((np.minimum.reduce(weights) >= 0.0) & (total > 0.0))
        # A mean of the corners with these weights is a point of the triangle, however flat that is, so that rounding
        # never makes a distance too small.
        foot = sum(weights[k][above] * starts[(k + 2) % 3][:, above] for k in range(3)) / total[above]
        gap = x[:, above] - foot
        square[above] = np.minimum(square[above], _dot(gap, gap))
        return square


def _dot(a: Floats, b: Floats) -> Floats:
    out: Floats = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return out
