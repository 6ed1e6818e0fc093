"""Front ends in other packages: pyvista."""
