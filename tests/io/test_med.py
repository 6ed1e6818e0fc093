"""MED: groups are families, read by gmsh as physical groups; and what Salome and gmsh write comes back."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import gmsh
import h5py
import numpy as np
import pytest
from support.builders import kuhn_cube
from support.gmsh_session import gmsh_session

import wct_plugin as wct
from wct_plugin.mesh import Cells, TetMesh


@pytest.fixture(autouse=True)
def _gmsh() -> Iterator[None]:
    with gmsh_session():
        yield


def groups() -> dict[tuple[int, str], int]:
    """Cells of each physical group of gmsh's model, by dimension and name."""
    found = {}
    for dimension, tag in gmsh.model.getPhysicalGroups():
        entities = gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
        cells = sum(len(ids) for e in entities for ids in gmsh.model.mesh.getElements(dimension, e)[1])
        if cells:
            found[dimension, gmsh.model.getPhysicalName(dimension, tag).strip()] = cells
    return found


def box(path: Path) -> None:
    """A box of two volumes with groups, by gmsh: one of facets on two sides, one name in Cyrillic."""
    boxes = [(3, gmsh.model.occ.addBox(at, 0, 0, 1, 1, 1)) for at in (0, 1)]
    gmsh.model.occ.fragment(boxes[:1], boxes[1:])
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [1], name="сталь")
    gmsh.model.addPhysicalGroup(3, [2], name="air")
    gmsh.model.addPhysicalGroup(2, [1, 3], name="inlet")
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.5)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(path))


def test_groups_of_gmsh_there_and_back(tmp_path: Path) -> None:
    box(tmp_path / "a.med")
    gmsh.open(str(tmp_path / "a.med"))
    before = groups()
    assert set(before) == {(3, "сталь"), (3, "air"), (2, "inlet")}
    mesh = wct.read(tmp_path / "a.med")
    assert isinstance(mesh, TetMesh)
    assert len(set(mesh.regions)) == 2
    assert set(mesh.tet_sets) == {"сталь", "air"}
    assert {name for name, (_, dimension) in mesh.names.items() if dimension == 3} == {"сталь", "air"}
    wct.write(tmp_path / "b.med", mesh)
    gmsh.open(str(tmp_path / "b.med"))
    assert groups() == before
    again = wct.read(tmp_path / "b.med")
    assert isinstance(again, TetMesh)
    assert np.array_equal(again.regions, mesh.regions)
    assert again.names == mesh.names
    assert {name: ids.tolist() for name, ids in again.tet_sets.items()} == {
        name: ids.tolist() for name, ids in mesh.tet_sets.items()
    }
    assert again.facets.sets["inlet"].tolist() == mesh.facets.sets["inlet"].tolist()
    wct.write(tmp_path / "c.msh", mesh)
    gmsh.open(str(tmp_path / "c.msh"))
    assert groups()[3, "сталь"] == before[3, "сталь"]


def test_groups_when_the_tets_are_made_anew(tmp_path: Path) -> None:
    box(tmp_path / "a.med")
    mesh = wct.read(tmp_path / "a.med")
    better, _ = wct.apply_filter("meshing_well_centered", mesh, goal="3wc", force=True)
    wct.write(tmp_path / "b.med", better)
    gmsh.open(str(tmp_path / "b.med"))
    found = groups()
    assert found[3, "сталь"] + found[3, "air"] == len(better.tets)
    corners = better.points[better.tets[better.tet_sets["сталь"]]]
    assert np.linalg.det(corners[:, 1:] - corners[:, :1]).sum() / 6 == pytest.approx(1, rel=1e-12)


def test_tags_names_and_sets_of_all_kinds(tmp_path: Path) -> None:
    cube = kuhn_cube(2)
    facets = cube.topology.boundary
    mesh = replace(
        cube,
        regions=np.arange(len(cube.tets)) % 3,
        facets=Cells(facets, np.arange(len(facets)) % 2 * 5, sets={"größe": np.array([1, 2]), "core": np.array([0])}),
        edges=Cells(facets[:3, :2], np.array([4, -4, 1])),
        nodes=Cells(facets[:1, :1], np.array([9])),
        point_sets={"fixed": np.array([0, 5]), "both": np.array([5, 6])},
        tet_sets={"core": np.array([3, 4]), "one": np.flatnonzero(np.arange(len(cube.tets)) % 3 == 1), "void": []},
        names={"one": (1, 3), "wall": (5, 2), "nothing": (77, 3)},
    )
    wct.write(tmp_path / "a.med", mesh)
    got = wct.read(tmp_path / "a.med")
    assert isinstance(got, TetMesh)
    assert got.names == mesh.names
    assert np.array_equal(got.regions, mesh.regions)
    for one, other in ((got.facets, mesh.facets), (got.edges, mesh.edges), (got.nodes, mesh.nodes)):
        assert np.array_equal(one.tags, other.tags)
        assert {name: ids.tolist() for name, ids in one.sets.items()} == {n: i.tolist() for n, i in other.sets.items()}
    for one_sets, other_sets in ((got.tet_sets, mesh.tet_sets), (got.point_sets, mesh.point_sets)):
        assert {name: ids.tolist() for name, ids in one_sets.items()} == {n: list(i) for n, i in other_sets.items()}
    gmsh.open(str(tmp_path / "a.med"))
    found = groups()
    assert found[3, "one"] == len(mesh.tet_sets["one"])
    assert found[3, "G_3D_2"] == (mesh.regions == 2).sum()  # as gmsh calls groups without a name
    assert found[2, "wall"] == (mesh.facets.tags == 5).sum()
    assert found[2, "größe"] == 2


def test_names_as_older_programs_wrote_them(tmp_path: Path) -> None:
    cube = kuhn_cube(1)
    wct.write(tmp_path / "a.med", replace(cube, tet_sets={"x": np.array([0])}))
    with h5py.File(tmp_path / "a.med", "r+") as file:
        (family,) = file["FAS/mesh/ELEME"].values()
        family["GRO/NOM"][0] = np.frombuffer("façade".encode("latin-1").ljust(80, b" "), dtype=np.int8)
        family.parent.move(family.name.split("/")[-1], "FAM_-5_Groupe")  # as Salome calls it
    mesh = wct.read(tmp_path / "a.med")
    assert isinstance(mesh, TetMesh)
    assert mesh.tet_sets["façade"].tolist() == [0]


def test_families_whose_names_are_not_utf8(tmp_path: Path) -> None:
    """Salome writes names in the letters of the machine, as Latin-1 in France; HDF5 takes them as they are."""
    mesh = kuhn_cube(2)
    left = np.flatnonzero(mesh.points[mesh.tets].mean(axis=1)[:, 0] < 0.5)
    wct.write(tmp_path / "a.med", replace(mesh, tet_sets={"left": left}))
    with h5py.File(tmp_path / "a.med", "r+") as file:
        families = next(iter(file["FAS"].values()))["ELEME"]
        name = next(iter(families)).encode()
        families.id.links.move(name, families.id, name + b"_pi\xe8ce")
        assert not all(isinstance(one, str) for one in families)
    found = wct.read(tmp_path / "a.med")
    assert isinstance(found, TetMesh)
    assert found.tet_sets["left"].tolist() == left.tolist()


def test_what_no_group_can_be_called_is_named(tmp_path: Path) -> None:
    cube = kuhn_cube(1)
    long = "é" * 41
    with pytest.warns(match=f"MED cannot carry, so dropped: name '{long}'"):
        wct.write(tmp_path / "a.med", replace(cube, regions=np.full(len(cube.tets), 3), names={long: (3, 3)}))
    assert set(wct.read(tmp_path / "a.med").regions) == {3}  # type: ignore[union-attr]


def test_fields_of_points_and_cells(tmp_path: Path) -> None:
    cube = kuhn_cube(2)
    u = np.random.default_rng(0).normal(size=(len(cube.points), 3))
    heat = np.sqrt(np.arange(len(cube.tets)))
    wct.write(tmp_path / "a.med", replace(cube, point_data={"u": u, "heat": u[:, 0]}, cell_data={"heat": heat}))
    got = wct.read(tmp_path / "a.med")
    assert isinstance(got, TetMesh)
    assert np.array_equal(got.point_data["u"], u)
    assert np.array_equal(got.point_data["heat"], u[:, 0])
    assert np.array_equal(got.cell_data["heat"], heat)
