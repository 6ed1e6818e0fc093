"""What is stopped: commands and filters that together go through every stage of the work."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

Arrays = tuple[NDArray[np.float64], NDArray[np.int64]]
MESHING, MOVING = "meshing_well_centered", "apply_coord_well_centering"


def _positive(points: NDArray[np.float64], tets: NDArray[np.int64], flattest: float = 1e-9) -> Arrays:
    corners = points[tets]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1])
    tets = np.where((volumes > 0)[:, None], tets, tets[:, [0, 1, 3, 2]])[np.abs(volumes) > flattest]
    used, inverse = np.unique(tets, return_inverse=True)
    return points[used], inverse.reshape(-1, 4)


def cube(n: int) -> Arrays:
    """A cube of n^3 boxes, with the vertices within it moved by a quarter of a box at most."""
    grid = np.stack(np.meshgrid(*[np.arange(n + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3).astype(float)
    inside = ((grid > 0) & (grid < n)).all(axis=1)
    grid[inside] += np.random.default_rng(0).uniform(-0.25, 0.25, (int(inside.sum()), 3))
    return _positive(grid / n, Delaunay(grid).simplices.astype(np.int64), 1e-4)


def ball(count: int) -> Arrays:
    """A ball of that many vertices on its surface, and half as many within."""
    rng = np.random.default_rng(1)
    k = np.arange(count) + 0.5
    height, turn = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    rim = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(count)]) * np.sqrt(1 - height**2)[:, None]
    rim[:, 2] = height
    inner = rng.normal(size=(count // 2, 3))
    inner *= (0.75 * rng.random(count // 2) ** (1 / 3) / np.linalg.norm(inner, axis=1))[:, None]
    points = np.vstack([rim, inner])
    return _positive(points, Delaunay(points).simplices.astype(np.int64), 1e-7)


@dataclass(frozen=True)
class Case:
    """A filter on a mesh, by ``wct optimize`` and in Python; ``stages`` it must be stopped in."""

    name: str
    mesh: Callable[[], Arrays]
    filter: str
    options: dict[str, Any]
    stages: tuple[str, ...]
    regions: bool = False  #: two halves
    outputs: tuple[str, ...] = field(default=("out.vtu", "report.json", "report.html"))

    @property
    def command(self) -> list[str]:
        """The arguments of ``wct`` that do the same."""
        flags = [word for name, value in self.options.items() for word in (f"--{name.replace('_', '-')}", str(value))]
        mesh, told, page = self.outputs
        return ["optimize", "in.vtu", mesh, "--filter", self.filter, *flags, "--json", told, "--html", page]


PASSES, KICKS, MARGIN = "local search: passes", "local search: kicks", "local search: margin"
CASES = (
    Case("search", lambda: cube(3), MESHING, {"goal": "cwc"}, ("resampling", PASSES, KICKS)),
    Case("margins", lambda: cube(2), MESHING, {"goal": "3wc"}, ("resampling", PASSES, MARGIN)),
    Case("restarts", lambda: ball(60), MESHING, {"goal": "3wc", "edge_length": 0.5, "tolerance": 0.02}, (PASSES,)),
    Case("boundary kept", lambda: cube(2), MESHING, {"goal": "3wc", "boundary": "keep"}, ("resampling",)),
    Case("boundary fixed", lambda: cube(3), MESHING, {"goal": "3wc", "boundary": "fixed"}, (PASSES,)),
    Case("regions balanced", lambda: cube(4), MESHING, {"goal": "3wc", "tolerance": 0.02}, (PASSES,), regions=True),
    Case("delaunay", lambda: ball(80), MESHING, {"goal": "delaunay"}, ("conforming",), regions=True),
    Case("one-sided", lambda: ball(60), MESHING, {"goal": "one-sided"}, ("conforming",)),
    Case("moving vertices", lambda: cube(3), MOVING, {"goal": "3wc"}, ("moving vertices",)),
)
