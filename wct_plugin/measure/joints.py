"""Where the boundary meets itself: edges of more than two of its facets, and vertices where only a point is shared."""

from typing import TypedDict

from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.triangle_surfaces import pinched, surface_edges


class Joints(TypedDict):
    """How many there are."""

    edges: int  #: with other than two boundary facets, as where two cubes share an edge
    vertices: int  #: where several sheets of the boundary touch that share no edge


def count_joints(mesh: TetMesh) -> Joints:
    """Count those of the boundary."""
    boundary = mesh.topology.boundary
    sizes = surface_edges(boundary, len(mesh.points))[3]
    return {"edges": int((sizes != 2).sum()), "vertices": int(pinched(boundary, len(mesh.points)).sum())}


def describe(found: Joints) -> str:
    """A line, or nothing where the boundary is a manifold."""
    if not any(found.values()):
        return ""
    return f"the boundary meets itself in {found['edges']} edges and at {found['vertices']} vertices, which stay joined"
