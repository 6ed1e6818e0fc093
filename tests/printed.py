"""A mesh's extremes as the paper prints them."""

from wct_plugin import quality
from wct_plugin.mesh import TetMesh


def columns(mesh: TetMesh, places: int = 3) -> list[str]:
    """Min and max of h/R, face angle, dihedral angle and R/l; h/R and R/l with three decimals, angles with two.

    ``places``: decimals of min h/R, of which some of the paper's tables print four.
    """
    found = quality.measure(mesh)
    heights = [f"{found.min_height.min():.{places}f}", f"{found.max_height.max():.3f}"]
    angles = [
        f"{angle:.2f}"
        for angle in (
            found.min_face_angle.min(),
            found.max_face_angle.max(),
            found.min_dihedral_angle.min(),
            found.max_dihedral_angle.max(),
        )
    ]
    ratio = found.radius_over_edge
    return [*heights, *angles, f"{ratio.min():.3f}", f"{ratio.max():.3f}"]
