"""Into scikit-fem: a gmsh model with tagged boundaries, improved, solved with the same tags.

Potential flow through a channel: u = 0 at the inlet, u = 1 at the outlet, walls insulated. The exact solution is
linear, u = x / 2, so the flux through the 1 x 1 channel of length 2 is 1/2, to rounding, if and only if the
tagged facets survived. Run it: ``python examples/into_scikit_fem.py channel.msh [improved.msh]``.
"""

import sys
from pathlib import Path

import numpy as np
from skfem import Basis, ElementTetP1, MeshTet, condense, solve
from skfem.models.poisson import laplace

import wct_plugin as wct

CHANNEL = Path(__file__).parents[1] / "tests/data/channel.msh"


def main(source: str | Path = CHANNEL, target: str | Path = "improved.msh") -> float:
    """Give the flux from inlet to outlet."""
    mesh = wct.read(source)
    better, metrics = wct.apply_filter("apply_coord_well_centering", mesh, goal="3wc")
    wct.write(target, better)

    solver_mesh = MeshTet.load(target)  # scikit-fem finds gmsh's names again
    basis = Basis(solver_mesh, ElementTetP1())
    stiffness = laplace.assemble(basis)
    potential = basis.zeros()
    potential[basis.get_dofs("outlet")] = 1.0
    potential = solve(*condense(stiffness, x=potential, D=basis.get_dofs({"inlet", "outlet"})))
    flux = float(potential @ stiffness @ potential)

    print(f"tets without their circumcenter: {metrics['bad_before']} -> {metrics['bad_after']}; flux {flux:.12f}")
    assert metrics["bad_after"] < metrics["bad_before"]
    assert np.isclose(flux, 0.5, rtol=1e-10, atol=0)
    return flux


if __name__ == "__main__":
    main(*sys.argv[1:])
