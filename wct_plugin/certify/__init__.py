"""Proofs about a mesh, in exact arithmetic."""
