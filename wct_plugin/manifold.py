"""Is a tet mesh one whose dual cells are cells: no two points in one place, a boundary that is a manifold."""

import numpy as np

from wct_plugin import surface
from wct_plugin.errors import InputError
from wct_plugin.mesh import TetMesh


def check_manifold(mesh: TetMesh) -> None:
    """Raise :class:`InputError`, naming the first fault, where a dual cell would be torn or in several pieces."""
    name = mesh.source or "the mesh"
    _, first, place, count = np.unique(mesh.points, axis=0, return_index=True, return_inverse=True, return_counts=True)
    if (double := np.flatnonzero(count > 1)).size:
        one = double[np.argmin(first[double])]
        twins = np.flatnonzero(place.reshape(-1) == one)
        raise InputError(
            f"{name}: points {twins[0]} and {twins[1]} are both {tuple(mesh.points[twins[0]].tolist())}"
            f"{_and_more(len(double))}; each place may have one point, merge them"
        )
    boundary = mesh.topology.boundary
    ends = np.sort(boundary[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, count = np.unique(ends, axis=0, return_counts=True)
    if (crowded := np.flatnonzero(count > 2)).size:
        one = crowded[0]
        raise InputError(
            f"{name}: edge {tuple(edges[one].tolist())} is in {count[one]} boundary facets{_and_more(len(crowded))}; "
            "at most two may share one"
        )
    if (pinched := np.flatnonzero(surface.pinched(boundary, len(mesh.points)))).size:
        raise InputError(
            f"{name}: several sheets of the boundary touch at point {pinched[0]}{_and_more(len(pinched))}; "
            "each boundary point must lie on one sheet"
        )


def _and_more(found: int) -> str:
    return f" (and {found - 1} more)" if found > 1 else ""
