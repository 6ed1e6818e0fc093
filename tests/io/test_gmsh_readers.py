"""gmsh files we write, read by the solvers they are for: which groups they find by name, and how much is in each."""

from pathlib import Path

import gmsh
import meshio
import numpy as np
import pytest
import skfem
from netgen.read_gmsh import ReadGmsh
from support.builders import two_region_cube
from support.gmsh_session import gmsh_session
from support.solvers import devsim, fipy
from support.volumes import tet_volumes

import wct_plugin as wct
from wct_plugin.cli.main import run
from wct_plugin.errors import OptionError, OutputError
from wct_plugin.io import read, write
from wct_plugin.mesh import Cells, TetMesh


@pytest.fixture
def halves() -> TetMesh:
    """A box of two regions of different volume with facets at both ends, points of many digits, and data."""
    cube = two_region_cube(3)
    points = cube.points * [1 / 3, 1.1, np.pi]
    x = points[:, 0]
    skin = cube.topology.boundary
    ends = [skin[(x[skin] == at).all(axis=1)] for at in (x.min(), x.max())]
    return TetMesh(
        points,
        cube.tets,
        np.where(x[cube.tets].mean(axis=1) < x.max() / 3, 11, 12),
        facets=Cells(np.concatenate(ends), np.repeat([21, 22], [len(end) for end in ends])),
        point_data={"u": points, "id": np.arange(len(points))},
        cell_data={"heat": x[cube.tets].mean(axis=1)},
        names={"steel": (11, 3), "air": (12, 3), "inlet": (21, 2), "outlet": (22, 2)},
    )


def without_data(mesh: TetMesh) -> TetMesh:
    return TetMesh(mesh.points, mesh.tets, mesh.regions, facets=mesh.facets, names=mesh.names)


def shared(mesh: TetMesh) -> TetMesh:
    """The same with all tets and some facets in further groups."""
    facets = Cells(mesh.facets.vertices, mesh.facets.tags, {}, {"rim": np.array([0, 1, 2])})
    return TetMesh(
        mesh.points,
        mesh.tets,
        mesh.regions,
        facets=facets,
        tet_sets={"all": np.arange(len(mesh.tets))},
        names=dict(mesh.names) | {"all": (99, 3), "rim": (98, 2)},
    )


def by_hand(path: Path) -> tuple[dict[str, list[str]], np.ndarray, list[list[int]]]:
    """Sections, points and elements as a reader sees them that knows version 2.2 as text and nothing else."""
    sections: dict[str, list[str]] = {}
    lines = iter(path.read_text().splitlines())
    for line in lines:
        name = line.removeprefix("$")
        sections[name] = list(iter(lambda: next(lines), f"$End{name}"))
    points = np.array([[float(word) for word in line.split()] for line in sections["Nodes"][1:]])
    elements = [[int(word) for word in line.split()] for line in sections["Elements"][1:]]
    assert [len(points), len(elements)] == [int(sections[name][0]) for name in ("Nodes", "Elements")]
    return sections, points, elements


def test_the_text_is_what_version_2_2_says(halves: TetMesh, tmp_path: Path) -> None:
    """As gmshToFoam reads it: numbers from 1 on, two tags per element, names with dimension and number."""
    write(tmp_path / "a.msh", halves)
    sections, points, elements = by_hand(tmp_path / "a.msh")
    assert list(sections) == ["MeshFormat", "PhysicalNames", "Nodes", "Elements", "NodeData", "ElementData"]
    assert sections["MeshFormat"] == ["2.2 0 8"]
    assert sections["PhysicalNames"] == ["4", '2 21 "inlet"', '2 22 "outlet"', '3 11 "steel"', '3 12 "air"']
    assert np.array_equal(points[:, 0], np.arange(1, len(points) + 1))
    assert np.array_equal(points[:, 1:], halves.points)
    assert [row[0] for row in elements] == list(range(1, len(elements) + 1))
    assert {(row[1], row[2], len(row)) for row in elements} == {(4, 2, 9), (2, 2, 8)}
    tets = np.array([row for row in elements if row[1] == 4])
    facets = np.array([row for row in elements if row[1] == 2])
    assert np.array_equal(tets[:, 5:] - 1, halves.tets)
    assert np.array_equal(tets[:, 3], halves.regions)
    assert np.array_equal(facets[:, 5:] - 1, halves.facets.vertices)
    assert np.array_equal(facets[:, 3], halves.facets.tags)
    assert {tuple(row[3:5]) for row in elements} == {(tag, tag) for tag in (11, 12, 21, 22)}
    again = read(tmp_path / "a.msh")
    assert isinstance(again, TetMesh)
    assert np.array_equal(again.points, halves.points)
    assert np.array_equal(again.point_data["u"], halves.point_data["u"])
    assert np.array_equal(again.cell_data["heat"], halves.cell_data["heat"])


def test_devsim(halves: TetMesh, tmp_path: Path) -> None:
    """Regions and contacts by name, with their volumes and points; DEVSIM reads no files with arrays."""
    write(tmp_path / "a.msh", without_data(halves))
    devsim.create_gmsh_mesh(mesh="m", file=str(tmp_path / "a.msh"))
    for region in ("steel", "air"):
        devsim.add_gmsh_region(mesh="m", gmsh_name=region, region=region, material="Silicon")
    for contact, region in (("inlet", "steel"), ("outlet", "air")):
        devsim.add_gmsh_contact(mesh="m", gmsh_name=contact, region=region, material="metal", name=contact)
    devsim.finalize_mesh(mesh="m")
    devsim.create_device(mesh="m", device="d")
    try:
        assert sorted(devsim.get_contact_list(device="d")) == ["inlet", "outlet"]
        for region, contact, tag, end in (("steel", "inlet", 11, 21), ("air", "outlet", 12, 22)):
            where = {"device": "d", "region": region}
            assert len(devsim.get_element_node_list(**where)) == (halves.regions == tag).sum()
            facets = devsim.get_element_node_list(**where, contact=contact)
            assert len(facets) == (halves.facets.tags == end).sum()
            found = np.transpose([devsim.get_node_model_values(**where, name=axis) for axis in "xyz"])
            wanted = halves.points[np.unique(halves.tets[halves.regions == tag])]
            assert {tuple(point) for point in found.tolist()} == {tuple(point) for point in wanted.tolist()}
            shares = devsim.get_node_model_values(**where, name="NodeVolume")
            assert sum(shares) == pytest.approx(tet_volumes(halves)[halves.regions == tag].sum())
    finally:
        devsim.delete_device(device="d")
        devsim.delete_mesh(mesh="m")


def test_fipy(halves: TetMesh, tmp_path: Path) -> None:
    write(tmp_path / "a.msh", halves)
    mesh = fipy.Gmsh3D(str(tmp_path / "a.msh"))
    assert mesh.numberOfCells == len(halves.tets)
    own = tet_volumes(halves)
    found = np.asarray(mesh.cellVolumes)
    assert found.sum() == pytest.approx(own.sum())
    for name, tag in (("steel", 11), ("air", 12)):
        assert found[np.asarray(mesh.physicalCells[name])].sum() == pytest.approx(own[halves.regions == tag].sum())
    for name, tag in (("inlet", 21), ("outlet", 22)):
        assert np.asarray(mesh.physicalFaces[name]).sum() == (halves.facets.tags == tag).sum()


@pytest.mark.filterwarnings("ignore:Exception ignored:pytest.PytestUnraisableExceptionWarning")  # it leaves files open
@pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning")
def test_netgen(halves: TetMesh, tmp_path: Path) -> None:
    write(tmp_path / "a.msh", halves)
    mesh = ReadGmsh(str(tmp_path / "a.msh"))
    names = [mesh.GetMaterial(element.index) for element in mesh.Elements3D()]
    assert {name: names.count(name) for name in names} == {
        name: int((halves.regions == tag).sum()) for name, tag in (("steel", 11), ("air", 12))
    }
    sides = [mesh.GetBCName(element.index - 1) for element in mesh.Elements2D()]
    assert {name: sides.count(name) for name in sides} == {
        name: int((halves.facets.tags == tag).sum()) for name, tag in (("inlet", 21), ("outlet", 22))
    }
    assert np.array_equal(np.array([point.p for point in mesh.Points()]), halves.points)


def test_scikit_fem_and_meshio(halves: TetMesh, tmp_path: Path) -> None:
    write(tmp_path / "a.msh", without_data(halves))  # meshio cuts arrays of several kinds of cells into pieces
    mesh = skfem.Mesh.load(tmp_path / "a.msh")
    assert {name: len(cells) for name, cells in mesh.subdomains.items()} == {
        name: int((halves.regions == tag).sum()) for name, tag in (("steel", 11), ("air", 12))
    }
    assert {name: len(facets) for name, facets in mesh.boundaries.items()} == {
        name: int((halves.facets.tags == tag).sum()) for name, tag in (("inlet", 21), ("outlet", 22))
    }
    plain = meshio.read(tmp_path / "a.msh")
    assert np.array_equal(plain.points, halves.points)
    assert {name: tuple(pair) for name, pair in plain.field_data.items()} == dict(halves.names)


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("version", ["2.2", "4.1"])
def test_version_and_encoding(version: str, binary: bool, halves: TetMesh, tmp_path: Path) -> None:
    """By name in Python and in a pipeline; gmsh finds groups, names and arrays in each."""
    write(tmp_path / "a.msh", halves, version=version, binary=binary)
    chain = wct.Reader(halves) | wct.Writer(tmp_path / "b.msh", version=version, binary=binary)
    chain.execute()
    wct.Pipeline.from_json(_as_file(halves, tmp_path, version, binary)).execute()
    assert (tmp_path / "a.msh").read_bytes() == (tmp_path / "b.msh").read_bytes()
    head = f"$MeshFormat\n{version} {int(binary)} 8\n".encode()
    assert (tmp_path / "a.msh").read_bytes().startswith(head)
    assert (tmp_path / "c.msh").read_bytes().startswith(head)
    with gmsh_session():
        gmsh.open(str(tmp_path / "a.msh"))
        groups = {gmsh.model.getPhysicalName(*group): group[::-1] for group in gmsh.model.getPhysicalGroups()}
        assert groups == dict(halves.names)
        assert len(gmsh.view.getTags()) == 3
        ids, flat, _ = gmsh.model.mesh.getNodes()
        assert np.array_equal(flat.reshape(-1, 3)[np.argsort(ids)], halves.points)
    again = read(tmp_path / "a.msh")
    assert isinstance(again, TetMesh)
    assert np.array_equal(again.points, halves.points)
    assert np.array_equal(again.point_data["u"], halves.point_data["u"])
    assert sorted(again.cell_data["heat"]) == sorted(halves.cell_data["heat"])
    assert dict(again.names) == dict(halves.names)


def _as_file(mesh: TetMesh, folder: Path, version: str, binary: bool) -> list[object]:
    """The same as JSON, where the version may be a number."""
    write(folder / "in.vtu", mesh)
    target = {"filename": str(folder / "c.msh"), "version": float(version), "binary": binary}
    return [str(folder / "in.vtu"), target]


@pytest.mark.filterwarnings("ignore:Exception ignored:pytest.PytestUnraisableExceptionWarning")  # Netgen's again
@pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning")
def test_cells_in_several_groups_make_version_4_1_and_say_who_cannot_read_it(halves: TetMesh, tmp_path: Path) -> None:
    mesh = shared(halves)
    said = rf"written as version 4\.1, as {len(mesh.tets)} tets and 3 facets are in several groups; DEVSIM, FiPy"
    with pytest.warns(match=said):
        write(tmp_path / "a.msh", mesh)
    assert (tmp_path / "a.msh").read_text().startswith("$MeshFormat\n4.1 0 8\n")
    write(tmp_path / "b.msh", mesh, version="4.1", groups="all")  # asked for, so there is nothing to say
    assert (tmp_path / "a.msh").read_bytes() == (tmp_path / "b.msh").read_bytes()
    for refusing in (lambda path: devsim.create_gmsh_mesh(mesh="m", file=path), ReadGmsh):
        with pytest.raises((devsim.error, ValueError)):
            refusing(str(tmp_path / "a.msh"))


def test_the_first_group_alone_makes_version_2_2(halves: TetMesh, tmp_path: Path) -> None:
    mesh = shared(halves)
    with pytest.warns(match=rf"group 'all' lost {len(mesh.tets)} tets, group 'rim' lost 3 facets"):
        write(tmp_path / "a.msh", mesh, groups="first")
    _, _, elements = by_hand(tmp_path / "a.msh")
    assert [row[3] for row in elements] == [*mesh.regions, *mesh.facets.tags]


def test_a_group_of_cells_without_another_is_their_first(halves: TetMesh, tmp_path: Path) -> None:
    """Tets that have no tag are in one group, so version 2.2 has them all."""
    names = {"core": (99, 3), "air": (12, 3)}
    regions = np.where(halves.regions == 11, 0, 12)
    core = np.flatnonzero(regions == 0)
    write(tmp_path / "a.msh", TetMesh(halves.points, halves.tets, regions, tet_sets={"core": core}, names=names))
    _, _, elements = by_hand(tmp_path / "a.msh")
    assert [row[3] for row in elements] == np.where(halves.regions == 11, 99, 12).tolist()


def test_version_2_2_is_refused_for_cells_in_several_groups(halves: TetMesh, tmp_path: Path) -> None:
    """Before the work starts where the mesh was read so."""
    mesh = shared(halves)
    said = rf"a\.msh: {len(mesh.tets)} tets and 3 facets are in several groups, and version 2\.2 has one"
    with pytest.raises(OutputError, match=said):
        write(tmp_path / "a.msh", mesh, version="2.2")
    started = []
    chain = wct.Reader(mesh) | wct.Filter.meshing_well_centered() | wct.Writer(tmp_path / "a.msh", version="2.2")
    with pytest.raises(OutputError, match=said):
        chain.execute(lambda progress: started.append(progress.stage))
    assert started == ["reading"]
    assert not list(tmp_path.iterdir())
    skin = wct.Reader(mesh) | wct.Filter.generate_boundary_surface() | wct.Writer(tmp_path / "a.msh", version="2.2")
    with pytest.warns(match="cannot carry triangle set 'rim'"):
        skin.execute()  # a surface has no groups to share


def test_options_that_cannot_be(halves: TetMesh, tmp_path: Path) -> None:
    with pytest.raises(OptionError, match=r"a\.vtu: VTU has no option 'binary'; only gmsh files \(\.msh\) have it"):
        write(tmp_path / "a.vtu", halves, binary=True)
    with pytest.raises(OptionError, match=r"a\.msh: option 'version' is '4\.0'; allowed are 2\.2, 4\.1"):
        write(tmp_path / "a.msh", halves, version="4.0")
    with pytest.raises(OptionError, match="option 'groups' is 'last'; allowed are all, first"):
        write(tmp_path / "a.msh", halves, groups="last")
    with pytest.raises(OptionError, match=r"VTU has no option 'version'"):
        (wct.Reader(halves) | wct.Writer(tmp_path / "a.vtu", version="2.2")).check()
    with pytest.raises(OptionError, match=r"option 'version'"):
        wct.Writer(tmp_path / "a.msh", version="3")
    assert not list(tmp_path.iterdir())


def test_a_tag_too_large_for_the_format_is_refused(halves: TetMesh, tmp_path: Path) -> None:
    regions = halves.regions.copy()
    regions[3] = 2**31
    with pytest.raises(OutputError, match=r"tag 2147483648; gmsh files hold tags up to 2147483647"):
        write(tmp_path / "a.msh", TetMesh(halves.points, halves.tets, regions))
    assert not list(tmp_path.iterdir())


def test_the_command_line_has_the_options(tmp_path: Path) -> None:
    flags = ["--msh-version", "4.1", "--msh-binary", "true"]
    assert run(["create", "cube", str(tmp_path / "a.msh"), *flags]) == 0
    assert (tmp_path / "a.msh").read_bytes().startswith(b"$MeshFormat\n4.1 1 8\n")
    optimize = ["optimize", str(tmp_path / "a.msh"), str(tmp_path / "b.msh")]
    assert run([*optimize, "--msh-version", "2.2"]) == 0
    assert (tmp_path / "b.msh").read_bytes().startswith(b"$MeshFormat\n2.2 0 8\n")
    assert run([*optimize[:2], str(tmp_path / "b.vtu"), *flags]) == 2
    assert not (tmp_path / "b.vtu").exists()
