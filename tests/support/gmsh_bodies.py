"""Bodies of several regions as gmsh meshes them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import gmsh
import numpy as np
from support.gmsh_session import gmsh_session

from wct_plugin.io import read
from wct_plugin.measure.opening_angles import wedge_angles
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


def crossing_balls(folder: Path, size: float) -> TetMesh:
    """Two balls of radius 1, their centers 1.2 apart: a lens, and a crescent at either side of it."""

    def build() -> None:
        gmsh.model.occ.addSphere(0, 0, -0.6, 1.0)
        gmsh.model.occ.addSphere(0, 0, 0.6, 1.0)

    return meshed(folder, build, size)


def via(folder: Path, size: float) -> TetMesh:
    """A plate of two layers, the lower one .4 and the upper .2 thick, and a rod of radius .15 half through each."""

    def build() -> None:
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 0.4)
        gmsh.model.occ.addBox(0, 0, 0.4, 1, 1, 0.2)
        gmsh.model.occ.addCylinder(0.5, 0.5, 0.2, 0, 0, 0.4, 0.15)

    return meshed(folder, build, size)


def layered_box(folder: Path, thickness: float, size: float) -> TetMesh:
    """A unit square .5 high with a layer on it."""

    def build() -> None:
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 0.5)
        gmsh.model.occ.addBox(0, 0, 0.5, 1, 1, thickness)

    return meshed(folder, build, size)


def boxes(folder: Path, corners: list[tuple[float, ...]], size: float) -> TetMesh:
    """Boxes, each by its lowest and its highest corner, cut by each other: a region per part."""

    def build() -> None:
        for x, y, z, *high in corners:
            gmsh.model.occ.addBox(x, y, z, high[0] - x, high[1] - y, high[2] - z)

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


def joined_cubes(folder: Path, shift: tuple[float, float, float], size: float, *, regions: int) -> TetMesh:
    """Two unit cubes, one of them shifted, conforming where they touch, as one region or two."""

    def model() -> None:
        one, other = (gmsh.model.occ.addBox(*corner, 1, 1, 1) for corner in ((0, 0, 0), shift))
        gmsh.model.occ.fragment([(3, one)], [(3, other)])
        gmsh.model.occ.synchronize()
        volumes = [volume for _, volume in gmsh.model.getEntities(3)]
        for number in range(regions):
            gmsh.model.addPhysicalGroup(3, volumes[number::regions], number + 1)

    return _mesh_of(folder, model, size)


def random_body(folder: Path, seed: int) -> TetMesh:
    """Two to twelve turned boxes and cylinders in a heap, each piece they cut each other into a region of its own.

    Of those that are drawn the first with at most twelve pieces and no dihedral angle below 25 degrees.
    """
    random = np.random.default_rng(seed)
    while True:
        count = int(random.integers(2, 13))
        drawn = [(random.random(3) * 1.2, random.uniform(0.4, 0.9, 3), random.normal(size=3), random.uniform(0, 3.1))
                 for _ in range(count)]  # fmt: skip
        round_ones = random.random(count) < 0.4
        size = float(random.uniform(0.12, 0.2))

        def build(drawn: Any = drawn, round_ones: Any = round_ones) -> None:
            occ = gmsh.model.occ
            for (at, sides, axis, angle), is_round in zip(drawn, round_ones, strict=True):
                tag = occ.addCylinder(*at, 0, 0, sides[2], 0.5 * sides[0]) if is_round else occ.addBox(*at, *sides)
                occ.rotate([(3, tag)], *at, *axis, angle)

        try:
            mesh = meshed(folder, build, size)
        except Exception:  # gmsh gives no class of its own to what it cannot mesh; draw another
            continue
        sharpest = wedge_angles(mesh, np.arange(len(mesh.tets))).min()
        if len(np.unique(mesh.regions)) <= 12 and sharpest >= 25.0:
            return mesh


def _mesh_of(folder: Path, model: Callable[[], None], size: float) -> TetMesh:
    """The groups of a gmsh ``model``, with edges of one ``size``, as a .msh file brings them."""
    with gmsh_session():
        model()
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.model.mesh.generate(3)
        gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
        gmsh.write(str(folder / "body.msh"))
    mesh = read(str(folder / "body.msh"))
    assert isinstance(mesh, TetMesh)
    return mesh
