"""What goes in comes out: every format, with everything it can carry, and a warning that names the rest."""

import dataclasses
import os
import re
import subprocess
import warnings
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from support.comparing import assert_same, flat

from wct_plugin.errors import InputError, OutputError, WctWarning
from wct_plugin.io import read, write
from wct_plugin.io.formats import FORMATS
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh

VOLUMES = [(form, suffix) for form in FORMATS for suffix in form.suffixes if form.volume and form.writes]
SURFACES = [(form, suffix) for form in FORMATS for suffix in form.suffixes if form.surface and form.writes]
A_NAME = "a name <&\"é'"


def there_and_back(mesh: Any, path: Path) -> tuple[Any, str]:
    """The mesh after writing and reading, and the warning of writing; the mesh itself must be as before."""
    before = {name: np.array(item) for name, item in flat(mesh).items()}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        write(path, mesh)
    assert all(warning.category is WctWarning for warning in caught)
    assert len(caught) <= 1
    assert all(warning.filename == __file__ for warning in caught)
    for name, item in flat(mesh).items():
        assert np.array_equal(item, before[name]), name
    got = read(path)
    assert got.source == str(path)
    return got, str(caught[0].message) if caught else ""


# What each format does not give back of the mesh that has everything; the writer's warning must say the same.
_NAMES = r"names\."
_NO_ARRAYS = r"names\.|point_data|cell_data|.*sets|facets\.data"
LOST = {
    "VTU": "(?!)",
    "VTK": rf"cell_data\.uv|{_NAMES}",
    "XDMF": _NAMES,
    "gmsh": rf"cell_data\.uv|cell_data\.{re.escape(A_NAME)}",
    "MED": "(?!)",
    "Medit": rf"{_NO_ARRAYS}|nodes",
    "Nastran": rf"{_NO_ARRAYS}|nodes|points",
    "Abaqus": r"point_data|cell_data|facets\.data|nodes",
    "SU2": rf"{_NO_ARRAYS}|nodes|edges|regions|facets",
    "TetGen": rf"{_NO_ARRAYS}|nodes|edges",
}
_ALL_NAMES = "name 'steel', name 'air', name 'the wall'"
_ALL_DATA = "point data 'u', point data 'id', cell data 'heat', cell data \"a name <&\\\"é'\", cell data 'uv'"
_ALL_SETS = "set 'core' of tets, set 'inlet' of facets, set 'fixed' of points"
SAID = {
    "VTU": "",
    "VTK": f"cell data 'uv', {_ALL_NAMES}",
    "XDMF": _ALL_NAMES,
    "gmsh": "cell data \"a name <&\\\"é'\", cell data 'uv'",
    "MED": "",
    "Medit": f"3 tagged vertices, {_ALL_DATA}, cell data 'flux', {_ALL_SETS}, {_ALL_NAMES}",
    "Nastran": "3 tagged vertices, digits of coordinates beyond what 16 characters hold, "
    f"{_ALL_DATA}, cell data 'flux', {_ALL_SETS}, {_ALL_NAMES}",
    "Abaqus": f"3 tagged vertices, {_ALL_DATA}, cell data 'flux'",
    "SU2": f"5 tagged edges, 3 tagged vertices, {_ALL_DATA}, cell data 'flux', regions, {_ALL_SETS}, {_ALL_NAMES}",
    "TetGen": f"5 tagged edges, 3 tagged vertices, {_ALL_DATA}, cell data 'flux', {_ALL_SETS}, {_ALL_NAMES}",
}


@pytest.mark.parametrize(("form", "suffix"), VOLUMES, ids=lambda value: value if isinstance(value, str) else "")
def test_a_mesh_with_everything(form: Any, suffix: str, full: TetMesh, tmp_path: Path) -> None:
    path = tmp_path / f"part{suffix}"
    got, said = there_and_back(full, path)
    assert_same(got, full, without=LOST[form.name])
    wanted = f"{path}: {form.name} cannot carry, so dropped: {SAID[form.name]}" if SAID[form.name] else ""
    assert said.replace(repr(A_NAME), '"a name <&\\"é\'"') == wanted


@pytest.mark.parametrize(("form", "suffix"), VOLUMES, ids=lambda value: value if isinstance(value, str) else "")
def test_a_plain_mesh_comes_back_plain(form: Any, suffix: str, plain: TetMesh, tmp_path: Path) -> None:
    got, said = there_and_back(plain, tmp_path / f"part{suffix}")
    assert_same(got, plain, without="points" if form.name == "Nastran" else "(?!)")
    assert got.tag_name == "gmsh:physical"
    assert not got.repairs
    assert ("digits" in said) if form.name == "Nastran" else not said


@pytest.mark.parametrize(("form", "suffix"), SURFACES, ids=lambda value: value if isinstance(value, str) else "")
def test_a_surface(form: Any, suffix: str, surface: SurfaceMesh, tmp_path: Path) -> None:
    got, said = there_and_back(surface, tmp_path / f"part{suffix}")
    assert isinstance(got, SurfaceMesh)
    data = "" if form.cell_data else "point_data|cell_data|"
    tags = "" if form.tagged or form.sets else "tags|"
    if form.name == "STL":  # a list of corners, whose points come in another order
        assert np.array_equal(got.points[got.triangles], surface.points[surface.triangles])
        assert len(got.points) == len(surface.points)
        data += "points|triangles|"
    rounded = "points|" if form.name == "Nastran" else ""
    assert_same(got, surface, without=f"{data}{tags}{rounded}(?!)")
    assert ("point data 'quality'" in said) == (not form.point_data)
    assert ("tags" in said) == bool(tags)


def test_nastran_rounds_to_its_fields_and_says_so(full: TetMesh, tmp_path: Path) -> None:
    points = full.points * [1, -1e-12, 1e15]
    mesh = TetMesh(points, full.tets)
    got, said = there_and_back(mesh, tmp_path / "a.bdf")
    assert "digits of coordinates beyond what 16 characters hold" in said
    assert np.abs(got.points - points).max(axis=0) == pytest.approx([0, 0, 0], abs=1e6)
    assert np.allclose(got.points, points, rtol=1e-8, atol=0)


@pytest.mark.parametrize("suffix", [".VTU", ".Msh", ".STL", ".Mesh"])
def test_suffixes_in_capitals(suffix: str, plain: TetMesh, tmp_path: Path) -> None:
    mesh = plain.boundary_surface() if suffix == ".STL" else plain
    got, _ = there_and_back(mesh, tmp_path / f"a{suffix}")
    assert np.array_equal(got.points[:5], mesh.points[:5]) or suffix == ".STL"


@pytest.mark.parametrize("suffix", [".node", ".ele", ".xdmf"])
def test_companion_files_lie_beside(suffix: str, plain: TetMesh, tmp_path: Path) -> None:
    write(tmp_path / f"part.1{suffix}", plain)
    needed = {".node": ".ele", ".ele": ".node", ".xdmf": ".h5"}[suffix]
    others = [needed] if suffix == ".xdmf" else [needed, ".face"]
    assert sorted(os.listdir(tmp_path)) == sorted(f"part.1{one}" for one in (suffix, *others))
    (tmp_path / f"part.1{needed}").unlink()
    said = rf"part\.1\{suffix}: cannot be read as .*(no such file|needs part\.1\.{needed[1:]} beside it)"
    with pytest.raises(InputError, match=said):
        read(tmp_path / f"part.1{suffix}")


def test_arrays_only_facets_have_are_not_invented_elsewhere(plain: TetMesh, tmp_path: Path) -> None:
    facets = Cells(plain.topology.boundary[:6], None, {"count": np.arange(6), "flux": np.ones(6)})  # type: ignore[arg-type]
    mesh = dataclasses.replace(plain, facets=facets, cell_data={"heat": np.zeros(len(plain.tets))})
    got, _ = there_and_back(mesh, tmp_path / "a.vtu")
    assert_same(got, mesh)


def test_odd_arrays(plain: TetMesh, tmp_path: Path) -> None:
    count = len(plain.tets)
    mesh = dataclasses.replace(
        plain,
        cell_data={
            "words": np.array(["a"] * count),
            "tensor": np.zeros((count, 3, 3)),
            "half": np.ones(count, dtype=np.float16),
            "truth": np.arange(count) % 2 == 0,
            "small": np.ones(count, dtype=np.uint8),
        },
    )
    for suffix in (".vtu", ".vtk", ".xdmf", ".msh", ".med"):
        got, said = there_and_back(mesh, tmp_path / f"a{suffix}")
        assert said.endswith("dropped: cell data 'words', cell data 'tensor'")
        for name in ("half", "truth", "small"):
            assert np.array_equal(got.cell_data[name], mesh.cell_data[name]), (suffix, name)


def test_the_same_name_with_other_shapes_is_dropped_aloud(plain: TetMesh, tmp_path: Path) -> None:
    facets = Cells(plain.topology.boundary, None, {"flux": np.ones((48, 3))})  # type: ignore[arg-type]
    mesh = dataclasses.replace(plain, facets=facets, cell_data={"flux": np.ones(len(plain.tets))})
    with pytest.warns(WctWarning, match="dropped: cell data 'flux'"):
        write(tmp_path / "a.vtu", mesh)


def test_tags_of_an_unusual_name_stay_tags(plain: TetMesh, tmp_path: Path) -> None:
    regions = np.arange(len(plain.tets)) % 2
    mesh = dataclasses.replace(plain, regions=regions, tag_name="material", cell_data={"gmsh:physical": regions * 9})
    got, said = there_and_back(mesh, tmp_path / "a.vtu")
    assert np.array_equal(got.regions, regions)
    assert said.endswith("dropped: cell data 'gmsh:physical', whose name is that of the tags")


def test_medit_after_gmsh_and_back(full: TetMesh, tmp_path: Path) -> None:
    with pytest.warns(WctWarning):
        write(tmp_path / "a.msh", full)
    with pytest.warns(WctWarning):
        write(tmp_path / "a.mesh", read(tmp_path / "a.msh"))
    mesh = read(tmp_path / "a.mesh")
    assert isinstance(mesh, TetMesh)
    assert mesh.tag_name == "medit:ref"
    assert np.array_equal(mesh.regions, full.regions)
    assert np.array_equal(mesh.facets.tags, full.facets.tags)
    write(tmp_path / "b.vtu", mesh)
    again = read(tmp_path / "b.vtu")
    assert isinstance(again, TetMesh)
    assert again.tag_name == "medit:ref"
    assert_same(again, mesh)


def test_med_groups_become_sets(plain: TetMesh, tmp_path: Path) -> None:
    given = meshio.Mesh(plain.points, [("tetra", plain.tets)], cell_data={"cell_tags": [np.arange(48) % 3 - 2]})
    given.cell_tags = {-2: ["core"], -1: ["core", "shell"]}
    meshio.med.write(tmp_path / "a.med", given)
    mesh = read(tmp_path / "a.med")
    assert isinstance(mesh, TetMesh)
    assert np.array_equal(mesh.regions, np.arange(48) % 3 - 2)
    assert np.array_equal(mesh.tet_sets["core"], np.flatnonzero(mesh.regions < 0))
    assert np.array_equal(mesh.tet_sets["shell"], np.flatnonzero(mesh.regions == -1))


@pytest.mark.parametrize("options", [{"binary": False}, {"compression": None}, {"compression": "lzma"}, {}])
def test_vtu_in_every_encoding(options: dict[str, Any], plain: TetMesh, tmp_path: Path) -> None:
    points = np.round(plain.points, 6)  # meshio's text has 12 digits
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(points, [("tetra", plain.tets)]), **options)
    mesh = read(tmp_path / "a.vtu")
    assert np.array_equal(mesh.points, points)
    assert mesh.points.dtype == np.float64


@pytest.mark.parametrize("binary", [True, False])
@pytest.mark.parametrize("version", ["4.2", "5.1"])
def test_vtk_of_other_versions(version: str, binary: bool, plain: TetMesh, tmp_path: Path) -> None:
    given = meshio.Mesh(plain.points, [("tetra", plain.tets)], cell_data={"id": [np.arange(48)]})
    meshio.vtk.write(tmp_path / "a.vtk", given, fmt_version=version, binary=binary)
    mesh = read(tmp_path / "a.vtk")
    assert isinstance(mesh, TetMesh)
    for array in (mesh.points, mesh.tets, mesh.cell_data["id"]):
        assert array.dtype.isnative
    assert np.array_equal(mesh.cell_data["id"].ravel(), np.arange(48))
    assert np.allclose(mesh.points, plain.points)


def test_vtk_as_vtk_itself_writes_it(tmp_path: Path) -> None:
    """Types meshio gets wrong or does not know, and VTK's spelling of a blank."""
    numbers = {"my%20id": ("int", ">i4", 7), "colour": ("unsigned_char", "u1", 9), "far": ("vtktypeint64", ">i8", 5)}
    parts = [
        b"# vtk DataFile Version 5.1\nvtk output\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n",
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=">f4").tobytes(),
        b"\nCELLS 2 4\nOFFSETS vtktypeint64\n" + np.array([0, 4], dtype=">i8").tobytes(),
        b"\nCONNECTIVITY vtktypeint64\n" + np.arange(4, dtype=">i8").tobytes(),
        b"\nCELL_TYPES 1\n" + np.array([10], dtype=">i4").tobytes() + b"\nCELL_DATA 1\nFIELD FieldData 3\n",
    ]
    for name, (kind, dtype, value) in numbers.items():
        parts.append(f"{name} 1 1 {kind}\n".encode() + np.array([value], dtype=dtype).tobytes() + b"\n")
    (tmp_path / "a.vtk").write_bytes(b"".join(parts))
    mesh = read(tmp_path / "a.vtk")
    assert {name: values.tolist() for name, values in mesh.cell_data.items()} == {
        "my id": [7],
        "colour": [9],
        "far": [5],
    }


def test_tetgen_regions_and_markers(tmp_path: Path) -> None:
    (tmp_path / "a.node").write_text("4 3 1 1\n1 0 0 0 .5 3\n2 1 0 0 .25 0\n3 0 1 0 .125 0\n4 0 0 1 1 2\n# by hand\n")
    (tmp_path / "a.ele").write_text("1 4 1\n1 1 2 3 4 17\n# by hand\n")
    mesh = read(tmp_path / "a.node")
    assert isinstance(mesh, TetMesh)
    assert mesh.regions.tolist() == [17]
    assert mesh.tag_name == "tetgen:ref"
    assert mesh.point_data["tetgen:ref"].tolist() == [3, 0, 0, 2]
    assert mesh.point_data["tetgen:attr1"].tolist() == [0.5, 0.25, 0.125, 1]


def test_fractions_are_no_tags(tmp_path: Path) -> None:
    """Under the name of tags or as attributes of TetGen's tets they are data."""
    points, tets = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]), [[0, 1, 2, 3], [1, 2, 3, 4]]
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(points, [("tetra", tets)], cell_data={"cell_tags": [[0.5, 1.5]]}))
    (tmp_path / "a.node").write_text("5\t3\n" + "".join(f"{k} {x} {y} {z}\n" for k, (x, y, z) in enumerate(points)))
    (tmp_path / "a.ele").write_text("2 4 2\n0 0 1 2 3 0.5 7\n\n# then\n1 1 2 3 4 1.5 8\n")
    for file, name in (("a.vtu", "cell_tags"), ("a.ele", "tetgen:attr1")):
        assert read(tmp_path / file).cell_data[name].tolist() == [0.5, 1.5]
    assert read(tmp_path / "a.ele").cell_data["tetgen:ref2"].tolist() == [7, 8]


def test_tetgen_faces_beside(tmp_path: Path) -> None:
    """Numbered from 1, with comments, and a row of marker 0 for a triangle that is no facet of the input."""
    (tmp_path / "a.node").write_text("4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n")
    (tmp_path / "a.ele").write_text("1 4 0\n1 1 2 3 4\n")
    (tmp_path / "a.face").write_text("# by hand\n3  1\n1 1 3 2 -5 1 -1\n2 1 2 4 0 1 -1 # no facet\n\n3 2 3 4 6 1 -1\n")
    for suffix in (".node", ".ele"):
        mesh = read(tmp_path / f"a{suffix}")
        assert isinstance(mesh, TetMesh)
        assert mesh.facets.vertices.tolist() == [[0, 2, 1], [1, 2, 3]]
        assert mesh.facets.tags.tolist() == [-5, 6]
        assert mesh.regions.tolist() == [0]


def test_facets_of_an_older_tetgen_file_do_not_stay(full: TetMesh, plain: TetMesh, tmp_path: Path) -> None:
    facets = Cells(full.facets.vertices, full.facets.tags * (full.facets.tags > 7))
    with pytest.warns(WctWarning, match=r"dropped: 16 tagged facets of tag 0$"):
        write(tmp_path / "a.ele", TetMesh(full.points, full.tets, facets=facets))
    assert len(read(tmp_path / "a.ele").facets) == 32  # type: ignore[union-attr]
    write(tmp_path / "a.ele", plain)
    assert_same(read(tmp_path / "a.ele"), plain)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", r"a\.face has no content"),
        ("1 2\n0 0 1 2 3\n", r"a\.face has 2 markers for each facet; allowed are 0 and 1"),
        ("1\n0 0 1 2 3\n", r"a\.face begins with 1; expected 2 numbers, of which the first counts rows"),
        ("garbage\n", r"a\.face has 'garbage' where a whole number should be"),
        ("2 1\n0 0 1 2 3\n", r"a\.face has 1 rows but announces 2"),
        ("1 1\n0 0 1 2\n", r"a\.face has 4 numbers in row 0; expected 5"),
        ("1 1\n0 0 1 99 3\n", r"triangle 0 is \(0, 1, 99\); indices must lie in 0\.\.26"),
    ],
)
def test_damaged_faces_are_refused(content: str, said: str, plain: TetMesh, tmp_path: Path) -> None:
    write(tmp_path / "a.ele", plain)
    (tmp_path / "a.face").write_text(content)
    with pytest.raises(InputError, match=rf"a\.ele: .*{said}"):
        read(tmp_path / "a.ele")


def test_points_and_cells_without_a_tet_are_dropped_and_counted(plain: TetMesh, tmp_path: Path) -> None:
    points = np.vstack([[9.0, 9, 9], plain.points])
    cells = [("vertex", [[0], [1]]), ("tetra", plain.tets + 1)]
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(points, cells))
    mesh = read(tmp_path / "a.vtu")
    assert isinstance(mesh, TetMesh)
    assert (mesh.repairs.orphan_points, mesh.repairs.stray_cells) == (1, 1)
    assert_same(dataclasses.replace(mesh, nodes=plain.nodes), plain)


def test_negative_tets_are_turned_and_counted(plain: TetMesh, tmp_path: Path) -> None:
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(plain.points, [("tetra", plain.tets[:, [1, 0, 2, 3]])]))
    mesh = read(tmp_path / "a.vtu")
    assert isinstance(mesh, TetMesh)
    assert mesh.repairs.flipped == 48


def test_what_a_surface_cannot_hold_is_named(tmp_path: Path) -> None:
    cells = [("triangle", [[0, 1, 2]]), ("line", [[0, 1], [1, 2]]), ("vertex", [[0]])]
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(points, cells))
    with pytest.warns(WctWarning, match=r"a\.vtu: not read: 2 line cells, 1 vertex cells$") as caught:
        read(tmp_path / "a.vtu")
    assert caught[0].filename == __file__


@pytest.mark.parametrize("suffix", [".vtu", ".vtk", ".msh", ".mesh", ".xdmf", ".ply", ".obj", ".med"])
def test_nothing_is_printed(suffix: str, plain: TetMesh, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / f"a{suffix}"
    write(path, plain.boundary_surface())
    read(path)
    path.write_text("garbage")
    with pytest.raises(InputError):
        read(path)
    assert capfd.readouterr() == ("", "")


def test_writing_what_a_format_cannot_carry_is_refused(plain: TetMesh, surface: SurfaceMesh, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"a\.stl: STL cannot carry a tetrahedral mesh; allowed are \.vtu \.vtk"):
        write(tmp_path / "a.stl", plain)
    with pytest.raises(OutputError, match=r"a\.node: TetGen cannot carry a surface; allowed are .* \.off"):
        write(tmp_path / "a.node", surface)
    with pytest.raises(OutputError, match=r"a\.vtx: unknown suffix '\.vtx'; allowed are \.vtu"):
        write(tmp_path / "a.vtx", plain)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(("form", "suffix"), VOLUMES, ids=lambda value: value if isinstance(value, str) else "")
def test_a_full_disk_leaves_the_old_file(form: Any, suffix: str, tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=96k", "tmpfs", disk], capture_output=True).returncode:
        pytest.skip("mounting needs root")
    try:
        (disk / f"part{suffix}").write_text("old")
        (disk / "ballast").write_bytes(bytes(80 * 1024))
        mesh = TetMesh(np.random.default_rng(0).normal(size=(4000, 3)), np.arange(4000).reshape(-1, 4))
        with pytest.raises(OutputError, match=rf"part\{suffix}: cannot be written: "):
            write(disk / f"part{suffix}", mesh)
        assert (disk / f"part{suffix}").read_text() == "old"
        assert set(os.listdir(disk)) == {f"part{suffix}", "ballast"}
    finally:
        subprocess.run(["umount", disk], check=True)
