"""NGSolve by the names of gmsh: materials, ends, and the interface between them, after the mesh was made well-centered.

Heat flows through a bar of steel and copper. The flux is integrated over the interface inside, a boundary element of
NGSolve by its own name: it is 1 / (l_steel / k_steel + l_copper / k_copper) to rounding, if all groups survived.
Run it: ``python examples/ngsolve_interfaces.py [bar.msh]``.
"""

import contextlib
import io
import sys
from pathlib import Path

import ngsolve as ngs
import numpy as np
from devices.stack import stack
from netgen.read_gmsh import ReadGmsh

import wct_plugin as wct

CONDUCTIVITY = {"steel": 45.0, "copper": 400.0}
LENGTH = {"steel": 1.5, "copper": 1.0}


def flux(mesh: ngs.Mesh) -> float:
    """Solve for the temperature, 1 at the hot end and 0 at the cold one; what flows through the interface."""
    space = ngs.H1(mesh, order=1, dirichlet="hot|cold")
    trial, test = space.TnT()
    conductivity = mesh.MaterialCF(CONDUCTIVITY)
    stiffness = ngs.BilinearForm(conductivity * ngs.grad(trial) * ngs.grad(test) * ngs.dx).Assemble()
    found = ngs.GridFunction(space)
    found.Set(mesh.BoundaryCF({"hot": 1.0}), definedon=mesh.Boundaries("hot|cold"))
    free = stiffness.mat.Inverse(space.FreeDofs(), inverse="sparsecholesky")
    found.vec.data -= free @ stiffness.mat * found.vec
    through = ngs.GridFunction(ngs.L2(mesh, order=0))
    through.Set(-conductivity * ngs.grad(found)[0])
    return float(ngs.Integrate(ngs.BoundaryFromVolumeCF(through), mesh, definedon=mesh.Boundaries("weld")))


def main(target: str | Path = "bar.msh") -> float:
    """Give the flux through the interface of the well-centered bar."""
    stack(target, LENGTH, ("hot", "cold"), 0.25, interfaces=["weld"])
    wct.optimize(target, target)
    with contextlib.redirect_stdout(io.StringIO()):  # it warns of entities without a group, of which there are none
        mesh = ngs.Mesh(ReadGmsh(str(target)))
    volumes = [ngs.Integrate(1.0, mesh, definedon=mesh.Materials(name)) for name in CONDUCTIVITY]
    areas = [ngs.Integrate(1.0, mesh, definedon=mesh.Boundaries(name)) for name in ("hot", "weld", "cold")]
    found = flux(mesh)
    print(f"volumes {np.round(volumes, 12)}, areas {np.round(areas, 12)}, flux through the interface {found:.12f}")
    assert np.allclose([*volumes, *areas], [*LENGTH.values(), 1.0, 1.0, 1.0], rtol=1e-12, atol=0)
    assert np.isclose(found, 1 / sum(LENGTH[name] / k for name, k in CONDUCTIVITY.items()), rtol=1e-10, atol=0)
    return found


if __name__ == "__main__":
    main(*sys.argv[1:])
