"""The data model: meshes, who touches whom, strata, units."""

from wct_plugin.mesh.mesh import Cells, SurfaceMesh, TetMesh

__all__ = ["Cells", "SurfaceMesh", "TetMesh"]
