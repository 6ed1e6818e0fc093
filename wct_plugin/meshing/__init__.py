"""The Python half of the remesher."""
