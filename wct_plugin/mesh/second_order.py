"""Tets of second order: where their mid nodes were that were not in the middle of a straight edge."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np

from wct_plugin.core import _core
from wct_plugin.mesh import unit_scaling
from wct_plugin.mesh.in_words import in_words
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.mesh import SurfaceMesh, TetMesh, store
from wct_plugin.mesh.pickled import Pickled
from wct_plugin.mesh.strata import find_strata
from wct_plugin.mesh.topology import EDGES
from wct_plugin.mesh.triangle_surfaces import SIDES
from wct_plugin.types import Bools, Floats, Ints

#: A mid node this far off the middle, in lengths of its edge, is what rounding leaves of a straight edge: at least, and
#: at most where a file has few decimals.
_STRAIGHT, _COARSE = 1e-5, 2e-3
#: The same, in the largest coordinate: what single precision holds.
_ROUNDED = 2.5e-7
#: This far off it is as good as in the middle, in lengths of its edge.
_DOUBLE = 1e-13
#: Steps of Newton's method towards the nearest point.
_STEPS = 6
#: A file with more decimals than this is not taken for rounded.
_DECIMALS = 8
#: Pieces that each edge of a curved facet is cut into where triangles must stand for it.
PIECES = 4


@dataclass(frozen=True, eq=False)
class SecondOrder(Pickled):
    """The curved edges of tets as they came, and the curved surface; in coordinates, which no renumbering changes.

    All are empty where every edge is straight.
    """

    ends: Floats  #: (e, 2, 3) of each curved edge
    middles: Floats  #: (e, 3) their mid nodes
    facets: Floats  #: (f, 6, 3) of the surface, corners and mid nodes in VTK's order, if any of them is curved
    creases: Floats  #: (c, 3, 3) of the surface's creases, ends and mid node, if any facet is curved
    folded: Floats  #: (t, 4, 3) corners of tets that :func:`may_fold` as they came

    def __post_init__(self) -> None:
        for name in ("ends", "middles", "facets", "creases", "folded"):
            store(self, name, np.asarray(getattr(self, name), dtype=np.float64))

    def __repr__(self) -> str:
        return in_words(self, "", {"curved edges": len(self.middles), "curved facets": len(self.facets)}, {})

    @property
    def curved(self) -> bool:
        """Whether any facet of the surface is."""
        return bool(len(self.facets))

    def scaled(self, by: int) -> "SecondOrder":
        """In a unit of length 2 ** -``by`` times as large."""
        return SecondOrder(*(unit_scaling.rescaled(values, by) for values in vars(self).values()))

    def middles_of(self, ends: Floats) -> tuple[Floats, Bools]:
        """Mid nodes (k, 3) of edges between these points (k, 2, 3), and which of them are known not to be straight."""
        middles = ends.mean(axis=1)
        row = _find_cells(self.ends, ends)
        middles[row >= 0] = self.middles[row[row >= 0]]
        return middles, row >= 0

    def nearest_on_facets(self, points: Floats) -> Floats:
        """Points of the curved facets near some (q, 3); these themselves without a curved facet."""
        return self._nearest(_nearest_on_facets, self.facets, points)

    def nearest_on_creases(self, points: Floats) -> Floats:
        """Points of the curved creases near some (q, 3); these themselves without a curved crease."""
        return self._nearest(_nearest_on_edges, self.creases, points)

    def _nearest(self, search: Callable[[Floats, Floats], Floats], nodes: Floats, points: Floats) -> Floats:
        if not len(nodes) or not len(points):
            return points
        unit = unit_scaling.exponent(nodes.reshape(-1, 3))
        return unit_scaling.rescaled(search(*(unit_scaling.rescaled(one, -unit) for one in (nodes, points))), unit)

    def came_folded(self, corners: Floats) -> Bools:
        """Which of the tets with these corners (k, 4, 3) were such as they came."""
        return _find_cells(self.folded, corners) >= 0


def straight() -> SecondOrder:
    """Second order without a curved edge."""
    return _edges_alone(np.empty((0, 2, 3)), np.empty((0, 3)))


def _edges_alone(ends: Floats, middles: Floats) -> SecondOrder:
    return SecondOrder(ends, middles, np.empty((0, 6, 3)), np.empty((0, 3, 3)), np.empty((0, 4, 3)))


def find_curved(ends: Floats, middles: Floats) -> tuple[Floats, Floats]:
    """Of edges (k, 2, 3) with mid nodes (k, 3) those that are curved, each once; where any is, to the last digit."""
    off = np.linalg.norm(middles - ends.mean(axis=1), axis=1)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    decimals = np.minimum(2.0 * _last_decimal(middles), _COARSE * length)
    single = _ROUNDED * np.abs(ends).max(axis=(1, 2), initial=0.0)
    if not (off > np.maximum(_STRAIGHT * length, decimals) + single).any():
        return ends[:0], middles[:0]
    curved = off > _DOUBLE * length
    ends, middles = ends[curved], middles[curved]
    place = np.unique(ends.reshape(-1, 3), axis=0, return_inverse=True)[1].reshape(-1, 2)
    first = np.unique(np.sort(place, axis=1), axis=0, return_index=True)[1]
    return ends[first], middles[first]


def _last_decimal(points: Floats) -> float:
    """The power of ten that all coordinates are multiples of, as those in files of few decimals are; else 0."""
    for decimals in range(_DECIMALS + 1):
        steps = points * 10.0**decimals
        if (np.abs(steps - np.rint(steps)) <= 1e-12 * np.abs(steps)).all():
            return 10.0**-decimals
    return 0.0


def with_surface(ends: Floats, middles: Floats, mesh: TetMesh) -> SecondOrder:
    """The second order of a mesh with these curved edges (e, 2, 3) and their mid nodes (e, 3)."""
    edges = _edges_alone(ends, middles)
    tets = mesh.points[mesh.tets]
    mid, known = edges.middles_of(tets[:, EDGES].reshape(-1, 2, 3))
    curved = known.reshape(-1, 6).any(axis=1)
    tets = tets[curved]
    edges = replace(edges, folded=tets[may_fold(tets, mid.reshape(-1, 6, 3)[curved])])
    found = find_strata(mesh)
    corners = mesh.points[found.triangles]
    sides = corners[:, SIDES]
    mid, known = edges.middles_of(sides.reshape(-1, 2, 3))
    if not known.any():
        return edges
    lines = mesh.points[found.segments]
    creases = np.concatenate([lines, edges.middles_of(lines)[0][:, None]], axis=1)
    return replace(edges, facets=np.concatenate([corners, mid.reshape(-1, 3, 3)], axis=1), creases=creases)


def curved_boundary(mesh: TetMesh, of: SecondOrder) -> SurfaceMesh:
    """The boundary as it is curved, in triangles, with its facets' tags."""
    boundary = mesh.topology.boundary
    tags = np.zeros(len(boundary), dtype=np.int64)
    row = find_rows(np.sort(mesh.facets.vertices, axis=1), np.sort(boundary, axis=1), len(mesh.points))
    tags[row >= 0] = mesh.facets.tags[row[row >= 0]]
    sides = boundary[:, SIDES]
    middles = of.middles_of(mesh.points[sides].reshape(-1, 2, 3))[0].reshape(-1, 3, 3)
    return replace(sampled(mesh.points, boundary, middles, tags), source=mesh.source)


def sampled(points: Floats, triangles: Ints, middles: Floats, tags: Ints) -> SurfaceMesh:
    """Curved facets with mid nodes (f, 3, 3) in triangles, each in ``PIECES`` squared with its tag (f,)."""
    nodes = np.concatenate([points[triangles], middles], axis=1)
    weights, pieces = lattice(PIECES)
    fine = facet_points(nodes[:, None], weights[None]).reshape(-1, 3)
    numbers = _lattice_numbers(triangles, weights, len(points))
    _, first, place = np.unique(numbers, axis=0, return_index=True, return_inverse=True)
    made = place.reshape(len(triangles), -1)[:, pieces].reshape(-1, 3)
    return SurfaceMesh(fine[first], made, np.repeat(tags, len(pieces)))


def lattice(count: int) -> tuple[Floats, Ints]:
    """Barycentric coordinates (q, 3) of evenly spaced points of a triangle, and the triangles (count ** 2, 3) there."""
    rows = [(i, j) for i in range(count + 1) for j in range(count + 1 - i)]
    at = {pair: k for k, pair in enumerate(rows)}
    triangles = [(at[i, j], at[i + 1, j], at[i, j + 1]) for i, j in rows if i + j < count]
    triangles += [(at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]) for i, j in rows if i + j < count - 1]
    steps = np.array(rows, dtype=np.float64) / count
    return np.column_stack([1.0 - steps.sum(axis=1), steps]), np.array(triangles)


def facet_points(nodes: Floats, weights: Floats) -> Floats:
    """Points (..., 3) of curved facets with ``nodes`` (..., 6, 3) at barycentric coordinates ``weights`` (..., 3)."""
    a, b, c = np.moveaxis(weights, -1, 0)
    shape = np.stack([a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a], axis=-1)
    points: Floats = np.einsum("...k,...kx->...x", shape, nodes)
    return points


def edge_points(nodes: Floats, along: Floats) -> Floats:
    """Points (..., 3) of curved edges with ``nodes`` (..., 3, 3), the middle last, at ``along`` (...) from 0 to 1."""
    shape = np.stack([(1 - along) * (1 - 2 * along), along * (2 * along - 1), 4 * along * (1 - along)], axis=-1)
    points: Floats = np.einsum("...k,...kx->...x", shape, nodes)
    return points


def may_fold(corners: Floats, middles: Floats) -> Bools:
    """Which tets with these corners (m, 4, 3) and mid nodes (m, 6, 3), as :data:`EDGES`, may turn round inside.

    Those that do not have a Jacobian whose Bernstein coefficients are all positive, so that it is positive throughout.
    """
    least = jacobian_coefficients(corners, middles).reshape(len(corners), 64).min(axis=1)
    folds: Bools = np.logical_not(least > 0.0)
    return folds


def jacobian_coefficients(corners: Floats, middles: Floats) -> Floats:
    """(m, 4, 4, 4) an eighth of the Jacobian's Bernstein coefficients, cubic, in every order of their three indices."""
    control = np.empty((len(corners), 4, 4, 3))
    control[:, range(4), range(4)] = corners
    for (i, j), middle in zip(EDGES, np.moveaxis(middles, 1, 0), strict=True):
        control[:, i, j] = control[:, j, i] = 2.0 * middle - 0.5 * (corners[:, i] + corners[:, j])
    u, v, w = (control[:, :, k] - control[:, :, 0] for k in (1, 2, 3))
    each = np.einsum("mix,mjlx->mijl", u, np.cross(v[:, :, None], w[:, None]))
    mean: Floats = sum(each.transpose(0, *(axis + 1 for axis in axes)) for axes in permutations(range(3))) / 6.0
    return mean


def _find_cells(known: Floats, wanted: Floats) -> Ints:
    """For each of the wanted cells (k, d, 3) the row of the known one with the same points, to the bit, or -1."""
    if not len(known) or not len(wanted):
        return np.full(len(wanted), -1, dtype=np.int64)
    both = np.concatenate([known, wanted])
    place = np.unique(both.reshape(-1, 3), axis=0, return_inverse=True)[1].reshape(both.shape[:2])
    cells = np.sort(place, axis=1)
    return find_rows(cells[: len(known)], cells[len(known) :], both.size)


def _lattice_numbers(triangles: Ints, weights: Floats, count: int) -> Ints:
    """(f q, 5) numbers that are equal where lattice points of two facets are one: on their common edge or corner."""
    steps = np.rint(weights * PIECES).astype(np.int64)
    corner = np.broadcast_to(triangles[:, None], (len(triangles), *steps.shape))
    share = np.broadcast_to(steps, corner.shape)
    order = np.argsort(np.where(share > 0, corner, count), axis=2)
    corner, share = (np.take_along_axis(values, order, axis=2) for values in (corner, share))
    vertices = np.where(share > 0, corner, -1)
    return np.concatenate([vertices, share[:, :, :2]], axis=2).reshape(-1, 5)


def _nearest_on_facets(nodes: Floats, queries: Floats) -> Floats:
    """Points of curved facets (f, 6, 3) nearest to the queries (q, 3), from those of triangles that stand for them."""
    weights, pieces = lattice(PIECES)
    points = facet_points(nodes[:, None], weights[None]).reshape(-1, 3)
    triangles = (np.arange(len(nodes))[:, None, None] * len(weights) + pieces).reshape(-1, 3)
    at, of, _ = _core.closest_points(points, triangles, queries)
    inside = _barycentric(points[triangles[of]], at)
    nodes = nodes[of // len(pieces)]
    weight = np.einsum("qk,qkw->qw", inside, weights[pieces[of % len(pieces)]])
    for _ in range(_STEPS):  # towards where the surface is at right angles to what is left
        across = np.stack([_difference(nodes, weight, move) for move in ([-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0])], axis=1)
        step = np.einsum("qxd,qd->qx", np.linalg.pinv(across.transpose(0, 2, 1)), queries - facet_points(nodes, weight))
        weight = np.clip(weight + np.column_stack([-step.sum(axis=1), step]), 0.0, 1.0)
        weight /= weight.sum(axis=1, keepdims=True)
    return facet_points(nodes, weight)


def _difference(nodes: Floats, weights: Floats, move: list[float]) -> Floats:
    """The derivative along a change of barycentric coordinates: of a quadratic a central difference."""
    step = 0.5 * np.array(move)
    return facet_points(nodes, weights + step) - facet_points(nodes, weights - step)


def _nearest_on_edges(nodes: Floats, queries: Floats) -> Floats:
    """Points of curved edges (c, 3, 3) nearest to the queries (q, 3)."""
    steps = np.linspace(0.0, 1.0, 2 * PIECES + 1)
    points = edge_points(nodes[:, None], steps[None]).reshape(-1, 3)
    first = (np.arange(len(nodes))[:, None] * len(steps) + np.arange(2 * PIECES)).ravel()
    segments = np.column_stack([first, first + 1, first + 1])  # triangles with two corners in one place
    at, of, _ = _core.closest_points(points, segments, queries)
    start, end = points[segments[of, 0]], points[segments[of, 1]]
    share = np.einsum("qx,qx->q", at - start, end - start) / np.einsum("qx,qx->q", end - start, end - start)
    edge, piece = np.divmod(of, 2 * PIECES)
    nodes, along = nodes[edge], (piece + np.clip(share, 0.0, 1.0)) / (2 * PIECES)
    for _ in range(_STEPS):
        tangent = edge_points(nodes, along + 0.5) - edge_points(nodes, along - 0.5)
        left = queries - edge_points(nodes, along)
        along = np.clip(
            along + np.einsum("qx,qx->q", tangent, left) / np.einsum("qx,qx->q", tangent, tangent), 0.0, 1.0
        )
    return edge_points(nodes, along)


def _barycentric(corners: Floats, points: Floats) -> Floats:
    """(q, 3) coordinates of points (q, 3) in triangles (q, 3, 3) that hold them."""
    u, v = (corners[:, k] - corners[:, 0] for k in (1, 2))
    w = points - corners[:, 0]
    uu, uv, vv, uw, vw = (np.einsum("qx,qx->q", a, b) for a, b in ((u, u), (u, v), (v, v), (u, w), (v, w)))
    size = uu * vv - uv * uv
    size = np.where(size > 0.0, size, 1.0)
    second, third = (vv * uw - uv * vw) / size, (uu * vw - uv * uw) / size
    inside = np.clip(np.column_stack([1.0 - second - third, second, third]), 0.0, 1.0)
    shares: Floats = inside / inside.sum(axis=1, keepdims=True)
    return shares
