"""Meshes from nothing: bundled ones, lattice tilings, voxels."""
