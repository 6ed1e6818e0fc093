"""What the connectivity and vertices, or directions, that may not change rule out for a tet.

A vertex is *held* if it may not move. The direction from a held vertex to another is held if that one is held too, or
if the edge between them is on a straight crease, along which the other vertex slides.

Theorems
--------
**A held tet** is what it is: if its circumcenter is not inside, that stays so.

**A held angle** of a facet, between two held directions, that is not acute leaves the facet with it.

**Two held angles.** *In a tet that contains its circumcenter, of the three facet angles at a vertex v at most one is
not acute.* Put v at the origin and call the other vertices a, b, c and the circumcenter X = p a + q b + r c, with
p, q, r > 0 and p + q + r < 1. The four unit vectors u_i from X to the vertices have a positive combination
sum w_i u_i = 0 with the barycentric coordinates w_i of X; so w_i = |sum of the others| < sum of the other w_j = 1 - w_i
(they are not all parallel), which gives p < 1/2. X is as far from v as from a: X . a = |a|^2 / 2. But if the angles of
a with b and with c are both not acute, X . a = p |a|^2 + q a . b + r a . c <= p |a|^2 < |a|^2 / 2. So every edge at v
makes an acute angle with one of the two others, and two angles that are not acute would share an edge. A tet at the
corner of a box, with three right angles, is the common case.
"""

from itertools import combinations

import numpy as np

from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import exact_signs
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import Strata
from wct_plugin.obstructions.reason import Reason
from wct_plugin.types import Bools, Ints

HELD_TET = "all four vertices stay, and the circumcenter is not inside"
HELD_ANGLE = "a facet angle that is not acute, between vertices that stay or edges on straight creases"
TWO_HELD_ANGLES = (
    "a tet that contains its circumcenter has at each vertex at most one facet angle that is not acute; here two are"
    " held by vertices that stay or by straight creases"
)


def reasons(mesh: TetMesh, of: Strata, held: Bools, tets: Ints, *, goal: str, frees: str) -> list[Reason]:
    """Why some of ``tets`` (k,) cannot meet the goal as long as they are there and ``held`` (n,) vertices stay."""
    cells = mesh.tets[tets]
    out = []
    if goal != "2wc":
        stuck = tets[held[cells].all(axis=1)]
        outside = exact_signs(predicates.circumcenter, mesh.points, mesh.tets[stuck]).values.min(axis=1) < 1
        out += [Reason((tuple(sorted(mesh.tets[t].tolist())),), HELD_TET, (t,), frees) for t in stuck[outside].tolist()]
    angles = _held_angles(mesh, of, held, cells)
    if goal != "3wc":
        blamed: dict[tuple[int, ...], set[int]] = {}
        for row, apex, one, two in angles.tolist():
            blamed.setdefault(tuple(sorted((apex, one, two))), set()).add(int(tets[row]))
        out += [Reason((facet,), HELD_ANGLE, tuple(sorted(on)), frees) for facet, on in blamed.items()]
    if goal != "2wc":
        corners, count = np.unique(angles[:, :2], axis=0, return_counts=True)
        for row, apex in corners[(count >= 2) & ~held[cells[corners[:, 0]]].all(axis=1)].tolist():
            cell = tuple(sorted(cells[row].tolist()))
            out.append(Reason(((apex,), cell), TWO_HELD_ANGLES, (int(tets[row]),), frees))
    return out


def straight(mesh: TetMesh, of: Strata) -> Bools:
    """(s,) which of ``of.segments`` are on a curve whose points are exactly on one line."""
    curves, first = np.unique(of.curve, return_index=True)
    ends = of.segments[first[np.searchsorted(curves, of.curve)]]
    turned = np.zeros(len(of.segments), dtype=bool)
    for vertex in of.segments.T:
        turned |= (exact_signs(predicates.normal, mesh.points, np.column_stack([ends, vertex])).values != 0).any(axis=1)
    bent = np.zeros(int(curves.max(initial=-1)) + 1, dtype=bool)
    bent[of.curve[turned]] = True
    return ~bent[of.curve]


def _held_angles(mesh: TetMesh, of: Strata, held: Bools, cells: Ints) -> Ints:
    """Angles of tets ``cells`` (k, 4) between held directions that are not acute: rows of row, vertex, its two ends."""
    count = len(mesh.points)
    creases = of.segments[straight(mesh, of)] @ [count, 1]
    found = []
    for apex in range(4):
        vertex = cells[:, apex]
        others = np.delete(cells, apex, axis=1)
        ends = np.sort(np.stack(np.broadcast_arrays(vertex[:, None], others), axis=-1), axis=-1)
        fixed = held[vertex][:, None] & (held[others] | np.isin(ends @ [count, 1], creases))
        for one, two in combinations(range(3), 2):
            row = np.flatnonzero(fixed[:, one] & fixed[:, two])
            corner = np.column_stack([vertex[row], others[row, one], others[row, two]])
            wide = exact_signs(predicates.corners, mesh.points, corner).values[:, 0] < 1
            found.append(np.column_stack([row, corner])[wide])
    return np.concatenate(found)
