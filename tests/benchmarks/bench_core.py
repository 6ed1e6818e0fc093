"""Tets measured per CPU second by the core, on a mesh of its own making: ``python tests/benchmarks/bench_core.py``."""

from time import process_time

import numpy as np
from scipy.spatial import Delaunay

from wct_plugin import _core

FORM = {"margin3": 0.12, "power3": 2.5, "margin2": 0.08, "power2": 2.5, "weight_quality": 0.003}


def mesh(cells: int = 20):
    """About 100,000 tets: Delaunay of a jittered body-centered cubic lattice, its outer points to stay."""
    rng = np.random.default_rng(0)
    grid = np.stack(np.meshgrid(*[np.arange(cells + 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    points = np.concatenate([grid, grid[(grid < cells).all(axis=1)] + 0.5])
    points += rng.uniform(-0.2, 0.2, points.shape)
    tets = Delaunay(points).simplices.astype(np.int64)
    x = points[tets]
    det = np.linalg.det(x[:, 1:] - x[:, :1])
    tets[det < 0] = tets[det < 0][:, [0, 1, 3, 2]]
    longest = np.max([np.linalg.norm(x[:, i] - x[:, j], axis=1) for i in range(4) for j in range(i)], axis=0)
    keep = np.abs(det) > 0.01 * longest**3
    outer = ((points < 1) | (points > cells - 1)).any(axis=1)
    return points, np.ascontiguousarray(tets[keep]), np.where(outer, 3, 0).astype(np.int8)


def main() -> None:
    """Print the rates."""
    points, tets, stratum = mesh()
    print(f"{len(tets)} tets, {int((stratum == 0).sum())} free points; million evaluations per CPU second:")  # noqa: T201
    for name, weight2 in (("h/R", 0.0), ("h/R and angles", 0.5)):
        start, rounds = process_time(), 20
        for _ in range(rounds):
            _core.tet_energy(points, tets, weight2=weight2, **FORM)
        rate = rounds * len(tets) / (process_time() - start) / 1e6
        print(f"  tet_energy, {name:15s} {rate:6.1f}")  # noqa: T201
    no_cells = [np.zeros(shape, dtype=np.int64) for shape in ((0, 3), (0,), (0, 2), (0,))]
    for goal in ("3wc", "cwc"):
        start = process_time()
        _, report = _core.move_vertices(
            points, tets, stratum, np.full(len(points), -1), *no_cells, goal=goal, margin=0.02, effort=1
        )
        spent = process_time() - start
        print(  # noqa: T201
            f"  move_vertices, {goal:12s} {report['evaluations'] / spent / 1e6:6.1f}"
            f"   {spent:.1f} s, bad {report['bad_before']} -> {report['bad_after']}"
        )


if __name__ == "__main__":
    main()
