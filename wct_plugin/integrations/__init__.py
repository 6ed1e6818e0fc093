"""Front ends in other packages."""
