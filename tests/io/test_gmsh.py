"""Files that gmsh writes are read, and files we write are read by gmsh."""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import gmsh
import numpy as np
import pytest
from support.builders import kuhn_cube
from support.gmsh_session import add_two_boxes, gmsh_session

from wct_plugin.errors import WctWarning
from wct_plugin.io import read, write
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.pipeline.stage import apply_filter


@pytest.fixture(autouse=True)
def _session() -> Iterator[None]:
    with gmsh_session():
        yield


def two_boxes(path: Path, version: float, groups: dict[str, tuple[int, int, list[int]]], **options: int) -> TetMesh:
    """Two boxes that share a face, meshed and written by gmsh; groups are name -> (dimension, tag, entities)."""
    add_two_boxes()
    for name, (dimension, tag, entities) in groups.items():
        gmsh.model.addPhysicalGroup(dimension, entities, tag, name)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 1)
    gmsh.model.mesh.generate(3)
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    for name, value in options.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)
    gmsh.write(str(path))
    mesh = read(path)
    assert isinstance(mesh, TetMesh)
    return mesh


GROUPS = {
    "left": (3, 11, [1]),
    "right hand": (3, 12, [2]),
    "wall": (2, 5, [1, 2]),
    "edge": (1, 6, [1]),
    "probe": (0, 9, [1]),
}
NAMES = {name: (tag, dimension) for name, (dimension, tag, _) in GROUPS.items()}
versions = pytest.mark.parametrize("version", [2.2, 4.1])
encodings = pytest.mark.parametrize("binary", [0, 1])


@versions
@encodings
def test_two_volumes_with_groups(version: float, binary: int, tmp_path: Path) -> None:
    mesh = two_boxes(tmp_path / "a.msh", version, GROUPS, Binary=binary)
    assert dict(mesh.names) == NAMES
    assert mesh.tag_name == "gmsh:physical"
    assert set(mesh.regions) == {11, 12}
    assert set(mesh.facets.tags) == {5}
    assert set(mesh.edges.tags) == {6}
    assert mesh.nodes.tags.tolist() == [9]
    assert not mesh.tet_sets
    assert not mesh.facets.sets
    assert (mesh.points[mesh.tets[mesh.regions == 11]].mean(axis=1)[:, 0] < 1).all()
    assert len(mesh.topology.interfaces)

    write(tmp_path / "b.msh", mesh)
    gmsh.open(str(tmp_path / "b.msh"))
    groups = {gmsh.model.getPhysicalName(*group): group for group in gmsh.model.getPhysicalGroups()}
    assert groups == {name: (dimension, tag) for name, (tag, dimension) in NAMES.items()}
    volume = 0.0
    for tag, region in ((11, 0), (12, 1)):
        (entity,) = gmsh.model.getEntitiesForPhysicalGroup(3, tag)
        centre = np.array(gmsh.model.getBoundingBox(3, int(entity))).reshape(2, 3).mean(axis=0)
        assert centre == pytest.approx([0.5 + region, 0.5, 0.5], abs=1e-6)
        kinds, ids, _ = gmsh.model.mesh.getElements(3, int(entity))
        assert kinds.tolist() == [4]
        volume += gmsh.model.mesh.getElementQualities(ids[0], "volume").sum()
    assert volume == pytest.approx(2)
    again = read(tmp_path / "b.msh")
    assert isinstance(again, TetMesh)
    for name in ("points", "tets", "regions"):
        assert np.array_equal(getattr(again, name), getattr(mesh, name))
    assert not mesh.cell_data  # the number of gmsh's entity is no data of the user's
    assert not mesh.facets.data


@versions
@encodings
def test_without_groups_the_entities_are_the_tags(version: float, binary: int, tmp_path: Path) -> None:
    mesh = two_boxes(tmp_path / "a.msh", version, {}, Binary=binary)
    assert mesh.tag_name == "gmsh:geometrical"
    assert set(mesh.regions) == {1, 2}
    assert set(mesh.facets.tags) == set(range(1, 12))
    write(tmp_path / "b.msh", mesh)
    gmsh.open(str(tmp_path / "b.msh"))
    assert gmsh.model.getPhysicalGroups() == []
    assert [tag for _, tag in gmsh.model.getEntities(3)] == [1, 2]
    again = read(tmp_path / "b.msh")
    assert isinstance(again, TetMesh)
    assert again.tag_name == "gmsh:geometrical"
    assert np.array_equal(again.facets.tags, mesh.facets.tags)


@encodings
def test_groups_on_some_entities_only(binary: int, tmp_path: Path) -> None:
    groups = {name: GROUPS[name] for name in ("left", "wall")}
    mesh = two_boxes(tmp_path / "a.msh", 4.1, groups, Binary=binary, SaveAll=1)
    assert set(mesh.regions) == {0, 11}
    assert set(mesh.facets.tags) == {0, 5}
    write(tmp_path / "b.msh", mesh)
    gmsh.open(str(tmp_path / "b.msh"))
    assert len(gmsh.model.getEntitiesForPhysicalGroup(3, 11)) == 1
    assert len(gmsh.model.getEntities(3)) == 2


def test_from_gmsh_to_medit(tmp_path: Path) -> None:
    """meshio itself fails here, on the entities of the points that a file of version 4.1 has."""
    mesh = two_boxes(tmp_path / "a.msh", 4.1, GROUPS)
    with pytest.warns(match="Medit cannot carry, so dropped: 1 tagged vertices, name"):
        write(tmp_path / "a.mesh", mesh)
    gmsh.open(str(tmp_path / "a.mesh"))
    assert len(gmsh.model.getEntities(3)) == 2


@versions
def test_a_cell_in_two_groups_keeps_the_second_as_a_set(version: float, tmp_path: Path) -> None:
    mesh = two_boxes(tmp_path / "a.msh", version, GROUPS | {"all": (3, 99, [1, 2])})
    assert set(mesh.regions) == {11, 12}
    assert {name: len(members) for name, members in mesh.tet_sets.items()} == {"all": len(mesh.tets)}


@versions
def test_groups_that_share_cells_are_groups_again(version: float, tmp_path: Path) -> None:
    """All from gmsh's API, by our file and back into gmsh: which cells each group has, with data beside."""
    shared = {"all": (3, 99, [1, 2]), "walls": (2, 98, [2, 3, 4]), "edges": (1, 97, [1, 2])}
    mesh = two_boxes(tmp_path / "a.msh", version, GROUPS | shared)
    wanted = measures_of_groups()
    assert wanted["all", 3, 99] == pytest.approx(2)
    mesh = replace(mesh, cell_data={"x": mesh.points[mesh.tets].mean(axis=1)[:, 0]})
    write(tmp_path / "b.msh", mesh, version="4.1")
    gmsh.open(str(tmp_path / "b.msh"))
    assert measures_of_groups() == pytest.approx(wanted)
    assert sum(map(len, gmsh.model.mesh.getElements(3)[1])) == len(mesh.tets)

    again = read(tmp_path / "b.msh")
    assert isinstance(again, TetMesh)
    assert dict(again.names) == dict(mesh.names)
    assert np.array_equal(again.points, mesh.points)
    assert {tuple(row) for row in again.tets.tolist()} == {tuple(row) for row in mesh.tets.tolist()}
    assert again.cell_data["x"] == pytest.approx(again.points[again.tets].mean(axis=1)[:, 0])
    for name, members in mesh.tet_sets.items():
        assert len(again.tet_sets[name]) == len(members)
    for before, after in ((mesh.facets, again.facets), (mesh.edges, again.edges)):
        assert sorted(after.tags) == sorted(before.tags)
        for name, members in before.sets.items():
            rows = {tuple(row) for row in before.vertices[members].tolist()}
            assert {tuple(row) for row in after.vertices[after.sets[name]].tolist()} == rows


def measures_of_groups() -> dict[tuple[str, int, int], float]:
    """Length, area or volume (number of points) of each group of gmsh's model, by name, dimension and tag."""
    ids, flat_points, _ = gmsh.model.mesh.getNodes()
    points = np.zeros((int(ids.max()) + 1, 3))
    points[ids] = flat_points.reshape(-1, 3)
    found = {}
    for dimension, tag in gmsh.model.getPhysicalGroups():
        total = 0.0
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag):
            kinds, _, nodes = gmsh.model.mesh.getElements(dimension, int(entity))
            assert kinds.tolist() == [{0: 15, 1: 1, 2: 2, 3: 4}[dimension]]
            corners = points[nodes[0].reshape(-1, dimension + 1)]
            legs = corners[:, 1:] - corners[:, :1]
            total += np.sqrt(np.linalg.det(legs @ legs.transpose(0, 2, 1))).sum() / math.factorial(dimension)
        found[gmsh.model.getPhysicalName(dimension, tag), dimension, tag] = total
    return found


@versions
def test_groups_go_through_the_optimizer(version: float, tmp_path: Path) -> None:
    """Names, tags, dimensions and measures of the groups, as gmsh sees them before and after."""
    boxes = [(3, gmsh.model.occ.addBox(at, 0, 0, 1, 1, 1)) for at in (0, 1)]
    gmsh.model.occ.fragment(boxes[:1], boxes[1:])
    gmsh.model.occ.synchronize()
    found = {3: {1: "left", 2: "right hand"}, 2: {}, 1: {}, 0: {}}
    for dimension, entity in gmsh.model.getEntities():
        low, high = np.reshape(gmsh.model.getBoundingBox(dimension, entity), (2, 3)).round(3)
        if dimension == 2 and low[0] == high[0]:
            found[2][entity] = {0: "in & out", 1: "interface", 2: "in & out"}[int(low[0])]
        elif dimension == 1 and low[0] != high[0] and (low[1:] == 0).all() and (high[1:] == 0).all():
            found[1][entity] = "rail"
        elif dimension == 0 and (low == [2, 1, 1]).all():
            found[0][entity] = "probe"
    for dimension, names in found.items():
        for name in dict.fromkeys(names.values()):
            tag = gmsh.model.addPhysicalGroup(dimension, [at for at, one in names.items() if one == name])
            gmsh.model.setPhysicalName(dimension, tag, name)
    gmsh.model.addPhysicalGroup(3, [1, 2], name="all")
    gmsh.model.addPhysicalGroup(2, list(found[2]), name="across")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.25)
    gmsh.model.mesh.generate(3)
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.write(str(tmp_path / "a.msh"))
    before = measures_of_groups()
    assert {name: measure for (name, *_), measure in before.items()} == pytest.approx(
        {"left": 1, "right hand": 1, "all": 2, "in & out": 2, "interface": 1, "across": 3, "rail": 2, "probe": 1}
    )

    mesh = read(tmp_path / "a.msh")
    better, metrics = apply_filter("meshing_well_centered", mesh, goal="3wc")
    assert metrics["bad"] == 0
    write(tmp_path / "b.msh", better, version="4.1")
    gmsh.open(str(tmp_path / "b.msh"))
    assert len(gmsh.model.mesh.getElements(3)[1][0]) == len(better.tets) != len(mesh.tets)
    assert measures_of_groups() == pytest.approx(before)


def test_what_we_write_is_read_by_gmsh(full: TetMesh, tmp_path: Path) -> None:
    with pytest.warns(match="gmsh cannot carry"):
        write(tmp_path / "a.msh", full)
    gmsh.open(str(tmp_path / "a.msh"))
    counts = {dim: sum(len(ids) for ids in gmsh.model.mesh.getElements(dim)[1]) for dim in range(4)}
    assert counts == {0: 3, 1: 5, 2: 48, 3: 48}
    assert gmsh.model.getPhysicalName(2, 7) == "the wall"
    nodes = gmsh.model.mesh.getNodesForPhysicalGroup(2, 7)[0]
    assert set(nodes - 1) == set(full.facets.vertices[full.facets.tags == 7].ravel())
    assert len(gmsh.view.getTags()) == 7  # u, id, heat, flux and three sets


@pytest.mark.parametrize("suffix", [".mesh", ".vtk", ".stl", ".su2", ".med", ".inp", ".bdf"])
def test_other_formats_of_gmsh(suffix: str, tmp_path: Path) -> None:
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMin", 1)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(tmp_path / f"a{suffix}"))
    mesh = read(tmp_path / f"a{suffix}")
    if suffix == ".stl":
        assert len(mesh.triangles) == len(gmsh.model.mesh.getElements(2)[1][0])
    else:
        assert len(mesh.tets) == len(gmsh.model.mesh.getElements(3)[1][0])


@pytest.mark.parametrize("suffix", [".mesh", ".med", ".bdf"])
def test_gmsh_reads_our_other_formats(suffix: str, full: TetMesh, tmp_path: Path) -> None:
    """With a tag as the number of an entity, which is what gmsh makes of tags that come without names."""
    facets, edges = Cells(full.facets.vertices, full.facets.tags), Cells(full.edges.vertices, full.edges.tags)
    write(tmp_path / f"a{suffix}", TetMesh(full.points.round(9), full.tets, full.regions, facets, edges))
    gmsh.open(str(tmp_path / f"a{suffix}"))
    for dimension, tags in ((3, full.regions), (2, facets.tags), (1, edges.tags)):
        found = {
            int(entity): sum(map(len, gmsh.model.mesh.getElements(dimension, entity)[1]))
            for _, entity in gmsh.model.getEntities(dimension)
        }
        assert found == dict(zip(*(one.tolist() for one in np.unique(tags, return_counts=True)), strict=True))


@pytest.mark.parametrize("version", ["2.2", "4.1"])
def test_tags_below_zero_are_named_unless_they_have_names(tmp_path: Path, version: str) -> None:
    mesh = replace(kuhn_cube(2), regions=np.where(np.arange(48) < 20, -5, 7))
    with pytest.warns(WctWarning, match=r"tags below 0 of tetra cells \(-5 is 5\)"):
        write(tmp_path / "a.msh", mesh, version=version)
    assert np.unique(read(tmp_path / "a.msh").regions).tolist() == [5, 7]
    write(tmp_path / "b.msh", replace(mesh, names={"oxide": (-5, 3)}), version=version)  # and no warning
    assert read(tmp_path / "b.msh").names == {"oxide": (5, 3)}
