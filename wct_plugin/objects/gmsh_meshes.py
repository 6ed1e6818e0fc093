"""The current model of gmsh as mesh, and a mesh as a discrete model of gmsh; gmsh must have been initialized."""

import tempfile
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from wct_plugin.errors import InputError, ObjectError
from wct_plugin.io import formats, mid_nodes
from wct_plugin.io.gmsh_options import MshOptions
from wct_plugin.io.meshio_writers import save
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.io.writer import contents
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.objects.assembled import assembled, not_carried
from wct_plugin.types import Ints

_FORM = next(form for form in formats.FORMATS if form.name == "gmsh")
_WHAT = "gmsh's model"
#: Meshio's names of gmsh's shapes; those of higher order have the number of their nodes behind it.
_SHAPES = {
    "Point": "vertex", "Line": "line", "Triangle": "triangle", "Quadrilateral": "quad", "Tetrahedron": "tetra",
    "Hexahedron": "hexahedron", "Prism": "wedge", "Pyramid": "pyramid",
}  # fmt: skip
#: Where meshio has the nodes of gmsh's, for the one kind of higher order whose corners are used.
_ORDER = {"tetra10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]}


def from_gmsh(_: Any = None) -> TetMesh | SurfaceMesh:
    """Make a mesh of gmsh's current model, by the conventions of its files.

    All tets are taken; of triangles, lines and points those in physical groups, or all where the model has no group.
    Tags are the physical groups, or the entities where there is none; names are theirs. A cell in several groups has
    the first as its tag, the others are sets.

    Raises
    ------
    InputError
        If gmsh is not initialized, or its current model has no mesh.
    """
    gmsh = _gmsh()
    mesh = gmsh.model.mesh
    tags, coordinates, _ = mesh.getNodes()
    if not len(tags):
        raise InputError(f"{_WHAT} {gmsh.model.getCurrent()!r} has no mesh; gmsh.model.mesh.generate(3) makes one")
    place = np.full(int(tags.max()) + 1, -1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    groups, names, lost = _groups(gmsh)
    blocks, entities = [], []
    for dimension, entity in gmsh.model.getEntities():
        if dimension < 3 and groups and (dimension, entity) not in groups:
            continue
        kinds, _, nodes = mesh.getElements(dimension, entity)
        for kind, of in zip(kinds, nodes, strict=True):
            blocks.append(_block(mesh.getElementProperties(kind), place[of.astype(np.int64)]))
            entities.append((dimension, entity))
    raw = RawMesh(coordinates.reshape(-1, 3), blocks, field_data={name: np.array(names[name]) for name in names})
    first = [groups.get(entity, [0])[0] for entity in entities]
    raw.cell_data = {
        "gmsh:physical": [np.full(len(block), tag) for block, tag in zip(blocks, first, strict=True)],
        "gmsh:geometrical": [np.full(len(block), entity) for block, (_, entity) in zip(blocks, entities, strict=True)],
    }
    raw.cell_sets = _further(blocks, entities, groups, names)
    raw.periodic = _periodic(gmsh, place)
    return assembled(raw, _FORM, _WHAT, lost=lost)


def _gmsh() -> Any:
    import gmsh  # type: ignore[import-untyped]

    if not gmsh.isInitialized():
        raise ObjectError("gmsh has no current model; gmsh.initialize() begins one, gmsh.open(file) reads one")
    return gmsh


def _groups(gmsh: Any) -> tuple[dict[tuple[int, int], list[int]], dict[str, tuple[int, int]], list[str]]:
    """The groups of each entity, ascending; name: (tag, dimension); and names that two groups have."""
    groups: dict[tuple[int, int], list[int]] = defaultdict(list)
    names: dict[str, tuple[int, int]] = {}
    lost = []
    for dimension, tag in sorted(gmsh.model.getPhysicalGroups()):
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag).tolist():
            groups[dimension, abs(entity)].append(tag)
        name = gmsh.model.getPhysicalName(dimension, tag)
        if name in names:
            lost.append(f"name {name!r} of group {names[name][0]} of dimension {names[name][1]}")
        if name:
            names[name] = (tag, dimension)
    return dict(groups), names, lost


def _block(properties: tuple[Any, ...], nodes: Ints) -> RawBlock:
    title, _, order, count = properties[:4]
    kind = _SHAPES.get(title.split()[0], title) + (str(count) if order > 1 else "")
    cells = nodes.reshape(-1, count)
    return RawBlock(kind, cells[:, _ORDER[kind]] if kind in _ORDER else cells)


def _further(
    blocks: list[RawBlock],
    entities: list[tuple[int, int]],
    groups: dict[tuple[int, int], list[int]],
    names: dict[str, tuple[int, int]],
) -> dict[str, list[Ints | None]]:
    """Members of every group that is not the first of all its entities, by its name or number."""
    called = {pair: name for name, pair in names.items()}
    sets: dict[str, list[Ints | None]] = {}
    for tag, dimension in {(tag, of) for (of, _), tags in groups.items() for tag in tags[1:]}:
        members: list[Ints | None] = [
            np.arange(len(block)) if entity[0] == dimension and tag in groups.get(entity, ()) else None
            for block, entity in zip(blocks, entities, strict=True)
        ]
        name = called.get((tag, dimension), str(tag))
        before = sets.get(name, [None] * len(blocks))
        sets[name] = [one if one is not None else other for one, other in zip(members, before, strict=True)]
    return sets


def _periodic(gmsh: Any, place: Ints) -> list[Any]:
    """Sides that are images of others, as :attr:`wct_plugin.io.raw_mesh.RawMesh.periodic` has them."""
    found = []
    for dimension, entity in gmsh.model.getEntities(2):
        master, nodes, images, affine = gmsh.model.mesh.getPeriodicNodes(dimension, entity)
        if master != entity and len(nodes):
            pairs = np.column_stack([place[nodes.astype(np.int64)], place[images.astype(np.int64)]])
            found.append([dimension, (entity, master), affine, pairs])
    return found


def to_gmsh(mesh: TetMesh | SurfaceMesh, name: str = "") -> str:
    """Add a mesh to gmsh as a new discrete model, which becomes the current one, and give that model's name.

    It has the physical groups with their names, and arrays as views.

    Parameters
    ----------
    mesh : TetMesh or SurfaceMesh
        What to add.
    name : str, optional
        Of the model; without it that of the file the mesh came from. A number is added where a model has it.
    """
    gmsh = _gmsh()
    wanted = name or Path(mesh.source).stem or "well-centered"
    taken, free, number = set(gmsh.model.list()), wanted, 1
    while free in taken:
        number += 1
        free = f"{wanted} {number}"
    content, lost = contents(mesh, _FORM)
    if isinstance(mesh, TetMesh) and mesh.second_order:
        mid_nodes.put(content, mesh, _FORM)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "mesh.msh"
        lost += save(file, _FORM, mesh, content, MshOptions("4.1", True, None))
        gmsh.model.add(free)
        gmsh.merge(str(file))
    not_carried(_WHAT, lost)
    return free
