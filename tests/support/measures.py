"""What is measured of every tet but its volume, by the names that :class:`wct_plugin.measure.quality.Quality` has."""

MEASURES = (
    "min_height",
    "max_height",
    "min_face_angle",
    "max_face_angle",
    "min_dihedral_angle",
    "max_dihedral_angle",
    "radius_over_edge",
)
