"""Diffusion in FiPy: errors before and after, and how they fall on finer meshes.

FiPy divides the difference of two cells' values by the distance of their centers, which are centroids: where that
line is not normal to the facet the flux is wrong, however fine the mesh is. Circumcenters make it normal everywhere.
FiPy gives distances no sign, though, and divides by those that are zero, so that it takes a well-centered mesh.
Run it: ``python examples/fipy_diffusion.py``.
"""

import tempfile
from pathlib import Path

import numpy as np
from devices.fipy_meshes import Circumcentric, fipy
from devices.stack import stack

import wct_plugin as wct

SIZES = (0.14, 0.1)


def error(mesh: fipy.Gmsh3D) -> float:
    """Relative error in L2 of -div grad u = 3 pi^2 u with u = sin(pi x) sin(pi y) sin(pi z), zero on the boundary."""
    exact = np.sin(np.pi * np.asarray(mesh.cellCenters)).prod(axis=0)
    found = fipy.CellVariable(mesh=mesh, value=0.0)
    found.constrain(0.0, mesh.exteriorFaces)
    source = fipy.CellVariable(mesh=mesh, value=3.0 * np.pi**2 * exact)
    (fipy.DiffusionTerm() + source).solve(
        found, solver=fipy.LinearCGSolver(tolerance=1e-9, iterations=9999, precon=None)
    )
    volumes = np.asarray(mesh.cellVolumes)
    return float(np.sqrt((volumes * (np.asarray(found) - exact) ** 2).sum() / (volumes * exact**2).sum()))


def main() -> float:
    """Give the order of convergence on well-centered meshes, with circumcenters."""
    errors, lengths = [], []
    with tempfile.TemporaryDirectory() as folder:
        before, after = (str(Path(folder) / name) for name in ("before.msh", "after.msh"))
        for size in SIZES:
            stack(before, {"cube": 1.0}, ("left", "right"), size)
            wct.optimize(before, after)
            errors.append([error(mesh) for mesh in map(fipy.Gmsh3D, (before, after))] + [error(Circumcentric(after))])
            lengths.append(len(wct.read(after).tets) ** (-1 / 3))
    orders = np.log(np.divide(*errors)) / np.log(np.divide(*lengths))
    gmsh, plain, best = (100 * one for one in errors[-1])
    print(
        f"error with centroids {gmsh:.2f} % -> {plain:.2f} %, with circumcenters {best:.2f} %, of order {orders[2]:.1f}"
    )
    assert best < 0.2 * min(gmsh, plain)
    assert orders[2] > 1.8
    return float(orders[2])


if __name__ == "__main__":
    main()
