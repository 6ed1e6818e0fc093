"""Two materials in scikit-fem: a gmsh model with groups, made well-centered, solved by the same groups.

Heat flows through a bar of steel and copper from its hot end to its cold one. The layers are in series, so the exact
temperature is linear in each, and the flux is 1 / (1 / k_steel + 1 / k_copper): linear elements give it to rounding,
if and only if both materials, the interface between them and both ends survived.
Run it: ``python examples/materials_in_scikit_fem.py [improved.msh]``.
"""

import sys
from pathlib import Path

import gmsh
import numpy as np
from skfem import Basis, ElementTetP1, MeshTet, condense, solve
from skfem.models.poisson import laplace

import wct_plugin as wct

CONDUCTIVITY = {"steel": 45.0, "copper": 400.0}


def bar(path: Path) -> None:
    """Write two unit cubes that share a face, as materials, with the ends as boundary groups."""
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    cubes = [(3, gmsh.model.occ.addBox(x, 0, 0, 1, 1, 1)) for x in (0, 1)]
    gmsh.model.occ.fragment(cubes[:1], cubes[1:])
    gmsh.model.occ.synchronize()
    for name, (_, cube) in zip(CONDUCTIVITY, cubes, strict=True):
        gmsh.model.addPhysicalGroup(3, [cube], name=name)
    for name, x in (("hot", 0), ("cold", 2)):
        faces = gmsh.model.getEntitiesInBoundingBox(x - 0.1, -0.1, -0.1, x + 0.1, 1.1, 1.1, 2)
        gmsh.model.addPhysicalGroup(2, [face for _, face in faces], name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.25)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(path))
    gmsh.finalize()


def flux(mesh: MeshTet) -> float:
    """Solve for the temperature, 1 at the hot end and 0 at the cold one, by the names of gmsh's groups."""
    stiffness = sum(
        k * laplace.assemble(Basis(mesh, ElementTetP1(), elements=name)) for name, k in CONDUCTIVITY.items()
    )
    basis = Basis(mesh, ElementTetP1())
    temperature = basis.zeros()
    temperature[basis.get_dofs("hot")] = 1.0
    temperature = solve(*condense(stiffness, x=temperature, D=basis.get_dofs({"hot", "cold"})))
    return float(temperature @ stiffness @ temperature)


def main(target: str | Path = "improved.msh") -> float:
    """Give the flux through the well-centered bar."""
    bar(Path(target))
    mesh = wct.read(target)
    better, _ = wct.apply_filter("meshing_well_centered", mesh, goal="3wc")
    wct.write(target, better)

    found = flux(MeshTet.load(target))
    percents = [wct.apply_filter("get_quality", one)[1]["3wc"]["percent"] for one in (mesh, better)]
    print(f"tets that contain their circumcenter: {percents[0]:.1f} % -> {percents[1]:.1f} %; flux {found:.12f}")
    assert percents[1] == 100.0 > percents[0]
    assert np.isclose(found, 1 / sum(1 / k for k in CONDUCTIVITY.values()), rtol=1e-10, atol=0)
    return found


if __name__ == "__main__":
    main(*sys.argv[1:])
