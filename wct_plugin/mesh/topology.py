"""Who touches whom in a tet mesh: boundary, interfaces, adjacency, edges, components. Derived lazily."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wct_plugin.core import _core
from wct_plugin.errors import NoMeshError
from wct_plugin.mesh.index_arrays import components
from wct_plugin.types import Bools, Ints

#: Facet i lies opposite vertex i; its vertices run counter-clockwise seen from outside a positive tet.
FACETS = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
#: The six edges of a tet.
EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])
#: (12,) row of :data:`EDGES` for the edge of facet i opposite its corner ``FACETS[i, k]``, at 3 i + k.
OPPOSITE_EDGES = np.array(
    [EDGES.tolist().index(sorted(facet[facet != corner].tolist())) for facet in FACETS for corner in facet]
)


class Topology:
    """Derived connectivity of ``tets`` (m, 4) on ``count`` points with a region tag per tet (m,)."""

    def __init__(self, tets: Ints, regions: Ints, count: int) -> None:
        self._tets = tets
        self._regions = regions
        self._count = count

    @cached_property
    def half_facets(self) -> tuple[Ints, Ints]:
        """Half-facets (4 * tet + facet, opposite that vertex) that face each other, and those that face nothing.

        Returns ``pairs`` (p, 2), the first the smaller, and ``single`` (b,), ascending.
        Raises :class:`wct_plugin.errors.InputError` where three or more tets share a facet.
        """
        pairs, single, crowded = _core.facet_pairs(self._tets, self._count)
        if crowded:
            a, b, c, *tets = crowded_facets(self._tets, self._count)[0].tolist()
            raise NoMeshError(
                f"facet ({a}, {b}, {c}) belongs to tets {tets[0]}, {tets[1]} and {tets[2]}; at most two may share one"
            )
        return pairs, single

    @cached_property
    def adjacency(self) -> Ints:
        """(m, 4) the tet across facet i (opposite vertex i), -1 on the boundary."""
        pairs, _ = self.half_facets
        out = np.full(4 * len(self._tets), -1, dtype=np.int64)
        out[pairs[:, 0]] = pairs[:, 1] >> 2
        out[pairs[:, 1]] = pairs[:, 0] >> 2
        return out.reshape(-1, 4)

    @cached_property
    def interior_pairs(self) -> Ints:
        """(p, 4) per interior facet: tet, its local facet, the tet across, its local facet."""
        pairs, _ = self.half_facets
        out = np.empty((len(pairs), 4), dtype=np.int64)
        np.right_shift(pairs, 2, out=out[:, ::2])
        np.bitwise_and(pairs, 3, out=out[:, 1::2])
        return out

    @cached_property
    def boundary_half_facets(self) -> Ints:
        """(b, 2) per boundary facet: its tet and local facet."""
        _, single = self.half_facets
        return np.column_stack([single // 4, single % 4])

    @cached_property
    def boundary(self) -> Ints:
        """(b, 3) boundary triangles, oriented outward."""
        return self.triangles_of(self.boundary_half_facets)

    @cached_property
    def interface_pairs(self) -> Ints:
        """(k, 4) rows of :attr:`interior_pairs` whose two tets have different region tags."""
        pairs = self.interior_pairs
        across: Ints = pairs[self._regions[pairs[:, 0]] != self._regions[pairs[:, 2]]]
        return across

    @cached_property
    def interfaces(self) -> Ints:
        """(k, 3) triangles between two regions, oriented out of the first tet of :attr:`interface_pairs`."""
        return self.triangles_of(self.interface_pairs[:, :2])

    def triangles_of(self, half_facets: Ints) -> Ints:
        """(k, 3) the triangles of rows of tet and local facet, oriented out of the tet."""
        triangles: Ints = self._tets[half_facets[:, :1], FACETS[half_facets[:, 1]]]
        return triangles

    @cached_property
    def boundary_points(self) -> NDArray[np.bool_]:
        """(n,) mask of the points on the boundary."""
        out = np.zeros(self._count, dtype=bool)
        out[self.boundary] = True
        return out

    @cached_property
    def facets(self) -> Ints:
        """(f, 3) every facet once: those of :attr:`interior_pairs`, out of their first tet, then :attr:`boundary`."""
        return np.concatenate([self.triangles_of(self.interior_pairs[:, :2]), self.boundary])

    @cached_property
    def tet_facets(self) -> Ints:
        """(m, 4) the row of :attr:`facets` for the facet opposite each vertex."""
        pairs, single = self.half_facets
        out = np.empty(4 * len(self._tets), dtype=np.int64)
        out[pairs] = np.arange(len(pairs))[:, None]
        out[single] = len(pairs) + np.arange(len(single))
        return out.reshape(-1, 4)

    @cached_property
    def _edges(self) -> tuple[Ints, Ints]:
        return _core.edge_table(self._tets, self._count)

    @property
    def edges(self) -> Ints:
        """(e, 2) every edge once, ends ascending, rows in lexicographic order."""
        return self._edges[0]

    @cached_property
    def edge_valence(self) -> Ints:
        """(e,) how many tets meet at each row of :attr:`edges`."""
        return np.bincount(self.tet_edges.ravel(), minlength=len(self.edges))

    @property
    def tet_edges(self) -> Ints:
        """(m, 6) the row of :attr:`edges` for each of a tet's edges, columns as :data:`EDGES`."""
        return self._edges[1]

    @cached_property
    def facet_edges(self) -> Ints:
        """(f, 3) the row of :attr:`edges` opposite each corner of a row of :attr:`facets`."""
        return self._edges_of(np.concatenate([self.interior_pairs[:, :2], self.boundary_half_facets]))

    def _edges_of(self, half_facets: Ints) -> Ints:
        """(k, 3) the row of :attr:`edges` opposite each corner, by rows of tet and local facet."""
        edges: Ints = self.tet_edges[half_facets[:, :1], OPPOSITE_EDGES.reshape(4, 3)[half_facets[:, 1]]]
        return edges

    @cached_property
    def boundary_edges(self) -> Bools:
        """(e,) mask of the edges on the boundary."""
        out = np.zeros(len(self.edges), dtype=bool)
        out[self._edges_of(self.boundary_half_facets)] = True
        return out

    @cached_property
    def pieces(self) -> Ints:
        """(m,) a label per tet, equal where a path through facets within one region joins two tets, from 0."""
        pairs = self.interior_pairs
        same = pairs[self._regions[pairs[:, 0]] == self._regions[pairs[:, 2]]]
        return components(same[:, 0], same[:, 2], len(self._tets))

    @cached_property
    def components(self) -> Ints:
        """(m,) a label per tet, equal where a path through facets joins two tets; labels count from 0."""
        pairs = self.interior_pairs
        return components(pairs[:, 0], pairs[:, 2], len(self._tets))


def crowded_facets(tets: Ints, count: int) -> Ints:
    """(k, 6) the facets that three or more of the tets (m, 4) share: three vertices, the first three of the tets."""
    return _crowds(tets, *_core.facet_order(tets, count))


def folded_pairs(tets: Ints) -> tuple[Ints, Bools]:
    """The tets (p, 2) that share a facet, one pair for each, and whether both lie on the same side of it (p,).

    All tets must have positive volume. Of three or more tets at a facet neighbours in the order of the rows are paired.
    """
    facets = tets[:, FACETS].reshape(-1, 3)
    a, b, c = facets.T
    odd = (a > b) ^ (a > c) ^ (b > c)
    order, same = _core.facet_order(tets, int(tets.max(initial=0)) + 1)
    first = np.flatnonzero(same)
    return np.column_stack([order[first], order[first + 1]]) // 4, odd[order[first]] == odd[order[first + 1]]


def _crowds(tets: Ints, order: Ints, same: Bools) -> Ints:
    """(k, 6) the facets that occur three times or more, once each, with the first three of their tets."""
    third = np.flatnonzero(same[1:] & same[:-1])
    third = third[np.diff(third, prepend=-2) > 1]
    half = order[third[:, None] + np.arange(3)]
    corners = np.sort(tets[half[:, :1] // 4, FACETS[half[:, 0] % 4]], axis=1)
    return np.column_stack([corners, half // 4])
