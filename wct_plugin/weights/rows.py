"""The orthocenters' heights as rows that are linear in the weights, and which vertices and tets are near a tet."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from wct_plugin.measure import compiled_quality, orthocenters
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import EDGES
from wct_plugin.types import Bools, Floats, Ints

#: Height over local length that counts as inside while weights are sought: above rounding, below anything of use.
CLEARANCE = 1e-4
#: How fast a height may grow with a weight, in a tet of size 1: in flatter ones rounding decides what HiGHS finds.
_STEEPEST = 1e5


@dataclass(frozen=True, eq=False)
class Rows:
    """What should be positive, ``constant + matrix @ weights``: four rows per tet, one per facet.

    Each is the height of the tet's orthocenter over the facet, over the tet's root mean square edge length.
    """

    tets: Ints  #: (m, 4)
    constant: Floats  #: (4m,)
    matrix: csr_array  #: (4m, n)
    #: (p, 4m) the dual length of each interior facet is a sum of two rows, here over the mean local length of its tets
    duals: csr_array
    unit: float  #: the weights are in multiples of it, which keeps the coefficients near 1
    around: csr_array  #: (n, m) the tets at each vertex
    facets: csr_array  #: (4m, p) the interior facet of each row

    def at(self, weights: Floats) -> Floats:
        """(4m,) the rows."""
        values: Floats = self.constant + self.matrix @ weights
        return values

    def near(self, tet: int, rings: int) -> tuple[Ints, Ints]:
        """The vertices at most ``rings`` edges from one of the tet's, and the tets with those; both ascending."""
        vertices = self.tets[tet]
        cells = self._at_vertices(vertices)
        for _ in range(rings):
            vertices = np.unique(self.tets[cells])
            cells = self._at_vertices(vertices)
        return np.sort(vertices), cells

    def part(self, at: Ints, free: Ints) -> tuple[csr_array, csr_array]:
        """By the weights ``free``: the rows ``at``, then the dual lengths they are in; these also by all rows."""
        duals = self.duals[np.unique(self.facets[at].indices)]
        part = self.matrix[at][:, free]
        return vstack([part, duals[:, at] @ part]).tocsr(), duals

    def _at_vertices(self, vertices: Ints) -> Ints:
        return np.unique(self.around[vertices].indices.astype(np.int64))


def lowest(values: Floats) -> Floats:
    """(m,) the smallest of each tet's four rows."""
    out: Floats = values.reshape(-1, 4).min(axis=1)
    return out


def contained(values: Floats) -> Bools:
    """(m,) whether each tet's four rows have at least half the clearance, so that rounding is no matter."""
    return np.asarray(lowest(values) > CLEARANCE / 2)


def rows_of(cells: Ints) -> Ints:
    """The four rows of each of the tets."""
    return (4 * cells[:, None] + np.arange(4)).ravel()


def by_weights(slopes: Floats, tets: Ints, count: int) -> csr_array:
    """(4m, count) the slopes (m, 4, 4) of ``orthocenters.slopes``, or a multiple of them, as rows by the weights."""
    columns = np.repeat(tets, 4, axis=0).ravel()
    starts = np.arange(0, 16 * len(tets) + 1, 4)
    return csr_array((slopes.ravel(), columns, starts), shape=(4 * len(tets), count))


def local_length(mesh: TetMesh) -> Floats:
    """(m,) root mean square length of each tet's six edges."""
    edges = mesh.points[mesh.tets[:, EDGES[:, 1]]] - mesh.points[mesh.tets[:, EDGES[:, 0]]]
    length: Floats = np.sqrt(np.einsum("mek,mek->m", edges, edges) / len(EDGES))
    return length


def make_rows(mesh: TetMesh) -> Rows:
    """The rows of a mesh; of a tet too flat to know nothing is asked: its rows are constant and always met."""
    count, length = len(mesh.tets), local_length(mesh)
    unit = float(np.median(length)) ** 2
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        slopes = orthocenters.slopes(mesh.points, mesh.tets) * (unit / length)[:, None, None]
        heights, errors = (of / length[:, None] for of in compiled_quality.heights(mesh.points, mesh.tets))
    steepness = np.abs(slopes).max(axis=(1, 2)) * length**2 / unit
    flat: Bools = ~((steepness < _STEEPEST) & np.isfinite(errors).all(axis=1))
    heights[flat], slopes[flat] = 1.0, 0.0
    matrix = by_weights(slopes, mesh.tets, len(mesh.points))
    corners = (np.ones(4 * count, dtype=bool), mesh.tets.ravel(), np.arange(0, 4 * count + 1, 4))
    around = csr_array(corners, shape=(count, len(mesh.points))).T.tocsr()
    pairs = mesh.topology.interior_pairs
    sides = pairs[:, [0, 2]] * 4 + pairs[:, [1, 3]]
    shares = length[pairs[:, [0, 2]]]
    shares /= shares.mean(axis=1, keepdims=True)
    starts = np.arange(0, 2 * len(pairs) + 1, 2)
    duals = csr_array((shares.ravel(), sides.ravel(), starts), shape=(len(pairs), 4 * count))
    return Rows(mesh.tets, heights.ravel(), matrix, duals, unit, around, duals.T.tocsr())
