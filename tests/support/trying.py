"""Tries hard to make a few tets well-centered: random starts, then descent of the core's energy on what may move."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize
from scipy.spatial import ConvexHull, Delaunay

from wct_plugin.core import _core
from wct_plugin.measure import quality
from wct_plugin.mesh import TetMesh
from wct_plugin.types import Bools, Floats, Ints


def clearance(points: Floats, tets: Ints, goal: str) -> float:
    """The smallest h/R, cosine of a facet angle, or both: positive where all tets meet the goal; -1 if one is flat."""
    if np.linalg.det(points[tets[:, 1:]] - points[tets[:, :1]]).min() <= 0.0:
        return -1.0
    measured = quality.measure(TetMesh(points, tets))
    height, cosine = measured.min_height.min(), np.cos(np.radians(measured.max_face_angle)).min()
    return float({"3wc": height, "2wc": cosine, "cwc": min(height, cosine)}[goal])


def improved(points: Floats, tets: Ints, free: Bools, goal: str, margin: float = 0.1) -> Floats:
    """The points after descent in the coordinates that are ``free`` (n, 3); the others keep their bits."""
    weights = {"margin3": -1.0 if goal == "2wc" else margin, "power3": 2.0, "weight_quality": 0.0}
    weights |= {"margin2": margin, "power2": 2.0, "weight2": 0.0 if goal == "3wc" else 1.0}

    def placed(x: Floats) -> Floats:
        out = points.copy()
        out[free] = x
        return out

    def energy(x: Floats) -> tuple[float, Floats]:
        values, gradient = _core.tet_energy(placed(x), tets, **weights)
        total = float(values.sum())
        return (total, gradient[free]) if np.isfinite(total) else (1e9, np.zeros(len(x)))

    x = points[free]
    for _ in range(3):
        x = minimize(energy, x, jac=True, method="L-BFGS-B", options={"maxiter": 300}).x
    return placed(x)


def star(count: int, seed: int) -> tuple[Floats, Ints]:
    """Tets from the origin, vertex 0, to the hull of ``count`` spread random directions, at distances of about 1."""
    rng = np.random.default_rng(seed)
    while True:
        directions = rng.normal(size=(count, 3))
        for _ in range(rng.integers(1, 6)):  # pushed apart, more or less
            directions /= np.linalg.norm(directions, axis=1)[:, None]
            apart = directions[:, None] - directions
            directions += 0.1 * (apart / (np.linalg.norm(apart, axis=2) + np.eye(count))[..., None] ** 3).sum(axis=1)
        hull = ConvexHull(directions)
        if len(hull.vertices) == count and (hull.equations[:, 3] < -0.05).all():
            break
    links = hull.simplices.astype(np.int64)
    inward = np.linalg.det(directions[links]) < 0
    links[inward] = links[inward][:, ::-1]
    points = np.concatenate([np.zeros((1, 3)), directions * rng.uniform(0.8, 1.2, (count, 1))])
    return points, np.column_stack([np.zeros(len(links), dtype=np.int64), links + 1])


def part_of_a_star(rim: Floats, inner: Floats, lift: Callable[[Floats], Floats]) -> tuple[Floats, Ints]:
    """Tets from the origin, vertex 0 on a surface, to directions on it and off it, whose link is a disc.

    ``rim`` (k, 2) on the unit circle are those on the surface, ``inner`` (n, 2) the others; ``lift`` gives directions.
    """
    flat = np.concatenate([rim, inner])
    points = np.concatenate([np.zeros((1, 3)), lift(flat)])
    links = Delaunay(flat).simplices.astype(np.int64) + 1
    inward = np.linalg.det(points[links]) < 0
    links[inward] = links[inward][:, ::-1]
    return points, np.column_stack([np.zeros(len(links), dtype=np.int64), links])


def inside_of(rim: Floats, count: int, rng: np.random.Generator) -> Floats:
    """(count, 2) random points inside the polygon of ``rim``, pushed apart."""
    turn = np.sort(np.arctan2(rim[:, 1], rim[:, 0]))
    within = 0.9 * np.cos(np.diff(turn, append=turn[0] + 2.0 * np.pi).max() / 2.0)
    points = rng.normal(size=(count, 2))
    for _ in range(20):
        apart = points[:, None] - points
        points += 0.05 * (apart / (np.linalg.norm(apart, axis=2) + np.eye(count))[..., None] ** 2).sum(axis=1)
        points *= np.minimum(1.0, within / np.linalg.norm(points, axis=1))[:, None]
    return points
