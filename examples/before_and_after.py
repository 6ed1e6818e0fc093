"""What well-centering does for a solver with diagonal Hodge stars: one row of docs/benchmarks.md per domain.

Negative duals per vertex, edge and facet; the largest stable time step of the co-volume scheme for Maxwell's equations
over the mean edge length, "none" where a star inside the walls has a negative entry; the relative error of a Poisson
problem. The cube and the sphere are gmsh's, the bone, which ships in the pymeshlab wheel, is filled by fTetWild.
The goal is complete well-centeredness, which makes the duals on the boundary positive, too.
Run it: ``python examples/before_and_after.py [cube] [sphere] [bone]``.
"""

import importlib.util
import sys
from pathlib import Path

import gmsh
import numpy as np
from maxwell_cavity import cavity, resonances
from poisson_and_heat import cube, from_gmsh, poisson_error

import wct_plugin as wct
from wct_plugin.measure.duals import compute_duals
from wct_plugin.measure.negative_duals import count_negative_duals


def sphere() -> tuple[wct.TetMesh, wct.SurfaceMesh | None]:
    """The unit ball as gmsh fills it."""
    return from_gmsh(lambda: gmsh.model.occ.addSphere(0, 0, 0, 1), 0.2), None


def bone() -> tuple[wct.TetMesh, wct.SurfaceMesh | None]:
    """The scanned bone as fTetWild fills it, and the scan."""
    spec = importlib.util.find_spec("pymeshlab")
    assert spec is not None
    assert spec.submodule_search_locations is not None
    scan = wct.read(Path(spec.submodule_search_locations[0]) / "tests/sample_meshes/bone.ply")
    mesh, _ = wct.apply_filter("generate_tetrahedralization", scan)
    return mesh, scan


DOMAINS = {"cube": lambda: (cube(0.1), None), "sphere": sphere, "bone": bone}


def figures(mesh: wct.TetMesh) -> tuple[list[int], float | None, float]:
    """Negative duals by degree, time step over mean edge length or None, Poisson's error."""
    dual = compute_duals(mesh)
    signs = count_negative_duals(mesh, dual)
    negative = [
        inside.negative + border.negative for inside, border in zip(signs.interior, signs.boundary, strict=True)
    ]
    ratio = None
    if (cavity(mesh)[1] > 0).all() and (dual.lengths > 0).all():
        ends = mesh.points[mesh.topology.edges]
        ratio = resonances(mesh)[1] / float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).mean())
    return negative, ratio, poisson_error(mesh)


def row(name: str) -> str:
    """One domain's line of the table."""
    mesh, reference = DOMAINS[name]()
    better, _ = wct.apply_filter("meshing_well_centered", mesh, reference=reference)  # completely: all duals positive
    before, after = figures(mesh), figures(better)
    assert sum(before[0]) > 0 == sum(after[0])
    assert before[1] is None
    assert after[1] is not None
    assert after[1] > 0.01
    assert after[2] < 1.3 * before[2]
    counts = [" / ".join(map(str, of[0])) for of in (before, after)]
    return (
        f"| {name} | {len(mesh.tets)} -> {len(better.tets)} | {counts[0]} -> {counts[1]} "
        f"| none -> {after[1]:.3f} | {100 * before[2]:.2f} % -> {100 * after[2]:.2f} % |"
    )


if __name__ == "__main__":
    for domain in sys.argv[1:] or ["cube"]:
        print(row(domain))
