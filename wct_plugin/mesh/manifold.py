"""Is a tet mesh one whose dual cells are cells: no two points in one place, a boundary that is a manifold."""

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.mesh import triangle_surfaces
from wct_plugin.mesh.mesh import TetMesh, and_more


def check_manifold(mesh: TetMesh) -> None:
    """Raise :class:`InputError`, naming the first fault, where a dual cell would be torn or in several pieces."""
    name = mesh.source or "the mesh"
    _, first, place, count = np.unique(mesh.points, axis=0, return_index=True, return_inverse=True, return_counts=True)
    if (double := np.flatnonzero(count > 1)).size:
        one = double[np.argmin(first[double])]
        twins = np.flatnonzero(place.reshape(-1) == one)
        raise InputError(
            f"{name}: points {twins[0]} and {twins[1]} are both {tuple(mesh.points[twins[0]].tolist())}"
            f"{and_more(double)}; each place may have one point, merge them"
        )
    boundary = mesh.topology.boundary
    edges, _, _, count, _ = triangle_surfaces.surface_edges(boundary, len(mesh.points))
    if (crowded := np.flatnonzero(count > 2)).size:
        one = crowded[0]
        raise InputError(
            f"{name}: edge {tuple(edges[one].tolist())} is in {count[one]} boundary facets{and_more(crowded)}; "
            "at most two may share one"
        )
    if (pinched := np.flatnonzero(triangle_surfaces.pinched(boundary, len(mesh.points)))).size:
        raise InputError(
            f"{name}: several sheets of the boundary touch at point {pinched[0]}{and_more(pinched)}; "
            "each boundary point must lie on one sheet"
        )
