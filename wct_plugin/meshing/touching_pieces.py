"""Pieces of a region that touch each other in edges or vertices alone, as two cubes that share an edge do.

Round such a joint the region lies on both sides of outside, so that nothing tells where one piece ends. As regions of
their own they are like bodies of two materials, whose joint every step of the remesher keeps.
"""

from dataclasses import dataclass, replace

import numpy as np

from wct_plugin.mesh import TetMesh
from wct_plugin.meshing.reference import Reference
from wct_plugin.types import Ints


@dataclass(frozen=True, eq=False)
class TouchingPieces:
    """A mesh whose pieces are regions of their own, and the way back."""

    mesh: TetMesh
    tags: Ints  #: (k,) ascending, of the pieces and of all other regions
    origin: Ints  #: (k,) the region that each of them is, or is a piece of

    def whole(self, mesh: TetMesh) -> TetMesh:
        """A mesh made of it, with the regions as they were."""
        return replace(mesh, regions=self.origin[np.searchsorted(self.tags, mesh.regions)])

    def whole_surface(self, on: Reference) -> Reference:
        """The same of a surface."""
        regions, index = np.unique(self.origin[np.searchsorted(self.tags, on.regions)], return_inverse=True)
        sides = np.where(on.sides < 0, -1, index[on.sides])
        return replace(on, regions=regions, sides=sides)


def set_apart(mesh: TetMesh) -> TouchingPieces | None:
    """The mesh with pieces that share an edge as regions of their own; None where there are no such pieces."""
    topology, piece = mesh.topology, mesh.topology.pieces
    count = int(piece.max()) + 1
    of_piece = np.empty(count, dtype=np.int64)
    of_piece[piece] = mesh.regions
    if len(np.unique(of_piece)) == count:
        return None
    edge, owner = np.divmod(np.unique(topology.tet_edges * count + piece[:, None]), count)
    follows = np.flatnonzero((edge[1:] == edge[:-1]) & (of_piece[owner[1:]] == of_piece[owner[:-1]]))
    touching = np.unique(np.concatenate([owner[follows], owner[follows + 1]]))
    if not len(touching):
        return None
    tag_of = of_piece.copy()
    tag_of[touching] = int(mesh.regions.max()) + 1 + np.arange(len(touching))
    tags, first = np.unique(tag_of, return_index=True)
    return TouchingPieces(replace(mesh, regions=tag_of[piece]), tags, of_piece[first])
