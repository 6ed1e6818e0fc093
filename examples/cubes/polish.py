"""Sequential linear programming: the largest least margin that fixed connectivity allows."""

import numpy as np
from scipy.optimize import linprog

from cubes.descent import Goal, tetrahedralization
from cubes.symmetry import Floats, Ints
from wct_plugin.mesh.topology import FACETS

FLAT = 1e-10
TINY = 1e-30  # complex steps have no cancellation


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray((a * b).sum(-1))


def _cross(a: Floats, b: Floats) -> Floats:
    (x, y, z), (u, v, w) = np.moveaxis(a, -1, 0), np.moveaxis(b, -1, 0)
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], -1)


def margins(corners: Floats, goal: Goal) -> Floats:
    """h/R of the facets of tets (..., 4, 3), for cwc with the cosines of their angles: (..., 4) or (..., 16).

    Analytic in the coordinates, so that complex ones give derivatives.
    """
    a, b, c = (corners[..., i, :] - corners[..., 0, :] for i in (1, 2, 3))
    sides = _dot(a, a)[..., None] * _cross(b, c) + _dot(b, b)[..., None] * _cross(c, a)
    sides += _dot(c, c)[..., None] * _cross(a, b)
    center = sides / (2 * _dot(a, _cross(b, c)))[..., None]
    radius = np.sqrt(_dot(center, center))
    rows = []
    for facet in FACETS:
        q, r, s = (corners[..., i, :] for i in facet)
        normal = _cross(r - q, s - q)
        rows.append(_dot(normal, q - corners[..., 0, :] - center) / np.sqrt(_dot(normal, normal)) / radius)
    if goal == "cwc":
        for facet in FACETS:
            for k in range(3):
                p, q, r = (corners[..., facet[(k + j) % 3], :] for j in range(3))
                rows.append(_dot(q - p, r - p) / np.sqrt(_dot(q - p, q - p) * _dot(r - p, r - p)))
    return np.stack(rows, -1)


def _linearised(corners: Floats, goal: Goal) -> tuple[Floats, Floats]:
    """Margins (m, r) and their derivatives (m, r, 4, 3)."""
    stepped = np.repeat(corners[None].astype(complex), 12, 0)
    for k in range(12):
        stepped[k, :, k // 3, k % 3] += TINY * 1j
    values = margins(stepped, goal)
    return values[0].real, (values.imag / TINY).transpose(1, 2, 0).reshape(*values.shape[1:], 4, 3)


def least_margin(points: Floats, tets: Ints, goal: Goal) -> float:
    """The smallest of all margins, -1 where a tet has turned flat or inside out."""
    corners = points[tets]
    if np.linalg.det(corners[:, 1:] - corners[:, :1]).min() < FLAT:
        return -1.0
    return float(margins(corners, goal).min())


def polish(points: Floats, tets: Ints, goal: Goal, rounds: int = 60) -> tuple[Floats, float]:
    """Move points, each on its face or edge of the cube, to the largest least margin near by; tets stay as they are."""
    free = np.abs(points) != 0.5
    column = np.cumsum(free).reshape(points.shape) - 1
    count = int(free.sum())
    least, trust, idle = least_margin(points, tets, goal), 0.01, 0
    for _ in range(rounds):
        values, slopes = _linearised(points[tets], goal)
        tet, which = np.nonzero(values < max(least, 0.0) + max(0.1, 8 * trust))
        rows = np.zeros((len(tet), count + 1))
        for corner in range(4):
            for axis in range(3):
                moving = np.flatnonzero(free[tets[tet, corner], axis])
                rows[moving, column[tets[tet[moving], corner], axis]] = -slopes[tet, which, corner, axis][moving]
        rows[:, -1] = 1
        limits = np.column_stack([np.maximum(-trust, -0.495 - points[free]), np.minimum(trust, 0.495 - points[free])])
        plan = linprog(
            np.append(np.zeros(count), -1.0), rows, values[tet, which], bounds=[*limits, (None, None)], method="highs"
        )
        if plan.status != 0 or plan.x[-1] - least < 1e-10 or trust < 1e-9 or idle > 4:
            break
        there = points.copy()
        there[free] += plan.x[:-1]
        reached = least_margin(there, tets, goal)
        part = (reached - least) / (plan.x[-1] - least)
        if part > 0:
            idle = idle + 1 if reached - least < 1e-7 else 0
            points, least = there, reached
        trust *= 1.6 if part > 0.7 else 0.4 if part < 0.3 else 1.0
    return points, least


def polished(points: Floats, goal: Goal, worth: float = -0.02) -> tuple[Floats, Ints, float]:
    """Polish and reconnect in turn, as long as a few rounds lead to worth: points, their tets and least margin."""
    best: tuple[Floats, Ints, float] | None = None
    tets, _ = tetrahedralization(points)
    for _ in range(4):
        points, least = polish(points, tets, goal, rounds=6)
        if least > worth:
            points, least = polish(points, tets, goal)
        if best is None or least > best[2]:
            best = points, tets, least
        before = tets
        tets, _ = tetrahedralization(points)
        if least > 0 or least < worth or np.array_equal(tets, before):
            break
    assert best is not None
    return best
