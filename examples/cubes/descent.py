"""Descent of the energy of the Delaunay tetrahedralization of an arrangement."""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cubes.symmetry import Arrangement, Floats, Ints
from wct_plugin.core import _core
from wct_plugin.measure.quality import circumcenters

Goal = Literal["cwc", "3wc"]

MARGIN = 0.03
CONCENTRIC = 1e-6  # distance of centers, over the radius, at which two circumspheres are one
HOPELESS = 1e5


def tetrahedralization(points: Floats) -> tuple[Ints, int]:
    """Delaunay tets (m, 4), and across how many of their facets both have one circumsphere.

    Of two such tets at most one contains the center: where symmetry puts five points on a sphere it forbids the goal.
    """
    tets, neighbours = _core.delaunay(points)
    centers = circumcenters(points, tets)
    radii = np.linalg.norm(points[tets[:, 0]] - centers, axis=1)
    tet, facet = np.nonzero(neighbours >= 0)
    other = neighbours[tet, facet]
    same = np.linalg.norm(centers[tet] - centers[other], axis=1) < CONCENTRIC * radii[tet]
    return tets, int(same.sum()) // 2


class Energy:
    """What the goal lacks, and its slope, as a function of the parameters of an arrangement."""

    def __init__(self, arrangement: Arrangement, goal: Goal) -> None:
        self.arrangement = arrangement
        self.flat_map = arrangement.linear.reshape(-1, arrangement.linear.shape[2])
        self.rest = arrangement.points(np.zeros(self.flat_map.shape[1])).ravel()
        self.weight2 = 0.5 if goal == "cwc" else 0.0
        self.pinned = np.abs(self.rest) == 0.5

    def __call__(self, parameters: Floats) -> tuple[float, Floats]:
        """Energy and gradient; infinite where points meet, and where one leaves its face, its edge or the cube."""
        moved = self.rest + self.flat_map @ parameters
        if (np.abs(moved[~self.pinned]) > 0.495).any():
            return np.inf, parameters
        points = moved.reshape(-1, 3)
        try:
            tets, _ = _core.delaunay(points)
        except ValueError:  # two of them coincide
            return np.inf, parameters
        energies, gradient = _core.tet_energy(
            points, tets, margin3=MARGIN, power3=2.0, margin2=MARGIN, power2=2.0, weight2=self.weight2, weight_quality=0
        )
        total = float(energies.sum())
        if not total < np.inf:
            flat = np.isinf(energies)
            total = float(energies[~flat].sum() + flat.sum())
        return total, gradient.ravel() @ self.flat_map


def descend(arrangement: Arrangement, goal: Goal, iterations: int) -> tuple[Arrangement, float]:
    """Quasi-Newton descent (BFGS) from where the arrangement is: where it ends, and the energy there."""
    energy = Energy(arrangement, goal)
    x = arrangement.parameters
    value, slope = energy(x)
    if not value < HOPELESS:
        return arrangement, np.inf
    inverse: NDArray[Any] | None = None
    idle = 0
    for _ in range(iterations):
        if value < 1e-9 or idle > 4:
            break
        step = -slope if inverse is None else -(inverse @ slope)
        along = float(step @ slope)
        if along >= 0:
            inverse, step, along = None, -slope, -float(slope @ slope)
        if along > -1e-16:
            break
        longest = float(np.abs(step).max())
        length = min(1.0, 0.05 / longest) if inverse is not None else min(max(1.0, 0.003 / longest), 0.05 / longest)
        for _ in range(8):
            there = x + length * step
            value_there, slope_there = energy(there)
            if value_there <= value + 1e-4 * length * along:
                break
            length *= 0.4
        else:
            if inverse is None:
                break
            inverse, idle = None, idle + 1
            continue
        moved, turned = there - x, slope_there - slope
        curvature = float(moved @ turned)
        if curvature > 1e-14:
            if inverse is None:
                inverse = np.eye(len(x)) * (curvature / float(turned @ turned))
            image = inverse @ turned
            mixed = np.outer(moved, image)
            inverse += (1 + float(turned @ image) / curvature) / curvature * np.outer(moved, moved)
            inverse -= (mixed + mixed.T) / curvature
        idle = idle + 1 if value - value_there < 1e-5 * value else 0
        x, value, slope = there, value_there, slope_there
    return arrangement.at(x), value
