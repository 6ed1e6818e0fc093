"""MeshLab through pymeshlab, in a process of its own."""
