"""Volumes, areas and lengths of cells with mid nodes, exact but for rounding or to many digits."""

from itertools import product

import numpy as np

from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.second_order import edge_points, facet_points, jacobian_coefficients, sampled
from wct_plugin.mesh.triangle_surfaces import SIDES
from wct_plugin.types import Floats, Ints

#: Points and weights of Gauss's rule from 0 to 1.
_AT, _WEIGHT = (one / 2.0 for one in np.polynomial.legendre.leggauss(8))
_AT = _AT + 0.5


class CurvedCells:
    """The cells of a mesh with mid nodes (e, 3) of its edges, in the order of the topology's."""

    def __init__(self, mesh: TetMesh, middles: Floats) -> None:
        self._mesh, self._middles = mesh, middles

    def volumes(self) -> Floats:
        """(m,) of the tets."""
        corners, middles = self._mesh.points[self._mesh.tets], self._middles[self._mesh.topology.tet_edges]
        coefficients = jacobian_coefficients(corners, middles).reshape(len(corners), 64)
        # Of each monomial the product of the factorials of how often each coordinate occurs.
        same = np.array([{1: 6, 2: 2, 3: 1}[len(set(index))] for index in product(range(4), repeat=3)])
        volumes: Floats = coefficients @ same * (8.0 / 720.0)
        return volumes

    def areas(self, triangles: Ints) -> Floats:
        """(k,) of facets (k, 3)."""
        nodes = np.concatenate([self._mesh.points[triangles], self.of_facets(triangles)], axis=1)
        step = 1e-3  # differences of a quadratic are exact but for rounding
        total = np.zeros(len(triangles))
        for (u, wu), (v, wv) in product(zip(_AT, _WEIGHT, strict=True), repeat=2):
            at = np.array([(1.0 - u) * (1.0 - v), u, (1.0 - u) * v])
            across = []
            for to in (1, 2):
                move = np.zeros(3)
                move[[0, to]] = -step, step
                ends = [facet_points(nodes, np.broadcast_to(at + sign * move, (len(nodes), 3))) for sign in (1, -1)]
                across.append((ends[0] - ends[1]) / (2.0 * step))
            total += wu * wv * (1.0 - u) * np.linalg.norm(np.cross(across[0], across[1]), axis=1)
        return total

    def lengths(self, edges: Ints) -> Floats:
        """(k,) of edges (k, 2)."""
        row = find_rows(self._mesh.topology.edges, np.sort(edges, axis=1), len(self._mesh.points))
        nodes = np.concatenate([self._mesh.points[edges], self._middles[row][:, None]], axis=1)
        step, total = 1e-3, np.zeros(len(edges))
        for at, weight in zip(_AT, _WEIGHT, strict=True):
            ends = [edge_points(nodes, np.full(len(nodes), at + sign * step)) for sign in (1, -1)]
            total += weight * np.linalg.norm(ends[0] - ends[1], axis=1) / (2.0 * step)
        return total

    def of_facets(self, triangles: Ints) -> Floats:
        """(k, 3, 3) the mid nodes of facets."""
        sides = np.sort(triangles[:, SIDES].reshape(-1, 2), axis=1)
        row = find_rows(self._mesh.topology.edges, sides, len(self._mesh.points))
        return self._middles[row].reshape(-1, 3, 3)

    def surface(self, triangles: Ints) -> SurfaceMesh:
        """Facets (k, 3) as they are curved, in small triangles."""
        tags = np.zeros(len(triangles), dtype=np.int64)
        return sampled(self._mesh.points, triangles, self.of_facets(triangles), tags)


def middles_as_read(mesh: TetMesh) -> Floats:
    """(e, 3) the mid nodes of a mesh whose edges are those that were read."""
    ends = mesh.points[mesh.topology.edges]
    return ends.mean(axis=1) if mesh.second_order is None else mesh.second_order.middles_of(ends)[0]
