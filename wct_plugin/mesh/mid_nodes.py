"""Where the mid nodes of tets go: where edges stayed to where they were, on the curved surface, or half way."""

from dataclasses import dataclass

import numpy as np

from wct_plugin.mesh import cell_kinds
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.mesh import TetMesh
from wct_plugin.mesh.second_order import SecondOrder, may_fold
from wct_plugin.mesh.strata import find_strata
from wct_plugin.types import Bools, Floats

#: A new mid node goes on a curve or surface at most this far away, in lengths of its edge.
_NEAR = 0.5
#: An edge is on a curved crease whose ends are at most this far off it, in its length.
_BESIDE = 0.05
#: Nearer than this, in lengths of its edge, it is there.
_THERE = 1e-9


@dataclass(frozen=True, eq=False)
class Middles:
    """Mid nodes of the edges of tets."""

    points: Floats  #: (e, 3)
    kept: int  #: on curved edges that stayed
    curved: int  #: on the curved surface, off the middle of new edges
    straightened: int  #: half way though the surface is curved there, as a tet might turn round inside

    def describe(self, count: int) -> str:
        """What there is to say of a file with so many new mid nodes."""
        said = f"written with {count} mid nodes (order=1 leaves them out)"
        if self.kept or self.curved or self.straightened:
            said += f": {self.kept} stay on curved edges, {self.curved} are new on the curved surface"
        if self.straightened:
            said += f", {self.straightened} are half way, as a tet might fold there"
        return said


def find_middles(mesh: TetMesh) -> Middles:
    """The mid nodes of all edges of the tets, in the order of the topology's edges."""
    edges = mesh.topology.edges
    ends = mesh.points[edges]
    of = mesh.second_order
    if of is None or not len(of.ends):
        return Middles(ends.mean(axis=1), 0, 0, 0)
    middles, kept = of.middles_of(ends)
    moved = np.zeros(len(edges), dtype=bool)
    if of.curved:
        moved = _put_on_surface(mesh, of, middles, kept)
    straightened = _straighten(mesh, of, middles, kept, moved)
    return Middles(middles, int(kept.sum()), int(moved.sum()), straightened)


def _put_on_surface(mesh: TetMesh, of: SecondOrder, middles: Floats, kept: Bools) -> Bools:
    """Move mid nodes of new edges of the surface to where it is curved; which were moved."""
    edges, count = mesh.topology.edges, len(mesh.points)
    strata = find_strata(mesh)
    sides = strata.triangles[:, np.array(cell_kinds.EDGES["triangle"])].reshape(-1, 2)
    length = np.linalg.norm(mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]], axis=1)
    moved = np.zeros(len(edges), dtype=bool)
    surface = find_rows(np.sort(sides, axis=1), edges, count) >= 0
    crease = find_rows(strata.segments, edges, count) >= 0
    rows = np.flatnonzero(crease)
    for end in (0, 1):  # what only its angle makes a crease may be none of the curved surface
        at = mesh.points[edges[rows, end]]
        far = np.linalg.norm(of.nearest_on_creases(at) - at, axis=1) > _BESIDE * length[rows]
        crease[rows[far]] = False
    for rows, nearest in (
        (np.flatnonzero(crease & ~kept), of.nearest_on_creases),
        (np.flatnonzero(surface & ~crease & ~kept), of.nearest_on_facets),
    ):
        found = nearest(middles[rows])
        off = np.linalg.norm(found - middles[rows], axis=1)
        near = (off > _THERE * length[rows]) & (off <= _NEAR * length[rows])
        middles[rows[near]] = found[near]
        moved[rows[near]] = True
    return moved


def _straighten(mesh: TetMesh, of: SecondOrder, middles: Floats, kept: Bools, moved: Bools) -> int:
    """Put mid nodes half way in tets that may turn round inside, but for those that came so; how many.

    They are cleared in the masks. Nodes that stayed go only where clearing the others is not enough.
    """
    topology = mesh.topology
    count = 0
    for clears in (moved, kept):
        while True:
            rows = np.flatnonzero((moved | kept)[topology.tet_edges].any(axis=1))
            corners = mesh.points[mesh.tets[rows]]
            bad = may_fold(corners, middles[topology.tet_edges[rows]])
            bad[bad] = ~of.came_folded(corners[bad])
            found = np.unique(topology.tet_edges[rows[bad]])
            found = found[clears[found]]
            if not len(found):
                break
            clears[found] = False
            middles[found] = mesh.points[topology.edges[found]].mean(axis=1)
            count += len(found)
    return count
