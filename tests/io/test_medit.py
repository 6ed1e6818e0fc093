"""Medit's files as mmg, gmsh, FreeFem and others write them: counts decide, and what mmg says must stay has names."""

import warnings
from pathlib import Path

import gmsh
import meshio
import numpy as np
import pytest
from support.builders import jittered_cube, two_region_cube
from support.gmsh_session import gmsh_session

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import read, write
from wct_plugin.mesh import Cells, TetMesh

HEAD = "MeshVersionFormatted 2\nDimension 3\n"
POINTS = "Vertices\n5\n0 0 0 1\n1 0 0 2\n0 1 0 0\n0 0 1 0\n1 1 1 0\n"
TETS = "Tetrahedra\n2\n1 2 3 4 7\n2 5 3 4 8\n"


def mesh_of(path: Path, text: str) -> TetMesh:
    path.write_text(text)
    mesh = read(path)
    assert isinstance(mesh, TetMesh)
    return mesh


@pytest.mark.parametrize(
    "text",
    [
        HEAD + POINTS + TETS,
        HEAD + POINTS + TETS + "End\n",
        HEAD + POINTS + TETS + "END",
        HEAD + POINTS + TETS + "end\n\n\n",
        HEAD + TETS + POINTS,
        "MeshVersionFormatted 1\n\nDimension\n3\n\n" + POINTS + TETS,
        "MeshVersionFormatted 3 Dimension 3 " + POINTS.replace("\n", " ") + "\n" + TETS,
        "# made by hand\nMeshVersionFormatted\n4\nDimension 3 # three\n" + POINTS + "# tets\n" + TETS,
        (" " + HEAD + POINTS + TETS).replace("\n", "\n "),
        (HEAD + POINTS + TETS).replace("\n", "\r\n"),
        HEAD + POINTS.replace("1 0 0 2", "1.0D+00 0.D0 0 2") + TETS,
        HEAD.replace("Dimension", "DIMENSION") + POINTS.upper() + TETS.lower(),
    ],
)
def test_whole_files_are_read_whatever_their_form(text: str, tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path / "a.mesh", text)
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]
    assert mesh.tets.tolist() == [[0, 1, 2, 3], [1, 4, 2, 3]]
    assert mesh.regions.tolist() == [7, 8]
    assert mesh.point_data["medit:ref"].tolist() == [1, 2, 0, 0, 0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (HEAD + POINTS.replace("5\n", "6\n", 1) + TETS,
         "section 'Vertices' announces 6 entries of 4 numbers each, 24 in all; found 20"),
        (HEAD + POINTS + TETS.replace("2\n", "1\n", 1),
         "section 'Tetrahedra' announces 1 entries of 5 numbers each, 5 in all; found 10"),
        (HEAD + POINTS + TETS[:-2], "section 'Tetrahedra' announces 2 entries of 5 numbers each, 10 in all; found 9"),
        (HEAD + POINTS + TETS.replace("5 3", "x 3"), "section 'Tetrahedra' has 'x' where a whole number should be"),
        (HEAD + POINTS + TETS + TETS, "has section 'Tetrahedra' twice"),
        (HEAD + TETS, "has no section 'Vertices'"),
        (POINTS + TETS, "begins with 'Vertices'; expected 'MeshVersionFormatted'"),
        ("MeshVersionFormatted 9\n" + POINTS, "is of version 9; allowed are 1, 2, 3 and 4"),
        ("MeshVersionFormatted 2\n" + POINTS, "has no 'Dimension' before its 'Vertices'"),
        (HEAD + POINTS + TETS + "Corners\n1\n9\n", "section 'Corners' names vertex 9; allowed are 1 to 5"),
        (HEAD + POINTS + TETS + "Ridges\n1\n1\n", "section 'Ridges' names edge 1; there are none"),
        ("MFEM mesh v1.0\n\ndimension\n3\n\nelements\n1\n1 4 0 1 2 3\n", "is a mesh of MFEM, not of Medit; MFEM's "
         "Mesh::PrintVTU writes it as .vtu, which is read"),
    ],
)  # fmt: skip
def test_refusals_name_section_found_and_announced(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "a.mesh").write_text(text)
    with pytest.raises(InputError) as caught:
        read(tmp_path / "a.mesh")
    assert str(caught.value) == f"{tmp_path / 'a.mesh'}: cannot be read as Medit: {said}"


MMG = (
    "Triangles\n2\n1 2 3 5\n1 2 4 6\nEdges\n3\n1 2 1\n2 3 0\n1 3 0\nCorners\n2\n1\n4\nRequiredVertices\n1\n2\n"
    "Ridges\n2\n1\n2\nRequiredEdges\n1\n3\nRequiredTriangles\n1\n2\n"
)


def test_what_mmg_says_must_stay_are_sets(tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path / "a.mesh", HEAD + POINTS + TETS + MMG)
    assert mesh.nodes.vertices.ravel().tolist() == [0, 1, 3]
    assert {name: rows.tolist() for name, rows in mesh.nodes.sets.items()} == {
        "Corners": [0, 2],
        "RequiredVertices": [1],
    }
    assert {name: rows.tolist() for name, rows in mesh.edges.sets.items()} == {"Ridges": [0, 1], "RequiredEdges": [2]}
    assert {name: rows.tolist() for name, rows in mesh.facets.sets.items()} == {"RequiredTriangles": [1]}
    assert mesh.edges.tags.tolist() == [1, 0, 0]
    assert mesh.facets.tags.tolist() == [5, 6]


def test_sections_that_are_not_read_are_named_with_their_counts(tmp_path: Path) -> None:
    more = (
        "Normals\n2\n0 0 1\n1 0 0\nNormalAtVertices\n1\n1 1\nSubDomainFromGeom\n1\n3 1 1 1\nRequiredTetrahedra\n1\n2\n"
        "AngleOfCornerBound 40\n"
    )
    said = (
        "not read: section 'Normals' of 2 entries, section 'NormalAtVertices' of 1 entry, "
        "section 'SubDomainFromGeom' of 1 entry, section 'RequiredTetrahedra' of 1 entry, section 'AngleOfCornerBound'"
    )
    with pytest.warns(WctWarning, match=said):
        mesh = mesh_of(tmp_path / "a.mesh", HEAD + POINTS + more + TETS)
    assert len(mesh.tets) == 2


def same_everything(one: TetMesh, other: TetMesh) -> None:
    assert np.array_equal(one.points, other.points)
    assert np.array_equal(one.tets, other.tets)
    assert np.array_equal(one.regions, other.regions)
    for cells, others in zip((one.facets, one.edges, one.nodes), (other.facets, other.edges, other.nodes), strict=True):
        assert np.array_equal(cells.vertices, others.vertices)
        assert np.array_equal(cells.tags, others.tags)
        assert {name: rows.tolist() for name, rows in cells.sets.items()} == {
            name: rows.tolist() for name, rows in others.sets.items()
        }


@pytest.mark.parametrize("suffix", [".mesh", ".meshb"])
def test_what_must_stay_is_written_as_the_same_sections(suffix: str, tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path / "a.mesh", HEAD + POINTS + TETS + MMG)
    write(tmp_path / f"b{suffix}", mesh)
    again = read(tmp_path / f"b{suffix}")
    assert isinstance(again, TetMesh)
    same_everything(again, mesh)
    assert again.point_data["medit:ref"].tolist() == [1, 2, 0, 0, 0]
    if suffix == ".mesh":
        text = (tmp_path / "b.mesh").read_text()
        for section in (
            "Corners\n2\n1\n4\n",
            "RequiredVertices\n1\n2\n",
            "RequiredTriangles\n1\n2\n",
            "RequiredEdges\n1\n3\n",
        ):
            assert section in text


def test_vertices_of_which_nothing_is_said_and_other_sets_are_named_as_lost(tmp_path: Path) -> None:
    mesh = jittered_cube(2)
    nodes = Cells([[0], [1], [2]], [4, 0, 0], {}, {"Corners": [1], "mine": [0]})
    mesh = TetMesh(mesh.points, mesh.tets, nodes=nodes)
    with pytest.warns(WctWarning, match="dropped: 2 tagged vertices, tags of tagged vertices, set 'mine' of vertices"):
        write(tmp_path / "a.mesh", mesh)
    again = read(tmp_path / "a.mesh")
    assert isinstance(again, TetMesh)
    assert again.nodes.vertices.tolist() == [[1]]


def by_hand(version: int, order: str, mesh: TetMesh) -> bytes:
    """A binary file of a version and byte order, with a section that nobody knows, as libMeshb lays it out."""
    whole, real, place = {1: ("i4", "f4", "i4"), 2: ("i4", "f8", "i4"), 3: ("i4", "f8", "i8"), 4: ("i8", "f8", "i8")}[
        version
    ]
    data = np.array([1, version], f"{order}i4").tobytes()

    def section(code: int, *parts: np.ndarray) -> None:
        nonlocal data
        body = b"".join(np.ascontiguousarray(part).tobytes() for part in parts)
        following = len(data) + 4 + np.dtype(place).itemsize + len(body)
        data += np.array(code, f"{order}i4").tobytes() + np.array(following, f"{order}{place}").tobytes() + body

    count = np.array
    section(3, count(3, f"{order}i4"))
    vertices = np.empty(len(mesh.points), [("x", f"{order}{real}", 3), ("r", f"{order}{whole}")])
    vertices["x"], vertices["r"] = mesh.points, np.arange(len(mesh.points))
    section(4, count(len(vertices), f"{order}{whole}"), vertices)
    section(77, count(1, f"{order}{whole}"), count([1, 2, 3], f"{order}{whole}"))
    section(60, count(1, f"{order}{whole}"), count([0, 0, 1], f"{order}{real}"))
    rows = np.column_stack([mesh.tets + 1, mesh.regions]).astype(f"{order}{whole}")
    section(8, count(len(rows), f"{order}{whole}"), rows)
    section(13, count(1, f"{order}{whole}"), count([3], f"{order}{whole}"))
    return data + np.array(54, f"{order}i4").tobytes() + np.array(0, f"{order}{place}").tobytes()


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("version", [1, 2, 3, 4])
def test_binary_files_of_every_version(version: int, order: str, tmp_path: Path) -> None:
    mesh = two_region_cube(2)
    data = by_hand(version, order, mesh)
    (tmp_path / "a.meshb").write_bytes(data)
    with pytest.warns(WctWarning, match=r"not read: section 'keyword 77' of 1 entry, section 'Normals' of 1 entry$"):
        again = read(tmp_path / "a.meshb")
    assert isinstance(again, TetMesh)
    assert np.array_equal(again.points, mesh.points)
    assert np.array_equal(again.tets, mesh.tets)
    assert np.array_equal(again.regions, mesh.regions)
    assert again.nodes.vertices.tolist() == [[2]]
    (tmp_path / "a.meshb").write_bytes(data[: len(data) // 2])
    with pytest.raises(InputError, match="cannot be read as Medit: "):
        read(tmp_path / "a.meshb")


@pytest.mark.parametrize("suffix", [".mesh", ".meshb"])
def test_meshio_reads_ours_and_we_what_meshio_writes(suffix: str, tmp_path: Path) -> None:
    mesh = two_region_cube(2)
    write(tmp_path / f"a{suffix}", mesh)
    judge = meshio.read(tmp_path / f"a{suffix}")
    assert np.array_equal(judge.points, mesh.points)
    assert np.array_equal(judge.cells_dict["tetra"], mesh.tets)
    assert np.array_equal(judge.cell_data_dict["medit:ref"]["tetra"], mesh.regions)
    judge.cell_data["medit:ref"] = [np.asarray(column, dtype=np.int64) for column in judge.cell_data["medit:ref"]]
    judge.write(tmp_path / f"b{suffix}")
    again = read(tmp_path / f"b{suffix}")
    assert isinstance(again, TetMesh)
    assert np.array_equal(again.tets, mesh.tets)
    assert np.array_equal(again.regions, mesh.regions)


def test_gmsh_reads_what_must_stay(tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path / "a.mesh", HEAD + POINTS + TETS + MMG)
    write(tmp_path / "b.mesh", mesh)
    with gmsh_session():
        gmsh.open(str(tmp_path / "b.mesh"))
        assert len(gmsh.model.mesh.getElements(3)[1][0]) == 2
        assert len(gmsh.model.mesh.getElements(2)[1][0]) + len(gmsh.model.mesh.getElements(1)[1][0]) > 2


def test_a_plane_mesh_and_other_cells_go_on_as_they_are(tmp_path: Path) -> None:
    from wct_plugin.io import medit

    (tmp_path / "a.mesh").write_text(
        "MeshVersionFormatted 2\nDimension 2\nVertices\n4\n0 0 1\n1 0 1\n0 1 1\n1 1 2\nTriangles\n1\n1 2 3 4\n"
        "Quadrilaterals\n1\n1 2 4 3 9\n"
    )
    raw, lost = medit.read(tmp_path / "a.mesh")
    assert raw.points.tolist() == [[0, 0], [1, 0], [0, 1], [1, 1]]
    assert [(block.type, block.data.tolist()) for block in raw.cells] == [
        ("triangle", [[0, 1, 2]]),
        ("quad", [[0, 1, 3, 2]]),
    ]
    assert [column.tolist() for column in raw.cell_data["medit:ref"] if column is not None] == [[4], [9]]
    assert lost == []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        kinds = {
            "Prisms": ("wedge", 6),
            "Hexahedra": ("hexahedron", 8),
            "Pyramids": ("pyramid", 5),
            "TetrahedraP2": ("tetra10", 10),
        }
        for name, (kind, corners) in kinds.items():
            row = " ".join(str(k) for k in range(1, corners + 1))
            points = "".join(f"{k} 0 0 0\n" for k in range(corners))
            (tmp_path / "b.mesh").write_text(f"{HEAD}Vertices\n{corners}\n{points}{name}\n1\n{row} 3\n")
            raw, _ = medit.read(tmp_path / "b.mesh")
            assert [(block.type, block.data.tolist()) for block in raw.cells] == [(kind, [list(range(corners))])]
