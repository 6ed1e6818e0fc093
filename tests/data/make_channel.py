"""Makes ``channel.msh``: a box 2 x 1 x 1 with tagged inlet, outlet and walls, as gmsh's own API writes it (2.2)."""

from pathlib import Path

import gmsh


def main() -> None:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.addBox(0, 0, 0, 2, 1, 1)
    gmsh.model.occ.synchronize()
    sides = {"inlet": [], "outlet": [], "walls": []}
    for _, tag in gmsh.model.getEntities(2):
        x = gmsh.model.occ.getCenterOfMass(2, tag)[0]
        sides["inlet" if x < 1e-9 else "outlet" if x > 2 - 1e-9 else "walls"].append(tag)
    for number, (name, tags) in enumerate(sides.items(), start=1):
        gmsh.model.addPhysicalGroup(2, tags, number, name)
    gmsh.model.addPhysicalGroup(3, [1], 10, "fluid")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.22)
    gmsh.model.mesh.generate(3)
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(str(Path(__file__).with_name("channel.msh")))
    gmsh.finalize()


if __name__ == "__main__":
    main()
