"""What the connectivity round an inner vertex rules out, wherever its vertices go.

Let v be an inner vertex with n edges, in a valid mesh: the tets at v fill all directions. Neighbours of v are *joined*
if they are in a facet with v. They are taken as vectors from v.

Theorems
--------
**Acute facets need 9 edges.** *If all facets at v are acute, then for each neighbour a at least three other neighbours
are not joined to a; so n >= 9.* The direction opposite to a is in the cone of some tet at v: -a = p x + q y + r z with
p, q, r >= 0, where x, y, z are joined to one another, so that their dot products are positive. Then
-a . x = p |x|^2 + q x . y + r x . z > 0, and likewise for y and z: all three are at more than 90 degrees from a, hence
neither a itself nor joined to it. The number joined to a is the number d(a) of tets at the edge v-a: d(a) <= n - 4.
The neighbours and their joints are a triangulated sphere, in which the sum of all d(a) is 6 n - 12. So
6 n - 12 <= n (n - 4), which fails for n = 4 ... 8. (The bound is that of VanderZee, Hirani, Guoy, Zharnitsky and Ramos,
*Geometric and combinatorial properties of well-centered triangulations*, 2009, who have a mesh with 9, too.)

**3WC needs 6 edges.** *If all tets at v contain their circumcenters, n >= 6.* Call a joint *wide* if its angle at v is
not acute. (1) Each tet at v has at most one wide joint, see :mod:`wct_plugin.obstructions.fixed_vertices`. (2) For each
neighbour a some tet (v, x, y, z) without a has two of x, y, z at more than 90 degrees from a. For let -a = p x + q y +
r z as above; a is not in that tet, since x, y, z are linearly independent. If none of its joints is wide, all three
are, as above. Else let x y be the wide one, and take unit vectors. -a . z = p x . z + q y . z + r > 0; and -a . x and
-a . y are not both <= 0, for their sum (p + q) (1 + x . y) + r (x . z + y . z) is positive.

n = 4: a is joined to b, c, d, and by (2) two of these joints are wide; they are in one tet, against (1). n = 5: the
joints are those of a double pyramid over a triangle x y z with apexes a and b. A tet without x is (v, a, y, z) or
(v, b, y, z), so by (2) two wide joints of x go to two of a, y, z or of b, y, z. To an apex and y, or z, they would be
in one tet; so they go to y and z. In the same way those of y go to x and z: all three sides of the triangle are wide.
A tet without a is v, b and two of x, y, z, so by (2) a wide joint goes from a to one of those, x say; it is in
(v, a, x, y) together with x y, against (1).

The paper shows n >= 7; that n = 6 is impossible is not proven here, and not claimed.
"""

import numpy as np

from wct_plugin.mesh import TetMesh
from wct_plugin.obstructions.reason import Reason
from wct_plugin.obstructions.stars import Stars
from wct_plugin.types import Bools

FEW_FOR_ACUTE = "an inner vertex with fewer than 9 edges has a facet that is not acute"
CROWDED = (
    "an inner vertex has a facet that is not acute if at most two of its neighbours are in no facet with this edge"
)
FEW_FOR_3WC = "an inner vertex with fewer than 6 edges has a tet that does not contain its circumcenter"


def reasons(mesh: TetMesh, stars: Stars, near: Bools, *, goal: str, frees: str) -> list[Reason]:
    """Why the tets at an inner vertex cannot all meet the goal in this connectivity, one reason per vertex at most.

    ``stars`` are those of the mesh's tets, ``near`` (n,) the vertices to look at.
    """
    edges, valence = mesh.topology.edges, mesh.topology.edge_valence
    count = np.bincount(edges.ravel(), minlength=len(mesh.points))
    inner = near & ~mesh.topology.boundary_points & (count > 0)
    if goal == "3wc":
        few = np.flatnonzero(inner & (count < 6))
        return [Reason(((v,),), FEW_FOR_3WC, tuple(stars.at(v).tolist()), frees) for v in few.tolist()]
    sparse = inner & (count < 9)
    out = [Reason(((v,),), FEW_FOR_ACUTE, tuple(stars.at(v).tolist()), frees) for v in np.flatnonzero(sparse).tolist()]
    crowd = np.full(len(mesh.points), -1)
    for end in (0, 1):
        crowded = np.flatnonzero((valence > count[edges[:, end]] - 4) & (inner & ~sparse)[edges[:, end]])
        crowd[edges[crowded, end]] = crowded
    for v in np.flatnonzero(crowd >= 0).tolist():
        edge = tuple(edges[crowd[v]].tolist())
        out.append(Reason(((v,), edge), CROWDED, tuple(stars.at(v).tolist()), frees))
    return out
