"""The regions of a mesh taken apart, as solvers with a material per region see them."""

import numpy as np

from wct_plugin.mesh.mesh import TetMesh


def apart(mesh: TetMesh) -> TetMesh:
    """The same tets, row by row, with points of their own in every region: what was an interface is boundary twice.

    The mesh itself where it has one region. Tagged cells, sets and data stay behind.
    """
    tags, region = np.unique(mesh.regions, return_inverse=True)
    if len(tags) == 1:
        return mesh
    count = len(mesh.points)
    copies, tets = np.unique(region.reshape(-1, 1) * count + mesh.tets, return_inverse=True)
    return TetMesh(mesh.points[copies % count], tets.reshape(mesh.tets.shape), mesh.regions, source=mesh.source)
