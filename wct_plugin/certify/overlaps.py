"""Whether tets fill space without overlap and meet face to face, decided exactly from the boundary alone.

Claim. Let all tets be positive and every facet belong to one or two tets. The tets have disjoint interiors and any two
of them meet in a common face or not at all, if

1. the two tets at every interior facet lie on opposite sides of it,
2. any two boundary facets meet in a common vertex, a common edge, or not at all,
3. from each shell of the boundary, one point inside one facet lies in no tet but the facet's own.

Shells are the classes of boundary facets that are joined by edges at which exactly two boundary facets meet.

Proof. Let N(x) be the number of tets around a point x on no facet. By 1, N changes at boundary facets only, and by 2
it changes by one there, from N outside to N + 1 inside. Near an edge where exactly two boundary facets meet they are,
by 2, all of the boundary, and they induce opposite directions on the edge, so both have the same side outside: N
outside is the same all along a shell. By 3 it is 0. A way from infinity, where N = 0, to a point with N = 2 would
cross a facet from 1 to 2, with N = 1 outside; so N <= 1 and interiors are disjoint. Now let x be in two tets A and B,
inside the face F of A and the face G of B. If both are faces of boundary facets, F = G by 2. Otherwise one of them,
say F, is in none, so that the tets around F, all matched across the facets at F, cover all that is near x; B has
points near x too, is one of these tets as N <= 1, has F as a face, and so F = G. Conversely, a mesh that violates 1,
2 or 3 is not of this kind. Nothing else is assumed; the boundary need not be a manifold, and the mesh may be in
several pieces.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wct_plugin.certify.box_pairs import overlapping
from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import Polynomial, exact_signs
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.index_arrays import components
from wct_plugin.mesh.topology import FACETS
from wct_plugin.mesh.triangle_surfaces import surface_edges
from wct_plugin.types import Bools, Floats, Ints


@dataclass(frozen=True, eq=False)
class Overlaps:
    """Where a mesh with positive tets overlaps itself or does not meet face to face; all empty where it is sound."""

    one_sided: Ints  #: (k, 2) tets on the same side of a facet they share
    crossing: Ints  #: (k, 2) tets whose boundary facets have more in common than a vertex or an edge
    covered: Ints  #: (k, 2) a tet with a boundary facet, and another one that reaches across the middle of that facet
    exactly: int  #: signs that took integers


def overlaps(mesh: TetMesh) -> Overlaps:
    """Look for them; all tets of ``mesh`` are positive, as :class:`TetMesh` makes sure.

    Raises :class:`wct_plugin.errors.InputError` where three or more tets share a facet.
    """
    judge = _Judge(mesh.points)
    border = mesh.topology.boundary_half_facets[:, 0]
    return Overlaps(_one_sided(mesh), border[_crossing(mesh, judge)], _covered(mesh, judge), judge.exactly)


class _Judge:
    """Signs on one set of points, and how many of them took integers."""

    def __init__(self, points: Floats) -> None:
        self._points = points
        self.exactly = 0

    def __call__(self, polynomial: Polynomial, *columns: Ints) -> NDArray[np.int8]:
        """(k, q) for cells whose points are ``columns``, each (k,) or (k, d)."""
        found = exact_signs(polynomial, self._points, np.column_stack(columns))
        self.exactly += found.exactly
        return found.values


def _one_sided(mesh: TetMesh) -> Ints:
    """The outward orientations of a facet in its two tets differ where those lie on opposite sides."""
    odd = _odd_facets(mesh.tets)
    pairs, _ = mesh.topology.half_facets
    alike: Ints = pairs[odd[pairs[:, 0]] == odd[pairs[:, 1]]] // 4
    return alike


def _odd_facets(tets: Ints) -> Bools:
    """(4 m,) whether an odd permutation sorts the corners of facet ``FACETS[i]`` of a tet, at 4 times the tet + i."""
    corners = np.ascontiguousarray(tets.T)
    odd = np.empty((len(tets), 4), dtype=bool)
    for i, (a, b, c) in enumerate(corners[facet] for facet in FACETS):
        odd[:, i] = (a > b) ^ (a > c) ^ (b > c)  # the number of inversions
    return odd.reshape(-1)


# --- boundary facets that cross -------------------------------------------------------------------------------------


def _crossing(mesh: TetMesh, judge: _Judge) -> Ints:
    """(k, 2) rows of ``topology.boundary`` that have more in common than a vertex or an edge."""
    triangles = mesh.topology.boundary
    corners = mesh.points[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = overlapping(low, high, low, high)
    near = near[near[:, 0] < near[:, 1]]
    one, other, common = _common_first(triangles[near[:, 0]], triangles[near[:, 1]])
    bad = np.zeros(len(near), dtype=bool)

    hinged = np.flatnonzero(common == 2)
    bad[hinged] = _folded(one[hinged], other[hinged], judge)
    for shared in (0, 1):
        rows = np.flatnonzero(common == shared)
        for first, second in ((one, other), (other, one)):
            rows = rows[~_separated(first[rows], second[rows], shared, judge)]
        if len(rows):
            bad[rows] = _touching(one[rows], other[rows], shared, judge)
    return near[bad]


def _common_first(one: Ints, other: Ints) -> tuple[Ints, Ints, Ints]:
    """Two lists of triangles (k, 3) with the vertices they have in common moved to the front, and how many (k,)."""
    same = one[:, :, None] == other[:, None, :]
    here, there = same.any(axis=2), same.any(axis=1)
    order = np.argsort(np.where(here, one, np.iinfo(np.int64).max), axis=1, kind="stable")
    back = np.argsort(np.where(there, other, np.iinfo(np.int64).max), axis=1, kind="stable")
    return np.take_along_axis(one, order, axis=1), np.take_along_axis(other, back, axis=1), here.sum(axis=1)


def _folded(one: Ints, other: Ints, judge: _Judge) -> Bools:
    """Whether triangles with a common edge lie on each other: in one plane, and on one side of the edge."""
    bad = judge(predicates.fold, one, other[:, 2])[:, 0] > 0
    rows = np.flatnonzero(bad)
    bad[rows] = judge(predicates.volume, one[rows], other[rows, 2])[:, 0] == 0
    return bad


def _separated(one: Ints, other: Ints, shared: int, judge: _Judge) -> Bools:
    """Whether a plane through the first triangle, or upright on one of its edges, keeps the second to one side.

    Strictly, but for the common vertex; edges that do not have it cannot tell.
    """
    apart = np.zeros(len(one), dtype=bool)
    others = range(shared, 3)

    def search(polynomial: Polynomial, order: tuple[int, int, int], sides: tuple[int, ...]) -> None:
        rows = np.flatnonzero(~apart)
        if not len(rows):
            return
        found = [judge(polynomial, one[rows][:, order], other[rows, k])[:, 0] for k in others]
        for side in sides:
            apart[rows] |= np.all([sign == side for sign in found], axis=0)

    for order in ((0, 1, 2), (0, 2, 1), (1, 2, 0))[: 2 if shared else 3]:
        search(predicates.beyond_edge, order, (1,))
    search(predicates.volume, (0, 1, 2), (1, -1))  # last: it takes integers where both lie in one plane
    return apart


def _touching(one: Ints, other: Ints, shared: int, judge: _Judge) -> Bools:
    """Whether two triangles have a point in common besides a common vertex.

    Then an edge of one meets the other triangle; with a common vertex, the edge opposite to it does.
    """
    edges = ((1, 2),) if shared else ((0, 1), (0, 2), (1, 2))
    bad = np.zeros(len(one), dtype=bool)
    for triangle, spikes in ((one, other), (other, one)):
        for p, q in edges:
            rows = np.flatnonzero(~bad)
            bad[rows] = _pierced(triangle[rows], spikes[rows, p], spikes[rows, q], judge)
    return bad


def _pierced(triangle: Ints, p: Ints, q: Ints, judge: _Judge) -> Bools:
    """Whether segments meet triangles, both with their ends."""
    above = [judge(predicates.volume, triangle, end)[:, 0] for end in (p, q)]
    sides = (0, 1), (1, 2), (2, 0)
    around = np.stack([judge(predicates.volume, p, q, triangle[:, side])[:, 0] for side in sides])
    bad: Bools = (above[0] * above[1] <= 0) & ((around >= 0).all(axis=0) | (around <= 0).all(axis=0))
    flat = np.flatnonzero((above[0] == 0) & (above[1] == 0))
    if len(flat):
        bad[flat] = _pierced_in_plane(triangle[flat], p[flat], q[flat], judge)
    return bad


def _pierced_in_plane(triangle: Ints, p: Ints, q: Ints, judge: _Judge) -> Bools:
    """The same where all five points lie in a plane: no edge of the triangle, nor the segment, separates the two."""
    up = judge(predicates.normal, triangle)
    axis = np.argmax(up != 0, axis=1)  # along which the plane is seen as more than a line
    rows = np.arange(len(axis))
    turn = up[rows, axis]

    def side(a: Ints, b: Ints, x: Ints) -> NDArray[np.int8]:
        turned: NDArray[np.int8] = judge(predicates.normal, a, b, x)[rows, axis] * turn
        return turned

    apart = np.zeros(len(axis), dtype=bool)
    for k in range(3):
        a, b = triangle[:, k], triangle[:, (k + 1) % 3]
        apart |= (side(a, b, p) < 0) & (side(a, b, q) < 0)
    around = np.stack([side(p, q, triangle[:, k]) for k in range(3)])
    return ~(apart | (around > 0).all(axis=0) | (around < 0).all(axis=0))


# --- shells ---------------------------------------------------------------------------------------------------------


def _covered(mesh: TetMesh, judge: _Judge) -> Ints:
    """(k, 2) the tet of one facet of each shell, and another tet that has the middle of that facet in it."""
    triangles = mesh.topology.boundary
    chosen = np.unique(_shells(triangles, len(mesh.points)), return_index=True)[1]
    corners = mesh.points[triangles[chosen]]
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = _reaching(mesh, low.min(axis=0), high.max(axis=0))
    tet_corners = mesh.points[mesh.tets[near]]
    pairs = overlapping(low, high, tet_corners.min(axis=1), tet_corners.max(axis=1))
    pairs[:, 1] = near[pairs[:, 1]]
    own = mesh.topology.boundary_half_facets[chosen, 0]
    pairs = pairs[own[pairs[:, 0]] != pairs[:, 1]]
    for facet in FACETS:
        base = mesh.tets[pairs[:, 1]][:, facet]
        outside = judge(predicates.middle_above, base, triangles[chosen[pairs[:, 0]]])[:, 0] > 0
        pairs = pairs[~outside]
    return np.column_stack([own[pairs[:, 0]], pairs[:, 1]])


def _reaching(mesh: TetMesh, low: Floats, high: Floats) -> Ints:
    """(k,) the tets whose boxes have a point in common with one box, from ``low`` (3,) to ``high`` (3,)."""
    beyond = np.zeros(len(mesh.points), dtype=np.uint8)  # a bit for each side of the box that a point is beyond
    for bit, side in enumerate([*(mesh.points < low).T, *(mesh.points > high).T]):
        beyond |= side.astype(np.uint8) << bit
    one, two, three, four = (beyond[corner] for corner in mesh.tets.T)
    return np.flatnonzero((one & two & three & four) == 0)


def _shells(triangles: Ints, count: int) -> Ints:
    """(b,) a label per boundary facet, equal where edges with exactly two boundary facets join them."""
    _, owners, starts, sizes, _ = surface_edges(triangles, count)
    pairs = starts[sizes == 2]
    return components(owners[pairs], owners[pairs + 1], len(triangles))
