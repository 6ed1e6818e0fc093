"""gmsh's boxes and DEVSIM's equations on them, for the examples that ask DEVSIM."""
