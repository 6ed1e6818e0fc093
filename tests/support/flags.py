"""Signed duals by definition, flag by flag: slow, and nothing in common with ``duals.py`` but what it should give.

The recursion over a tet's faces that PyDEC's ``simplicial_complex.compute_dual_volume`` does, with the signs of Hirani,
Kalyanaraman and VanderZee (2013), here also for weighted vertices: from each tet down to its facets, edges and
vertices, the simplex of the centers passed on the way is added to the dual of the last face, with a minus for each
step whose center lies beyond the face.
"""

from math import factorial

import numpy as np

from wct_plugin.mesh import TetMesh
from wct_plugin.types import Floats


def center(points: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """The point of a simplex's plane with the same power distance from all its vertices, and its barycentrics."""
    k = len(points)
    system = np.zeros((k + 1, k + 1))
    system[:k, :k] = 2.0 * points @ points.T
    system[:k, k] = system[k, :k] = 1.0
    right = np.append((points**2).sum(axis=1) - weights, 1.0)
    barycentric = np.linalg.solve(system, right)[:k]
    return barycentric @ points, barycentric


def signed_duals(mesh: TetMesh, weights: Floats | None = None) -> list[dict[tuple[int, ...], float]]:
    """Dual volume per vertex, area per edge, length per facet, by the face's ascending vertices."""
    given = np.zeros(len(mesh.points)) if weights is None else weights
    duals: list[dict[tuple[int, ...], float]] = [{}, {}, {}]

    def descend(face: tuple[int, ...], centers: list[Floats], sign: float) -> None:
        middle, barycentric = center(mesh.points[list(face)], given[list(face)])
        centers = [*centers, middle]
        if len(face) < 4:
            edges = np.diff(centers, axis=0)
            size = np.sqrt(max(np.linalg.det(edges @ edges.T), 0.0)) / factorial(len(edges))
            of = duals[len(face) - 1]
            of[face] = of.get(face, 0.0) + sign * size
        if len(face) > 1:
            for k in range(len(face)):
                descend(face[:k] + face[k + 1 :], centers, sign * np.copysign(1.0, barycentric[k]))

    for tet in np.sort(mesh.tets, axis=1).tolist():
        descend(tuple(tet), [], 1.0)
    return duals
