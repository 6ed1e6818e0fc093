"""Bodies of several regions as gmsh meshes them."""

from collections.abc import Callable
from pathlib import Path

import gmsh

from wct_plugin.io import read
from wct_plugin.mesh import TetMesh


def meshed(folder: Path, build: Callable[[], None], size: float) -> TetMesh:
    """What ``build`` adds to gmsh's model, its volumes cut by each other: region k is the k-th volume that is left."""

    def model() -> None:
        build()
        gmsh.model.occ.synchronize()
        volumes = gmsh.model.getEntities(3)
        gmsh.model.occ.fragment(volumes[:1], volumes[1:])
        gmsh.model.occ.synchronize()
        for number, (_, volume) in enumerate(gmsh.model.getEntities(3), start=1):
            gmsh.model.addPhysicalGroup(3, [volume], number)

    return _mesh_of(folder, model, size)


def ball_in_box(folder: Path, size: float) -> TetMesh:
    """A ball of radius .3 in the middle of the unit cube."""

    def build() -> None:
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
        gmsh.model.occ.addSphere(0.5, 0.5, 0.5, 0.3)

    return meshed(folder, build, size)


def embedded(folder: Path, build: Callable[[], list[tuple[int, int]]], size: float) -> TetMesh:
    """The unit cube with what ``build`` adds inside it, sheets or curves (dimension, tag): facets or edges tagged 2."""

    def model() -> None:
        cube = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
        tools = build()
        _, parts = gmsh.model.occ.fragment([(3, cube)], tools)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], 1)
        dimension = tools[0][0]
        inside = {tag for part in parts[1:] for own, tag in part if own == dimension}
        gmsh.model.addPhysicalGroup(dimension, sorted(inside), 2)

    return _mesh_of(folder, model, size)


def _mesh_of(folder: Path, model: Callable[[], None], size: float) -> TetMesh:
    """The groups of a gmsh ``model``, with edges of one ``size``, as a .msh file brings them."""
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        model()
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.model.mesh.generate(3)
        gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
        gmsh.write(str(folder / "body.msh"))
    finally:
        gmsh.finalize()
    mesh = read(str(folder / "body.msh"))
    assert isinstance(mesh, TetMesh)
    return mesh
