"""What every filter that makes a mesh from nothing says of it."""

from wct_plugin.measure import compiled_quality
from wct_plugin.mesh import TetMesh
from wct_plugin.types import Metrics


def metrics(mesh: TetMesh) -> Metrics:
    """Size, the extremes that the paper's tables print, and whether every tet is well-centered."""
    found = compiled_quality.measure(mesh)
    return {
        "tets": len(mesh.tets),
        "points": len(mesh.points),
        "h_over_R": [float(found.min_height.min()), float(found.max_height.max())],
        "face_angle": [float(found.min_face_angle.min()), float(found.max_face_angle.max())],
        "dihedral_angle": [float(found.min_dihedral_angle.min()), float(found.max_dihedral_angle.max())],
        "R_over_l": [float(found.radius_over_edge.min()), float(found.radius_over_edge.max())],
        "well_centered_3": bool(found.well_centered_3.all()),
        "completely_well_centered": bool(found.completely_well_centered.all()),
    }
