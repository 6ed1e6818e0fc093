"""Tets with mid nodes: read by their corners, written with nodes on the edges, as gmsh, VTK and meshio have them."""

import warnings
from dataclasses import replace
from pathlib import Path

import gmsh
import meshio
import numpy as np
import pytest
from support.builders import jittered_cube, two_region_cube
from support.gmsh_session import gmsh_session
from support.second_order import EDGES, cylinder, made, tens, volumes
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOLegacy import vtkUnstructuredGridReader
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from wct_plugin.errors import InputError, OptionError, OutputError, WctWarning
from wct_plugin.io import read, write
from wct_plugin.io.formats import FORMATS
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.mid_nodes import find_middles

SUFFIXES = [form.suffixes[0] for form in FORMATS if form.second_order]
pytestmark = pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")


@pytest.fixture(scope="module")
def curved(tmp_path_factory) -> Path:
    return made(tmp_path_factory.mktemp("curved") / "cylinder.msh", cylinder, 0.4)


def tagged() -> TetMesh:
    mesh = two_region_cube(2)
    facets = mesh.topology.boundary
    edges = Cells(facets[:4, :2], np.arange(1, 5))
    point_data = {"u": mesh.points[:, 0].copy()}
    return replace(mesh, facets=Cells(facets, 1 + np.arange(len(facets)) % 3), edges=edges, point_data=point_data)


def are_half_way(nodes) -> bool:
    return all(np.allclose(nodes[:, 4 + k], nodes[:, [i, j]].mean(axis=1), atol=1e-9) for k, (i, j) in enumerate(EDGES))


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_straight_mid_nodes_come_and_go(suffix, tmp_path):
    mesh = tagged()
    with pytest.warns(WctWarning, match=r"written with \d+ mid nodes \(order=1 leaves them out\)"):
        write(tmp_path / f"a{suffix}", mesh, order=2)
    # Meshio's own reader fails on mixed XDMF of second order.
    raw = meshio.read(tmp_path / f"a{suffix}") if suffix not in (".inp", ".xdmf") else None
    if raw:
        kinds = {block.type for block in raw.cells}
        assert {"tetra10", "triangle6"} <= kinds
        assert not kinds & {"tetra", "triangle", *(["line"] if suffix != ".bdf" else [])}
        assert len(raw.points) == len(mesh.points) + len(mesh.topology.edges)
        assert are_half_way(tens(raw))
    back = read(tmp_path / f"a{suffix}")
    assert len(back.points) == len(mesh.points)
    assert np.allclose(back.points, mesh.points, atol=1e-9)
    assert np.array_equal(np.sort(back.tets), np.sort(mesh.tets))
    assert back.regions.tolist() == mesh.regions.tolist()
    assert np.array_equal(np.sort(back.facets.vertices), np.sort(mesh.facets.vertices))
    assert back.facets.tags.tolist() == mesh.facets.tags.tolist()
    assert back.edges.tags.tolist() == mesh.edges.tags.tolist()
    assert not len(back.second_order.ends)
    # And again without being asked, as it came.
    write(tmp_path / f"b{suffix}", back)
    assert read(tmp_path / f"b{suffix}").second_order is not None
    write(tmp_path / f"c{suffix}", back, order=1)
    assert read(tmp_path / f"c{suffix}").second_order is None


def test_point_data_and_sets_have_values_between(tmp_path):
    mesh = tagged()
    side = np.flatnonzero(mesh.points[:, 0] == 0)
    mesh = replace(mesh, point_data={**mesh.point_data, "n": np.ones(len(mesh.points), int)}, point_sets={"side": side})
    write(tmp_path / "a.vtu", mesh, order=2)
    raw = meshio.read(tmp_path / "a.vtu")
    assert np.allclose(raw.point_data["u"], raw.points[:, 0], atol=1e-15)
    assert (raw.point_data["n"] == 1).all()
    assert np.array_equal(raw.point_data["set:side"] == 1, raw.points[:, 0] == 0)


@pytest.mark.parametrize("suffix", [".vtu", ".vtk"])
def test_vtk_has_them_on_its_edges(suffix, tmp_path):
    write(tmp_path / f"a{suffix}", tagged(), order=2)
    reader = vtkXMLUnstructuredGridReader() if suffix == ".vtu" else vtkUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / f"a{suffix}"))
    reader.Update()
    grid = reader.GetOutput()
    points = vtk_to_numpy(grid.GetPoints().GetData())
    seen = 0
    for k in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(k)
        for edge in map(cell.GetEdge, range(cell.GetNumberOfEdges())):
            one, other, middle = (edge.GetPointId(j) for j in range(3))
            assert np.allclose(points[middle], 0.5 * (points[one] + points[other]), atol=1e-12)
            seen += 1
    assert seen == 432


@pytest.mark.parametrize("suffix", [".msh", ".med", ".bdf"])
def test_gmsh_has_them_on_its_edges(suffix, tmp_path):
    mesh = tagged()
    write(tmp_path / f"a{suffix}", mesh, order=2)
    with gmsh_session():
        gmsh.open(str(tmp_path / f"a{suffix}"))
        tags, nodes = gmsh.model.mesh.getElementsByType(11)
        assert len(tags) == len(mesh.tets)
        at = gmsh.model.mesh.getElementProperties(11)[4].reshape(-1, 3)
        ids, xyz, _ = gmsh.model.mesh.getNodes()
        points = np.zeros((int(ids.max()) + 1, 3))
        points[ids] = xyz.reshape(-1, 3)
        cells = points[nodes.reshape(-1, 10)]
        straight = np.column_stack([1 - at.sum(axis=1), at]) @ cells[:, :4]
        assert np.allclose(cells, straight, atol=1e-7)
        assert (gmsh.model.mesh.getElementQualities(tags, "minDetJac") > 0).all()


@pytest.mark.parametrize("suffix", [".vtu", ".vtk", ".msh", ".med"])
def test_curved_mid_nodes_come_back_as_they_were(suffix, curved, tmp_path):
    given, least = volumes(tens(meshio.read(curved)))
    mesh = read(curved)
    assert mesh.second_order.curved
    assert mesh.reference.diagonal == pytest.approx(np.sqrt(3), abs=1e-3)
    write(tmp_path / f"a{suffix}", mesh)
    nodes = tens(meshio.read(tmp_path / f"a{suffix}"))
    if suffix == ".med":  # whose tets are mirrored: first face from outside
        nodes = nodes[:, [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    found, again = volumes(nodes)
    assert found.sum() == pytest.approx(given.sum(), rel=1e-12)
    assert again == pytest.approx(least, rel=1e-9)
    back = read(tmp_path / f"a{suffix}")
    assert len(back.second_order.ends) == len(mesh.second_order.ends)
    assert back.second_order.facets.shape == mesh.second_order.facets.shape


def test_the_unit_of_length_is_no_matter(curved, tmp_path):
    raw = meshio.read(curved)
    raw.points *= 1e-9
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(raw.points, raw.cells))
    assert len(read(tmp_path / "a.vtu").second_order.ends) == len(read(curved).second_order.ends)


def test_rounded_files_are_straight(tmp_path):
    mesh = jittered_cube(3)
    write(tmp_path / "a.vtu", mesh, order=2)
    raw = meshio.read(tmp_path / "a.vtu")
    for digits, kind in ((5, np.float64), (4, np.float64), (17, np.float32)):
        points = np.round(raw.points, digits).astype(kind)
        meshio.vtu.write(tmp_path / "b.vtu", meshio.Mesh(points, raw.cells))
        assert not len(read(tmp_path / "b.vtu").second_order.ends)


def test_new_edges_on_a_curved_surface_get_nodes_on_it(curved):
    mesh = read(curved)
    # A mesh with other edges: every vertex of the round side turned by half an edge's angle.
    radius = np.hypot(mesh.points[:, 0], mesh.points[:, 1])
    side = np.isclose(radius, 0.5)
    points = np.array(mesh.points)
    turn = np.radians(3.0)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    points[:, :2] = points[:, :2] @ rotation
    moved = replace(mesh, points=points)
    found = find_middles(moved)
    ends = moved.points[moved.topology.edges]
    around = side[moved.topology.edges].all(axis=1) & moved.topology.boundary_points[moved.topology.edges].all(axis=1)
    off = np.linalg.norm(found.points - ends.mean(axis=1), axis=1)
    on = around & (off > 1e-6)
    assert on.sum() > 20
    assert np.abs(np.hypot(found.points[on, 0], found.points[on, 1]) - 0.5).max() < 2e-3
    assert found.curved > 0
    flat_top = np.isclose(ends[:, :, 2], 1.0).all(axis=1)
    assert np.allclose(found.points[flat_top, 2], 1.0, atol=1e-12)


def test_where_a_tet_would_fold_edges_are_straight(tmp_path):
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
    cells = [[0, 1, 2, 3], [1, 4, 2, 3]]
    nodes, rows = [*points], []
    at: dict[tuple[int, int], int] = {}
    for cell in cells:
        for i, j in EDGES:
            edge = tuple(sorted((cell[i], cell[j])))
            if edge not in at:
                at[edge] = len(nodes)
                nodes.append(points[list(edge)].mean(axis=0))
        rows.append(cell + [at[tuple(sorted((cell[i], cell[j])))] for i, j in EDGES])
    nodes[at[0, 1]] = np.array([0.5, 0.4, 0.4])  # into the tet, past where it folds
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(np.array(nodes), [("tetra10", rows)]))
    mesh = read(tmp_path / "a.vtu")
    assert len(mesh.second_order.folded) == 1
    assert find_middles(mesh).kept == 1  # as it came
    other = replace(mesh, points=mesh.points + np.array([[0], [0], [0], [1e-3], [0]]))  # other tets with that edge
    found = find_middles(other)
    assert found.kept == 0
    assert found.straightened > 0
    assert f"{found.straightened} are half way, as a tet might fold there" in found.describe(10)


def test_orders_that_cannot_be(tmp_path):
    mesh = jittered_cube(2)
    with pytest.raises(OutputError, match=r"a.mesh: Medit cannot carry cells of order 2; allowed are \.vtu \.vtk"):
        write(tmp_path / "a.mesh", mesh, order=2)
    with pytest.raises(OptionError, match="option 'order' is 3; allowed are 1 and 2"):
        write(tmp_path / "a.vtu", mesh, order=3)
    with pytest.raises(OptionError, match="a surface has order 1"):
        write(tmp_path / "a.vtu", mesh.boundary_surface(), order=2)
    assert not list(tmp_path.iterdir())


def test_formats_without_them_say_so(tmp_path):
    write(tmp_path / "a.vtu", jittered_cube(2), order=2)
    with pytest.warns(WctWarning, match=r"SU2 cannot carry, so dropped: mid nodes of edges"):
        write(tmp_path / "a.su2", read(tmp_path / "a.vtu"))


@pytest.mark.parametrize("kind", ["triangle6", "tetra20", "line3"])
def test_corners_of_other_orders_are_taken(kind, tmp_path):
    corners = {"triangle6": [0, 1, 2], "line3": [0, 1], "tetra20": [0, 1, 2, 3]}[kind]
    points = np.random.default_rng(0).random((24, 3))
    points[:4] = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    count = meshio._common.num_nodes_per_cell[kind]
    cells = [(kind, [[*corners, *range(4, 4 + count - len(corners))]])]
    if kind != "tetra20":
        cells.insert(0, ("tetra", [[0, 1, 2, 3]]))
    tags = {name: [np.array([5])] * len(cells) for name in ("gmsh:physical", "gmsh:geometrical")}
    meshio.gmsh.write(tmp_path / "a.msh", meshio.Mesh(points, cells, cell_data=tags), fmt_version="2.2", binary=False)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mesh = read(tmp_path / "a.msh")
    assert any(f"of 1 {kind} cells the corners alone are taken" in str(one.message) for one in caught)
    assert mesh.tets.tolist() == [[0, 1, 2, 3]]
    assert [len(cells) for cells in (mesh.facets, mesh.edges)] == [kind == "triangle6", kind == "line3"]


def test_a_broken_tet_with_mid_nodes_is_refused_by_its_corners(tmp_path):
    write(tmp_path / "a.vtu", jittered_cube(2), order=2)
    raw = meshio.read(tmp_path / "a.vtu")
    rows = raw.cells[0].data.copy()
    rows[3, 1] = rows[3, 0]
    meshio.vtu.write(tmp_path / "b.vtu", meshio.Mesh(raw.points, [("tetra10", rows)]))
    with pytest.raises(
        InputError, match=r"b\.vtu: tet 3 is .*; its four vertices must differ \(found: 1 tet with a vertex"
    ):
        read(tmp_path / "b.vtu")
