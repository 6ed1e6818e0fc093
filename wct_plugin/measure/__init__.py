"""Numbers about a mesh: quality, duals, distances, goals."""
