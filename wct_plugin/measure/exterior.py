"""The exterior derivative of a tet mesh: sparse matrices between its vertices, edges, facets and tets.

With the Hodge stars of :mod:`wct_plugin.measure.duals` a Laplacian is three lines:

>>> d0 = exterior_derivative(mesh, 0)  # doctest: +SKIP
>>> star1 = diags_array(hodge_star(mesh, 1))  # doctest: +SKIP
>>> laplacian = d0.T @ star1 @ d0  # minus the divergence of the gradient, over dual cells  # doctest: +SKIP
"""

import numpy as np
from scipy.sparse import csr_array

from wct_plugin.mesh import TetMesh
from wct_plugin.types import Ints


def exterior_derivative(mesh: TetMesh, k: int) -> csr_array:
    """The matrix, entries -1 and 1, that takes primal ``k``-forms to (k + 1)-forms, k = 0, 1, 2.

    Its transpose is the boundary operator. k = 0: (e, n) from vertices to ``topology.edges``, each from its smaller to
    its larger vertex. k = 1: (f, e) to ``topology.facets``, each round the way its row runs. k = 2: (m, f) to tets, out
    of each through its facets. Rows are ordered as the diagonals of :func:`wct_plugin.measure.duals.hodge_star`. Raises
    :class:`ValueError` for another k.
    """
    topology = mesh.topology
    if k == 0:
        return _matrix(topology.edges, np.broadcast_to([-1, 1], topology.edges.shape), len(mesh.points))
    if k == 1:
        begin, end = np.roll(topology.facets, -1, axis=1), np.roll(topology.facets, -2, axis=1)
        return _matrix(topology.facet_edges, np.where(begin < end, 1, -1), len(topology.edges))
    if k == 2:
        outward = np.ones(mesh.tets.shape, dtype=np.int64)
        pairs = topology.interior_pairs
        outward[pairs[:, 2], pairs[:, 3]] = -1
        return _matrix(topology.tet_facets, outward, len(topology.facets))
    raise ValueError(f"k is {k}; a tetrahedral mesh has derivatives of forms of degree 0, 1 and 2")


def _matrix(columns: Ints, signs: Ints, width: int) -> csr_array:
    starts = np.arange(0, columns.size + 1, columns.shape[1])
    made = csr_array((signs.ravel().astype(np.float64), columns.flatten(), starts), shape=(len(columns), width))
    made.sort_indices()  # in place, in a copy: the columns are the topology's own
    return made
