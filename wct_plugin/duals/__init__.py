"""The circumcentric dual as a mesh of its own, and its files."""
