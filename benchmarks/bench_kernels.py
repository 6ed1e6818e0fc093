"""How fast the parts are, each alone: ``python -m benchmarks.kernels`` runs these through pytest-benchmark.

Not named ``test_``, so that the suite neither collects this file nor needs the plugin. ``rate`` is work per second of
the timer, which the runner sets to CPU time: of one core, however many threads there are.
"""

from typing import Any

import numpy as np
import pytest
from support.builders import ball, delaunay, sphere_surface

from wct_plugin.core import _core
from wct_plugin.measure import quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import TetMesh
from wct_plugin.meshing.reference import own_boundary

FORM = {"margin3": 0.12, "power3": 2.5, "margin2": 0.08, "power2": 2.5, "weight_quality": 0.003}


def report(benchmark: Any, work: float, unit: str) -> None:
    benchmark.extra_info |= {"rate": work / benchmark.stats["median"], "unit": f"{unit} / CPU s"}


def jittered_lattice(cells: int) -> TetMesh:
    """Delaunay of a jittered body-centered cubic lattice, about 12 cells^3 tets."""
    rng = np.random.default_rng(0)
    grid = np.stack(np.meshgrid(*[np.arange(cells + 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    points = np.concatenate([grid, grid[(grid < cells).all(axis=1)] + 0.5])
    return delaunay(points + rng.uniform(-0.2, 0.2, points.shape), flattest=1e-2)


@pytest.fixture(scope="module")
def lattice() -> TetMesh:
    """About 100,000 tets."""
    return jittered_lattice(20)


@pytest.mark.parametrize("cosines", [False, True], ids=["h/R", "h/R and cosines"])
def test_energy_and_gradient(benchmark: Any, lattice: TetMesh, cosines: bool) -> None:
    weight2 = 0.5 if cosines else 0.0
    energies, _ = benchmark(_core.tet_energy, lattice.points, lattice.tets, weight2=weight2, **FORM)
    assert np.isfinite(energies).all()
    report(benchmark, len(lattice.tets) / 1e6, "M tets")


@pytest.mark.parametrize("goal", ["3wc", "cwc"])
def test_move_vertices(benchmark: Any, goal: str) -> None:
    mesh = jittered_lattice(10)
    points = mesh.points
    stratum = np.where(((points < 1) | (points > 9)).any(axis=1), 3, 0).astype(np.int8)
    none = [np.zeros(shape, dtype=np.int64) for shape in ((0, 3), (0,), (0, 2), (0,))]
    of = {"goal": goal, "margin": 0.02, "effort": 1}
    given = (points, mesh.tets, stratum, np.full(len(points), -1), *none)
    _, done = benchmark.pedantic(_core.move_vertices, given, of, rounds=3)
    report(benchmark, done["evaluations"] / 1e6, "M evaluations")


def test_delaunay(benchmark: Any, lattice: TetMesh) -> None:
    benchmark.pedantic(_core.delaunay, (lattice.points,), rounds=5)
    report(benchmark, len(lattice.points) / 1e3, "k points")


def resampling(mesh: TetMesh) -> dict[str, Any]:
    """What ``resample`` takes for a mesh near its own boundary."""
    own = own_boundary(mesh, 40.0)
    return {
        "surface_points": own.points,
        "triangles": own.strata.triangles,
        "patch": own.strata.patch,
        "segments": own.strata.segments,
        "curve": own.strata.curve,
        "corners": own.corners,
        "sides": own.sides,
        "points": mesh.points,
        "tets": mesh.tets,
        "region": np.searchsorted(own.regions, mesh.regions),
        "tolerance": own.auto_tolerance() * own.diagonal,
    }


def test_resample(benchmark: Any) -> None:
    found = benchmark.pedantic(_core.resample, kwargs=resampling(ball(5)), rounds=3)
    report(benchmark, len(found["tets"]) / 1e3, "k tets")


def test_search(benchmark: Any) -> None:
    """From where the resampling leaves off."""
    given = resampling(ball(5))
    start = _core.resample(**given)
    same = ("points", "tets", "stratum", "size", "facets", "facet_patch", "creases", "crease_curve")
    search = {key: start[key] for key in same} | {
        "regions": start["region"],
        "label": np.where(start["stratum"] == 3, -1, start["label"]),
        "tolerance": given["tolerance"],
        "surface_points": given["surface_points"],
        **{f"surface_{key}": given[key] for key in ("triangles", "patch", "segments", "curve")},
        "acute": True,
        "margin": 0.02,
        "flip_surface": True,
        "split_surface": True,
        "passes": 12,
        "kicks": 200,
        "seed": 0,
    }
    found = benchmark.pedantic(_core.search_well_centered, kwargs=search, rounds=3)
    report(benchmark, found["evaluations"] / 1e6, "M evaluations")


def test_measure(benchmark: Any, lattice: TetMesh) -> None:
    benchmark.pedantic(quality.measure, (lattice,), rounds=5)
    report(benchmark, len(lattice.tets) / 1e3, "k tets")


def test_deviation(benchmark: Any) -> None:
    a, b = ball(10).boundary_surface(), sphere_surface(5000)
    benchmark.pedantic(measure_deviation, (a, b), rounds=3)
    report(benchmark, (len(a.triangles) + len(b.triangles)) / 1e3, "k triangles")
