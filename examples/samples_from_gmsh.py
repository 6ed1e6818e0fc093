"""The samples that ``wct demo`` writes, made by gmsh: materials, contacts and a true surface beside a coarse mesh.

``two_material.msh`` is a cube with a ball in it, its regions and two of its faces named. ``part.msh`` is a plate with a
hole, clamped at one end and pulled at the other; ``part.stl`` is its surface with the hole in finer facets, which the
boundary can be measured against. ``bone.ply`` is a shape like a bone, for a machine without a scan.
Run it: ``python examples/samples_from_gmsh.py [folder]``.
"""

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import gmsh
import numpy as np

import wct_plugin as wct

#: Entities of gmsh's model that get a common name; regions and faces are numbered on from these.
Groups = Mapping[str, Sequence[int]]
FIRST_FACE, FIRST_REGION = 1, 10


@contextmanager
def model() -> Iterator[None]:
    """An empty model of gmsh, which says nothing and takes one thread, so that it makes the same mesh each time."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    try:
        yield
    finally:
        gmsh.finalize()


def faces_at(axis: int, place: float) -> list[int]:
    """The faces of the model whose middle has this coordinate."""
    return [tag for _, tag in gmsh.model.getEntities(2) if abs(middle(2, tag)[axis] - place) < 1e-6]


def middle(dimension: int, tag: int) -> Sequence[float]:
    """Center of mass of an entity."""
    return gmsh.model.occ.getCenterOfMass(dimension, tag)


def mesh_model(dimension: int, size: float) -> None:
    """Mesh all entities with edges as long as ``size``."""
    gmsh.model.mesh.setSize(gmsh.model.getEntities(0), size)
    gmsh.model.mesh.generate(dimension)


def write_msh(path: Path, faces: Groups, regions: Groups) -> None:
    """Write gmsh's format 2.2 in text, with a name for each group."""
    for dimension, first, groups in ((2, FIRST_FACE, faces), (3, FIRST_REGION, regions)):
        for number, (name, tags) in enumerate(groups.items(), start=first):
            gmsh.model.addPhysicalGroup(dimension, tags, number, name)
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.write(str(path))


def make_two_material(path: Path) -> None:
    """A cube of edge 2 with a ball of radius 0.6 in its middle."""
    with model():
        box, ball = gmsh.model.occ.addBox(-1, -1, -1, 2, 2, 2), gmsh.model.occ.addSphere(0, 0, 0, 0.6)
        pieces, came_from = gmsh.model.occ.fragment([(3, box)], [(3, ball)])
        gmsh.model.occ.synchronize()
        inclusion = [tag for _, tag in came_from[1]]
        matrix = [tag for _, tag in pieces if tag not in inclusion]
        mesh_model(3, 0.25)
        faces = {"bottom": faces_at(2, -1), "top": faces_at(2, 1)}
        write_msh(path, faces, {"inclusion": inclusion, "matrix": matrix})


def add_plate() -> None:
    """A plate of 4 x 2 x 0.5 with a hole of radius 0.5 through its middle."""
    box, hole = gmsh.model.occ.addBox(0, 0, 0, 4, 2, 0.5), gmsh.model.occ.addCylinder(2, 1, -1, 0, 0, 2, 0.5)
    gmsh.model.occ.cut([(3, box)], [(3, hole)])
    gmsh.model.occ.synchronize()


def make_part(path: Path) -> None:
    """The plate in tets, its ends named."""
    with model():
        add_plate()
        mesh_model(3, 0.2)
        ends = [*faces_at(0, 0), *faces_at(0, 4)]
        free = [tag for _, tag in gmsh.model.getEntities(2) if tag not in ends]
        faces = {"clamped": ends[:1], "pulled": ends[1:], "free": free}
        write_msh(path, faces, {"steel": [tag for _, tag in gmsh.model.getEntities(3)]})


def make_part_surface(path: Path) -> None:
    """The plate's surface, a circle in 64 edges."""
    with model():
        add_plate()
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 64)
        mesh_model(2, 0.5)
        gmsh.option.setNumber("Mesh.Binary", 1)
        gmsh.write(str(path))


def make_bone(path: Path) -> None:
    """A shaft with two balls at each end."""
    with model():
        shaft = gmsh.model.occ.addCylinder(0, 0, 0, 3, 0, 0, 0.22)
        balls = [gmsh.model.occ.addSphere(x, y, 0, 0.4) for x in (0, 3) for y in (-0.25, 0.25)]
        gmsh.model.occ.fuse([(3, shaft)], [(3, ball) for ball in balls])
        gmsh.model.occ.synchronize()
        mesh_model(2, 0.12)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        order = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        order[tags] = np.arange(len(tags))
        triangles = order[gmsh.model.mesh.getElementsByType(2)[1]].reshape(-1, 3)
    wct.write(path, wct.SurfaceMesh(coordinates.reshape(-1, 3), triangles))


def main(folder: str = ".") -> None:
    """Write the four files and say what they hold."""
    where = Path(folder)
    make_two_material(where / "two_material.msh")
    make_part(where / "part.msh")
    make_part_surface(where / "part.stl")
    make_bone(where / "bone.ply")
    cube, part = wct.read(where / "two_material.msh"), wct.read(where / "part.msh")
    surface, bone = wct.read(where / "part.stl"), wct.read(where / "bone.ply")
    assert set(cube.names) == {"bottom", "top", "inclusion", "matrix"}
    assert set(part.names) == {"clamped", "pulled", "free", "steel"}
    print(
        f"two_material.msh: {len(cube.tets)} tets, part.msh: {len(part.tets)} tets, "
        f"part.stl: {len(surface.triangles)} triangles, bone.ply: {len(bone.triangles)} triangles"
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
