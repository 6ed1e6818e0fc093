"""Tets in their order round an edge: all round an edge inside, from facet to facet round one on a boundary."""

from dataclasses import dataclass

import numpy as np

from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.index_arrays import components
from wct_plugin.mesh.topology import EDGES
from wct_plugin.types import Bools, Ints


def _sides() -> Ints:
    """(6, 2) per row of ``EDGES`` the two other corners of a positive tet, counter-clockwise about the edge."""
    out = []
    for i, j in EDGES.tolist():
        k, m = (corner for corner in range(4) if corner not in (i, j))
        swaps = sum(a > b for n, a in enumerate((i, j, k, m)) for b in (i, j, k, m)[n + 1 :])
        out.append((k, m) if swaps % 2 == 0 else (m, k))
    return np.array(out)


_SIDES = _sides()


@dataclass(frozen=True, eq=False)
class Fans:
    """Wedges, a tet at one of its edges each, in fans about an edge from its smaller to its larger vertex.

    ``6 t + k`` is the wedge of tet t at row k of ``EDGES``. An edge has several fans where the tets at it do not hang
    together through facets.
    """

    edges: Ints  #: (f,) row of ``topology.edges``
    sizes: Ints  #: (f,) how many wedges
    closed: Bools  #: (f,) whether they go all round
    wedges: Ints  #: (w,) fan by fan, each counter-clockwise
    enter: Ints  #: (f,) row of ``topology.facets`` that an open fan begins with; of a closed one any
    leave: Ints  #: (f,) and that it ends with


def find_fans(mesh: TetMesh) -> Fans:
    """All fans of a mesh."""
    topology = mesh.topology
    count = 6 * len(mesh.tets)
    tet, local = np.divmod(np.arange(count), 6)
    ends = mesh.tets[tet[:, None], EDGES[local]]
    sides = np.where((ends[:, 0] < ends[:, 1])[:, None], _SIDES[local], _SIDES[local][:, ::-1])
    edge = topology.tet_edges.ravel()
    # Counter-clockwise goes from the first side to the second, out of the facet that lies opposite the first.
    beyond = topology.adjacency[tet, sides[:, 0]]
    after = np.where(beyond >= 0, 6 * beyond + (topology.tet_edges[beyond] == edge[:, None]).argmax(axis=1), -1)
    linked = np.flatnonzero(after >= 0)
    fan = components(linked, after[linked], count)
    first = np.ones(count, dtype=bool)
    first[after[linked]] = False
    closed = np.bincount(fan, first) == 0
    start = np.full(len(closed), count)
    np.minimum.at(start, fan, np.where(first | closed[fan], np.arange(count), count))
    place = _places(after, start, count)
    wedges = np.lexsort((place, fan))
    sizes = np.bincount(fan)
    last = wedges[np.cumsum(sizes) - 1]
    enter = topology.tet_facets[tet[start], sides[start, 1]]
    leave = topology.tet_facets[tet[last], sides[last, 0]]
    return Fans(edge[start], sizes, closed, wedges, enter, leave)


def _places(after: Ints, start: Ints, count: int) -> Ints:
    """(w,) how many wedges of its fan come before each: one step in all fans at once."""
    place = np.zeros(count, dtype=np.int64)
    here, begun, steps = start, start, 0
    while len(here):
        place[here] = steps
        steps += 1
        here = after[here]
        going = (here >= 0) & (here != begun)
        here, begun = here[going], begun[going]
    return place
