"""What a facet that may not change rules out for the tets behind it, however the inside is meshed.

Theorems
--------
**A facet that is not acute** leaves no completely well-centered tet on it: being acute is part of that.

**Lean.** *A tet that contains its circumcenter, on a facet that is not acute, has a dihedral angle above 90 degrees at
the facet's longest edge.* The circumcenter X of the tet stands above the circumcenter of the facet, which lies on that
edge or beyond it. So the half-plane from the edge through X makes an angle of at least 90 degrees with the facet; and X
is strictly inside the tet, so the dihedral angle is larger than that.

**No room.** *Where the next surface facet round that edge comes within 90 degrees, no tet fits:* tets do not
reach through the surface, so the dihedral angle is 90 degrees at most.

**No room for two.** *Two surface facets at most 180 degrees apart (in a plane, or in a convex wedge), neither acute,
with one longest edge, are not both facets of 3WC tets on that side.* If the two tets are different, their dihedral
angles at the edge, each above 90 degrees, fit into 180. If it is one tet, the half-plane through its X is at least
90 degrees away from both facets and strictly between them, so that they are more than 180 degrees apart. Two right
triangles that make a rectangle on a flat boundary are the common case.

All signs are exact on the coordinates as they are stored: an angle that is right but for rounding rules nothing out if
the rounding made it acute.
"""

from dataclasses import dataclass

import numpy as np

from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import exact_signs
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.strata import Strata
from wct_plugin.mesh.triangle_surfaces import surface_edges
from wct_plugin.obstructions.reason import Reason
from wct_plugin.types import Bools, Floats, Ints

NOT_ACUTE = "a fixed facet is not acute, so no tet on it is completely well-centered"
NO_ROOM = (
    "a tet that contains its circumcenter needs a dihedral angle above 90° at a fixed facet's longest edge, unless the"
    " facet is acute; the surface leaves less"
)
NO_ROOM_FOR_TWO = (
    "two fixed facets that are not acute each need a dihedral angle above 90° at their common longest edge; 180° is too"
    " little"
)


@dataclass(frozen=True, eq=False)
class _Blocked:
    """Sides of surface facets, as rows of facet and side (0 behind, 1 in front), and why they are blocked."""

    alone: Ints  #: (a, 2) on which no tet can meet the goal
    pairs: Ints  #: (p, 4) two sides on which not both tets can


def reasons(mesh: TetMesh, of: Strata, stay: Bools | None = None, *, acute: bool, frees: str) -> list[Reason]:
    """Why tets on the surface facets of ``of`` that ``stay`` (t,) as they are, by default all, cannot meet the goal.

    ``acute``: the goal includes acute facets.
    """
    rows = np.ones(len(of.triangles), dtype=bool) if stay is None else stay
    sides, triangles = _sides(mesh, of.triangles)[rows], of.triangles[rows]
    longest = _longest_edges(mesh.points, triangles)
    names = list(map(tuple, np.sort(triangles, axis=1).tolist()))
    edges = list(map(tuple, np.sort(longest[:, :2], axis=1).tolist()))
    found = _blocked(mesh.points, triangles, sides, longest, acute=acute)
    tets = sides.tolist()
    if acute:
        behind = np.unique(found.alone[:, 0]).tolist()
        return [Reason((names[f],), NOT_ACUTE, tuple(t for t in tets[f] if t >= 0), frees) for f in behind]
    out = [Reason((names[f], edges[f]), NO_ROOM, (tets[f][s],), frees) for f, s in found.alone.tolist()]
    for f, s, g, t in found.pairs.tolist():
        both = tuple(sorted({tets[f][s], tets[g][t]}))
        out.append(Reason((names[f], names[g], edges[f]), NO_ROOM_FOR_TWO, both, frees))
    return out


def ruled_out(points: Floats, triangles: Ints, sides: Ints, *, acute: bool) -> Ints:
    """Rows of ``triangles`` (t, 3) with a reason on every side that has a tet, as long as all of these facets stay.

    ``sides`` (t, 2): what is behind each and in front of it, a tet or a region, -1 for nothing.
    """
    found = _blocked(points, triangles, sides, _longest_edges(points, triangles), acute=acute)
    open_to_some = sides >= 0
    for blocked in (found.alone, found.pairs[:, :2], found.pairs[:, 2:]):
        open_to_some[blocked[:, 0], blocked[:, 1]] = False
    return np.flatnonzero(~open_to_some.any(axis=1))


def _longest_edges(points: Floats, triangles: Ints) -> Ints:
    """(t, 3) the triangles, turned so that the first two are the edge opposite an angle that is not acute, else -1."""
    right = exact_signs(predicates.corners, points, triangles).values < 1
    apex = np.argmax(right, axis=1)
    turned: Ints = np.take_along_axis(triangles, (apex[:, None] + [1, 2, 3]) % 3, axis=1)
    turned[~right.any(axis=1)] = -1
    return turned


def _sides(mesh: TetMesh, triangles: Ints) -> Ints:
    """(t, 2) the tet behind each triangle of :attr:`Strata.triangles`, which runs out of it, and the one in front."""
    topology = mesh.topology
    outer, between = topology.boundary_half_facets[:, 0], topology.interface_pairs[:, [0, 2]]
    inner = triangles[len(outer) + len(between) :]
    pairs = topology.interior_pairs
    if len(inner):
        touched = np.zeros(len(mesh.points), dtype=bool)
        touched[inner] = True
        pairs = pairs[touched[mesh.tets[pairs[:, 0]]].sum(axis=1) >= 3]
        from_first = np.sort(topology.triangles_of(pairs[:, :2]), axis=1)
        pairs = pairs[find_rows(from_first, np.sort(inner, axis=1), len(mesh.points))]
    else:
        pairs = pairs[:0]
    return np.concatenate([np.column_stack([outer, np.full(len(outer), -1)]), between, pairs[:, [0, 2]]])


def _blocked(points: Floats, triangles: Ints, sides: Ints, longest: Ints, *, acute: bool) -> _Blocked:
    rows = np.flatnonzero(longest[:, 0] >= 0)
    if acute:
        there = np.argwhere(sides[rows] >= 0)
        return _Blocked(np.column_stack([rows[there[:, 0]], there[:, 1]]), np.empty((0, 4), dtype=np.int64))
    one, other, same_way = _at_one_edge(len(points), triangles, longest, rows)
    apex = triangles[other].sum(axis=1) - longest[one, :2].sum(axis=1)
    cells = np.column_stack([longest[one], apex])
    above = exact_signs(predicates.volume, points, cells).values[:, 0]
    near = exact_signs(predicates.fold, points, cells).values[:, 0]
    alone, pairs = [], []
    for side, towards in enumerate((-1, 1)):
        there = sides[one, side] >= 0
        convex = above == towards
        tight = there & convex & (near >= 0)
        alone.append(np.column_stack([one[tight], np.full(tight.sum(), side)]))
        far = np.where(same_way, 1 - side, side)  # the other facet's side that looks into the same wedge
        wide = there & (convex | ((above == 0) & (near < 0))) & ~tight & (one < other)
        wide &= (np.sort(longest[one, :2], axis=1) == np.sort(longest[other, :2], axis=1)).all(axis=1)
        wide &= np.take_along_axis(sides[other], far[:, None], axis=1)[:, 0] >= 0
        pairs.append(np.column_stack([one, np.full(len(one), side), other, far])[wide])
    return _Blocked(np.unique(np.concatenate(alone), axis=0), np.concatenate(pairs))


def _at_one_edge(count: int, triangles: Ints, longest: Ints, rows: Ints) -> tuple[Ints, Ints, Bools]:
    """Pairs of facets: one of ``rows``, another one at its longest edge; and whether both run through it one way."""
    edges, owners, starts, sizes, forward = surface_edges(triangles, count)
    scale = [count, 1]
    edge = np.searchsorted(edges @ scale, np.sort(longest[rows, :2], axis=1) @ scale)
    around = sizes[edge]
    at = np.arange(around.sum()) - np.repeat(np.cumsum(around) - around - starts[edge], around)
    one = np.repeat(rows, around)
    other = owners[at]
    own_way = longest[one, 0] < longest[one, 1]
    apart = one != other
    return one[apart], other[apart], (own_way == forward[at])[apart]
