"""gmsh's files of all versions, written by gmsh itself, and by hand where it does not write them."""

from collections.abc import Iterator
from pathlib import Path

import gmsh
import meshio
import numpy as np
import pytest
from support.builders import two_region_cube
from support.gmsh_session import add_two_boxes, gmsh_session
from support.volumes import tet_volumes

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import gmsh_reader, gmsh_v2, read, write
from wct_plugin.io.gmsh_file import GmshFile
from wct_plugin.io.number_streams import BinaryNumbers
from wct_plugin.mesh import Cells, TetMesh

GROUPS = {
    "steel": (3, 11, [1]),
    "air": (3, 12, [2]),
    "all": (3, 13, [1, 2]),
    "inlet": (2, 7, [1]),
    "turned": (2, 8, [-3]),
    "edge": (1, 5, [2]),
    "probe": (0, 3, [1]),
}
NAMES = {name: (tag, dimension) for name, (dimension, tag, _) in GROUPS.items()}


@pytest.fixture(scope="module", autouse=True)
def _session() -> Iterator[None]:
    """Two boxes that share a face; the second is a body of a group by itself and of one with the first."""
    with gmsh_session():
        add_two_boxes(2)
        for name, (dimension, tag, entities) in GROUPS.items():
            gmsh.model.addPhysicalGroup(dimension, entities, tag, name)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
        gmsh.model.mesh.generate(3)
        yield


def written(path: Path, version: float, binary: int, **options: float) -> TetMesh:
    for name, value in {"MshFileVersion": version, "Binary": binary, "SaveParametric": 0, **options}.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)
    gmsh.write(str(path))
    mesh = read(path)
    assert isinstance(mesh, TetMesh)
    return mesh


def check(mesh: TetMesh, *, names: bool = True) -> None:
    """Regions, groups and what is in several, with their sizes."""
    size = tet_volumes(mesh)
    assert size[mesh.regions == 11].sum() == pytest.approx(1.0, rel=1e-12)
    assert size[mesh.regions == 12].sum() == pytest.approx(2.0, rel=1e-12)
    assert (size > 0).all()
    everything = mesh.tet_sets["all" if names else "13"]
    assert len(everything) == len(mesh.tets)
    corners = mesh.points[mesh.facets.vertices]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert areas[mesh.facets.tags == 7].sum() == pytest.approx(1.0, rel=1e-12)
    assert areas[mesh.facets.tags == 8].sum() == pytest.approx(1.0, rel=1e-12)
    assert np.ptp(mesh.points[mesh.edges.vertices[mesh.edges.tags == 5]], axis=(0, 1)).tolist() == [0, 1, 0]
    assert mesh.nodes.tags.tolist() == [3]
    assert dict(mesh.names) == (NAMES if names else {})


CASES = [
    (1.0, 0, 0),
    *((version, binary, parametric) for version in (2.2, 4.1) for binary in (0, 1) for parametric in (0, 1)),
]


@pytest.mark.parametrize(("version", "binary", "parametric"), [*CASES, (4.0, 0, 0), (4.0, 0, 1)])
def test_versions_encodings_and_parametric_nodes(version: float, binary: int, parametric: int, tmp_path: Path) -> None:
    mesh = written(tmp_path / "a.msh", version, binary, SaveParametric=parametric)
    check(mesh, names=version > 1)
    again = written(tmp_path / "b.msh", 4.1, 0)
    assert np.allclose(mesh.points, again.points, rtol=0, atol=1e-15)  # text has 16 digits


@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("topology", [0, 1])
def test_partitions_are_put_together(topology: int, version: float, binary: int, tmp_path: Path) -> None:
    gmsh.option.setNumber("Mesh.PartitionCreateTopology", topology)
    gmsh.model.mesh.partition(3)
    try:
        with pytest.warns(WctWarning, match="not read: partitions$"):
            mesh = written(tmp_path / "a.msh", version, binary)
    finally:
        gmsh.model.mesh.unpartition()
    whole = written(tmp_path / "b.msh", version, binary)
    check(mesh)
    assert len(mesh.tets) == len(whole.tets)
    assert len(mesh.facets) == len(whole.facets)  # none between partitions
    assert tet_volumes(mesh).sum() == pytest.approx(3.0, rel=1e-12)


def test_version_4_0_in_binary(tmp_path: Path) -> None:
    """As meshio writes it; gmsh writes it as text only."""
    cube = two_region_cube(2)
    meshio.write(tmp_path / "a.msh", meshio.Mesh(cube.points, [("tetra", cube.tets)]), file_format="gmsh")
    from meshio.gmsh import _gmsh40

    _gmsh40.write(tmp_path / "a.msh", meshio.Mesh(cube.points, [("tetra", cube.tets)]), binary=True)
    mesh = read(tmp_path / "a.msh")
    assert isinstance(mesh, TetMesh)
    assert np.array_equal(mesh.points, cube.points)
    assert np.array_equal(mesh.tets, cube.tets)


def test_second_order_cells_are_in_vtk_s_order(tmp_path: Path) -> None:
    gmsh.model.mesh.setOrder(2)
    try:
        for version in (2.2, 4.1):
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", 0)
            gmsh.write(str(tmp_path / "a.msh"))
            raw, _ = gmsh_reader.read(tmp_path / "a.msh")
            kinds = {block.type: block.data for block in raw.cells}
            assert {"vertex", "line3", "triangle6", "tetra10"} == kinds.keys()
            tets = raw.points[kinds["tetra10"]]
            ends = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
            for k, (i, j) in enumerate(ends, start=4):
                assert np.allclose(tets[:, k], (tets[:, i] + tets[:, j]) / 2, atol=1e-12)
    finally:
        gmsh.model.mesh.setOrder(1)


TEXT = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
3 7 "a "quoted" Körper"
$EndPhysicalNames
$Nodes
5
10 0 0 0
20 1 0 0
4000000000 0 1 0
40 0 0 1
50 1 1 1
$EndNodes
$Elements
4
1 15 2 0 1 10
2 4 2 7 1 10 20 4000000000 40
3 2 0 10 20 40
9 4 3 7 1 0 20 50 4000000000 40
$EndElements
"""


def mesh_of(folder: Path, text: str) -> TetMesh:
    (folder / "a.msh").write_text(text)
    mesh = read(folder / "a.msh")
    assert isinstance(mesh, TetMesh)
    return mesh


def test_sparse_numbers_mixed_kinds_and_any_number_of_tags(tmp_path: Path) -> None:
    for text in (
        TEXT,
        TEXT.replace("\n", "\r\n"),
        TEXT.replace("$Nodes", "\n\n$Comments\n5 $ 3\n$EndComments\n $Nodes"),
    ):
        mesh = mesh_of(tmp_path, text)
        assert mesh.tets.tolist() == [[0, 1, 2, 3], [1, 4, 2, 3]]
        assert mesh.facets.vertices.tolist() == [[0, 1, 3]]
        assert dict(mesh.names) == {'a "quoted" Körper': (7, 3)}


def test_data_go_by_the_numbers_of_their_elements(tmp_path: Path) -> None:
    data = '$ElementData\n1\n"heat"\n1\n0.0\n3\n0\n1\n2\n9 5.5\n2 4.5\n$EndElementData\n'
    data += '$NodeData\n1\n"u"\n1\n0.0\n3\n0\n1\n2\n50 1.5\n10 2.5\n$EndNodeData\n'
    mesh = mesh_of(tmp_path, TEXT + data)
    assert mesh.cell_data["heat"].tolist() == [4.5, 5.5]
    assert np.array_equal(mesh.point_data["u"], [2.5, np.nan, np.nan, np.nan, 1.5], equal_nan=True)
    later = data.replace("0.0", "1.0").replace("5.5", "6.5").split("$NodeData")[0]
    with pytest.warns(WctWarning, match="not read: earlier steps of the data 'heat'"):
        assert mesh_of(tmp_path, TEXT + data + later).cell_data["heat"].tolist() == [4.5, 6.5]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("$EndNodes\n", "", "section $Nodes is not closed by $EndNodes"),
        ("5\n10 0", "6\n10 0", "section $Nodes announces 6 rows of 4 numbers, 24; 20 are left"),
        ("5\n10 0", "4\n10 0", "section $Nodes has 4 numbers more than it announces"),
        ("4\n1 15", "5\n1 15", "section $Elements announces 5 elements and has 4"),
        ("20 50", "20 51", "has no node 51, which an element names"),
        ("2 4 2 7", "2 99 2 7", "section $Elements has elements of type 99, which is none of gmsh's that are known"),
        ("50 1 1 1", "40 1 1 1", "has 5 nodes with only 4 different numbers"),
        ("2.2 0 8", "3.0 0 8", "is of version 3.0; allowed are 1, 2.0 to 2.2, 4.0 and 4.1"),
        ("$PhysicalNames\n1", "$PhysicalNames\n2", "section $PhysicalNames announces 2 names and has 1"),
        ("$Elements\n", "nonsense\n$Elements\n", "has 'nonsense' where a section should begin"),
        ("1 1 1\n", "1 1 x\n", "section $Nodes has 'x' where a number should be"),
    ],
)  # fmt: skip
def test_refusals(old: str, new: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "a.msh").write_text(TEXT.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        read(tmp_path / "a.msh")
    assert str(caught.value) == f"{tmp_path / 'a.msh'}: cannot be read as gmsh: {said}"


def test_sections_that_are_not_read_are_named(tmp_path: Path) -> None:
    with pytest.warns(WctWarning, match=r"not read: section \$InterpolationScheme$"):
        mesh_of(tmp_path, TEXT + "$InterpolationScheme\n1\n$EndInterpolationScheme\n")


def test_alternating_kinds_of_elements(tmp_path: Path) -> None:
    """Rows of different lengths one after the other, as some programs write them."""
    cube = two_region_cube(3)
    boundary = cube.topology.boundary
    nodes = "".join(f"{k} {x!r} {y!r} {z!r}\n" for k, (x, y, z) in enumerate(cube.points.tolist(), start=1))
    rows = [
        f"4 2 {tag} 1 " + " ".join(map(str, tet))
        for tag, tet in zip(cube.regions.tolist(), (cube.tets + 1).tolist(), strict=True)
    ]
    facets = ["2 2 5 1 " + " ".join(map(str, facet)) for facet in (boundary + 1).tolist()]
    mixed = [row for pair in zip(rows, facets, strict=False) for row in pair] + rows[len(facets) :]
    elements = "".join(f"{k} {row}\n" for k, row in enumerate(mixed, start=1))
    mesh = mesh_of(
        tmp_path,
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(cube.points)}\n{nodes}$EndNodes\n"
        f"$Elements\n{len(mixed)}\n{elements}$EndElements\n",
    )
    assert np.array_equal(mesh.tets, cube.tets)
    assert np.array_equal(mesh.regions, cube.regions)
    assert np.array_equal(mesh.facets.vertices, boundary)


def test_groups_of_files_we_write_come_back(tmp_path: Path) -> None:
    cube = two_region_cube(2)
    facets = Cells(cube.topology.boundary, None, {}, {"inlet": np.arange(4)})
    mesh = TetMesh(
        cube.points,
        cube.tets,
        cube.regions,
        facets,
        tet_sets={"core": [0, 1]},
        names={"core": (77, 3), "inlet": (78, 2)},
    )
    for binary in (False, True):
        write(tmp_path / "a.msh", mesh, version="4.1", binary=binary)
        again = read(tmp_path / "a.msh")
        assert isinstance(again, TetMesh)
        assert len(again.tet_sets["core"]) == 2
        assert dict(again.names) == dict(mesh.names)


def test_a_header_before_each_element_is_read_in_bulk() -> None:
    """As gmsh writes version 2 in binary: what is alike is one table, or a million tets would take hours."""
    tets = np.arange(1, 2001)[:, None] + [0, 1, 2, 3]
    ids = np.arange(2000)
    solid = np.column_stack([np.tile([4, 1, 2], (2000, 1)), ids, ids % 2, ids % 2, tets])
    triangles = np.column_stack([np.tile([2, 1, 1], (500, 1)), np.arange(500), np.ones(500), tets[:500, :3]])
    data = b"".join(np.ascontiguousarray(part, dtype="<i4").tobytes() for part in (solid, triangles)) + b"\n$End"
    found = list(gmsh_v2._blocks(BinaryNumbers(data, 0, "<"), 2500, GmshFile()))
    assert [(one.type, len(one.ids)) for one in found] == [(4, 2000), (2, 500)]
    assert np.array_equal(found[0].nodes, tets)
    assert np.array_equal(found[0].groups, np.arange(2000) % 2)
    with pytest.raises(InputError, match="announces"):
        list(gmsh_v2._blocks(BinaryNumbers(data[:-2100], 0, "<"), 2500, GmshFile()))
