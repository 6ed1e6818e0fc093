"""The accessor ``.wct``: pyvista finds it, grids go through it and come back with all they had."""

import signal
import subprocess
import sys
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import gmsh
import numpy as np
import pytest
import pyvista as pv
from support.builders import bcc, kuhn_cube
from support.comparing import assert_same

import wct_plugin as wct
from wct_plugin.errors import InputError, OptionError, WctWarning
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.objects.pyvista_meshes import from_pyvista, to_pyvista
from wct_plugin.reports.report import make_report


def volumes(grid: pv.UnstructuredGrid) -> np.ndarray:
    """As VTK measures them: zero where a cell is no tet."""
    return np.asarray(grid.compute_cell_sizes(length=False, area=False)["Volume"])


def test_pyvista_finds_the_accessor_and_imports_nothing_of_ours_before() -> None:
    code = (
        "import sys, pyvista as pv\n"
        "grid = pv.ImageData(dimensions=(2, 2, 2)).cast_to_unstructured_grid().triangulate()\n"
        "assert 'wct' in dir(grid) and 'wct_plugin' not in sys.modules\n"
        "print(grid.wct.report().tets, 'wct_plugin' in sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split()[1:] == ["True"]
    assert int(done.stdout.split()[0]) in (5, 6)
    assert {one.target for one in pv.registered_accessors() if one.name == "wct"} == {pv.UnstructuredGrid, pv.PolyData}


def test_a_mesh_with_everything_there_and_back(full: TetMesh) -> None:
    grid = to_pyvista(full)
    assert grid.n_cells == len(full.tets) + len(full.facets) + len(full.edges) + len(full.nodes)
    assert np.asarray(grid.cell_data["gmsh:physical"])[: len(full.tets)].tolist() == full.regions.tolist()
    assert volumes(grid).sum() == pytest.approx(wct.apply_filter("get_quality", full)[1]["volume"])
    assert_same(from_pyvista(grid), full)


def test_a_grid_there_and_back(full: TetMesh) -> None:
    """Types, too: what pyvista calls truth stays truth."""
    grid = to_pyvista(full)
    grid.cell_data["is_cold"] = np.arange(grid.n_cells) % 2 == 0
    grid.point_data["velocity"] = np.ones((grid.n_points, 3), dtype=np.float32)
    again = to_pyvista(from_pyvista(grid))
    assert np.array_equal(again.cells, grid.cells)
    assert np.array_equal(again.celltypes, grid.celltypes)
    assert np.array_equal(again.points, grid.points)
    for data in ("point_data", "cell_data", "field_data"):
        had, has = getattr(grid, data), getattr(again, data)
        assert set(has) == set(had)
        for name, values in had.items():
            assert np.array_equal(has[name], values, equal_nan=values.dtype.kind == "f"), name
            assert has[name].dtype == values.dtype, name


def test_cells_in_any_order_are_sorted_by_kind_with_their_data(plain: TetMesh) -> None:
    (a, b, c, d), (e, f, g, h) = plain.tets[:2].tolist()
    cells = [[3, a, b, c], [4, a, b, c, d], [3, f, g, h], [2, a, b], [4, e, f, g, h], [1, a]]
    types = [pv.CellType(code) for code in (5, 10, 7, 4, 10, 2)]  # a polygon, a polyline and a polyvertex among them
    grid = pv.UnstructuredGrid(np.concatenate(cells), types, plain.points)
    grid.cell_data["gmsh:physical"] = np.array([7, 1, 8, 3, 2, 4])
    mesh = from_pyvista(grid)
    assert isinstance(mesh, TetMesh)
    assert mesh.regions.tolist() == [1, 2]
    assert mesh.facets.tags.tolist() == [7, 8]
    assert (mesh.edges.tags.tolist(), mesh.nodes.tags.tolist()) == ([3], [4])
    assert (mesh.points[mesh.edges.vertices[0]] == plain.points[[a, b]]).all()


def test_a_surface_there_and_back(surface: SurfaceMesh) -> None:
    poly = to_pyvista(surface)
    assert isinstance(poly, pv.PolyData)
    assert_same(from_pyvista(poly), surface)


def two_boxes(path: Path) -> pv.UnstructuredGrid:
    """Two unit boxes that share a face, one region, as gmsh meshes them and pyvista reads them; the left end is 6."""
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        boxes = [(3, gmsh.model.occ.addBox(at, 0, 0, 1, 1, 1)) for at in (0, 1)]
        gmsh.model.occ.fragment(boxes[:1], boxes[1:])
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [1, 2], 9)
        end = gmsh.model.getEntitiesInBoundingBox(-0.1, -0.1, -0.1, 0.1, 1.1, 1.1, 2)
        gmsh.model.addPhysicalGroup(2, [tag for _, tag in end], 6)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.25)
        gmsh.model.mesh.generate(3)
        gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    return pv.read(path)


def test_optimize_keeps_regions_facets_arrays_and_its_input(tmp_path: Path) -> None:
    grid = two_boxes(tmp_path / "a.msh")
    material = np.where(grid.cell_centers().points[:, 0] < 1, 1, 2).astype(np.int32)
    tets = np.asarray(grid.celltypes) == pv.CellType.TETRA
    grid.cell_data["material"] = np.where(tets, material, 0).astype(np.int32)
    grid.cell_data["k"] = np.where(tets, 10.0 * material, np.nan)
    grid.point_data["height"] = grid.points[:, 2]
    grid.field_data["title"] = ["two layers"]
    before = grid.copy()
    better = grid.wct.optimize(goal="3wc", regions="material")
    assert grid == before
    assert better.wct.report().to_dict()["3wc"]["percent"] == 100
    assert better.field_data["title"].tolist() == ["two layers"]
    tets = np.asarray(better.celltypes) == pv.CellType.TETRA
    assert better.cell_data["material"].dtype == np.int32
    for region in (1, 2):
        assert volumes(better)[better.cell_data["material"] == region].sum() == pytest.approx(1)
    assert np.array_equal(better.cell_data["k"][tets], 10.0 * better.cell_data["material"][tets])
    assert better.point_data["height"] == pytest.approx(better.points[:, 2])
    assert set(better.cell_data["gmsh:physical"][tets]) == {9}
    end = better.extract_cells(~tets)
    assert set(end.cell_data["gmsh:physical"]) == {6}
    assert end.area == pytest.approx(1)
    assert np.asarray(end.points)[:, 0] == pytest.approx(0)


def test_the_tags_are_regions_whether_asked_for_or_not() -> None:
    mesh = bcc(2)
    below = mesh.points[mesh.tets].mean(axis=1)[:, 2] < 1
    grid = to_pyvista(replace(mesh, regions=np.where(below, 4, 5)))
    options = {"goal": "3wc", "boundary": "fixed"}
    asked, plain = grid.wct.optimize(regions="gmsh:physical", **options), grid.wct.optimize(**options)
    assert asked == plain
    after = volumes(plain)[plain.cell_data["gmsh:physical"] == 4]
    assert after.sum() == pytest.approx(volumes(grid)[below].sum())


def test_options_are_those_of_the_filter(plain: TetMesh) -> None:
    grid = to_pyvista(plain)
    with pytest.raises(OptionError, match="unknown option 'tolerence'; did you mean 'tolerance'"):
        grid.wct.optimize(tolerence=1e-3)
    with pytest.raises(OptionError, match=r"goal is '4wc'; allowed are '3wc', 'cwc'"):
        grid.wct.plot_bad("4wc")


@pytest.fixture
def own_interrupt() -> Iterator[None]:
    """Python's answer to Ctrl-C, put back: in our own process fTetWild's library makes it end the process."""
    yield
    signal.signal(signal.SIGINT, signal.getsignal(signal.SIGINT))


@pytest.mark.usefixtures("own_interrupt")
@pytest.mark.parametrize("mesher", ["tetwild", "tetgen"])
def test_one_chain_from_surface_to_well_centered(mesher: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # where fTetWild leaves a file
    surface = pv.Icosphere(nsub=2)
    options = {"tetwild": {"edge_length_fac": 0.2, "quiet": True}, "tetgen": {"order": 1}}[mesher]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pv.PyVistaDeprecationWarning)  # of the neighbours' own
        filled = getattr(surface, mesher).tetrahedralize(**options)
    better = filled.wct.optimize(reference=surface, tolerance=5e-3)
    report = better.wct.report()
    assert report.flags["cwc"] == report.tets
    assert better.extract_surface(algorithm="dataset_surface").compute_implicit_distance(surface)[
        "implicit_distance"
    ] == pytest.approx(0, abs=5e-3 * surface.length)


def test_a_surface_alone_goes_through_ftetwild() -> None:
    surface = pv.Icosphere(nsub=2)
    before = surface.copy()
    grid = surface.wct.optimize()
    assert surface == before
    assert grid.wct.report().to_dict()["tier"] == "CWC"
    assert volumes(grid).sum() == pytest.approx(surface.volume, rel=0.01)


def test_report_is_that_of_the_mesh(full: TetMesh) -> None:
    assert to_pyvista(full).wct.report(worst=3).to_dict() == make_report(full, worst=3).to_dict()


def test_bad_tets_show_and_good_ones_do_not(tmp_path: Path) -> None:
    grid = to_pyvista(kuhn_cube(2))
    plotter = grid.wct.plot_bad(off_screen=True, show=False)
    assert plotter.actors
    grid.wct.plot_bad(off_screen=True, screenshot=tmp_path / "bad.png")
    to_pyvista(bcc(3)).wct.plot_bad(off_screen=True, screenshot=tmp_path / "good.png")
    coloured = []
    for name in ("bad.png", "good.png"):
        picture = np.asarray(pv.read(tmp_path / name).active_scalars).astype(int)
        coloured.append((np.ptp(picture[:, :3], axis=1) > 60).mean())
    assert coloured[0] > 0.1
    assert coloured[1] == 0


def test_other_cells_are_refused_by_name() -> None:
    grid = pv.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
    with pytest.raises(InputError, match=r"^UnstructuredGrid: has 8 voxel cells; allowed are tetra, triangle, line"):
        grid.wct.optimize()
    with pytest.warns(WctWarning, match=r"^PolyData: 6 quads split into triangles"):
        cube = from_pyvista(pv.Cube())
    assert isinstance(cube, SurfaceMesh)
    assert len(cube.triangles) == 12
    with pytest.raises(InputError, match=r"^UnstructuredGrid: has no cells"):
        pv.UnstructuredGrid().wct.report()
    with pytest.raises(OptionError, match=r"needs a tet mesh, here is a surface"):
        pv.Sphere().cast_to_unstructured_grid().wct.report()


def test_regions_that_are_none_are_refused(full: TetMesh) -> None:
    grid = to_pyvista(full)
    with pytest.raises(OptionError, match=r"regions is 'steel'; allowed are the cell arrays: heat, "):
        grid.wct.optimize(regions="steel")
    with pytest.raises(OptionError, match=r"regions is 'heat', float64 of shape \(48,\); allowed are whole numbers"):
        grid.wct.optimize(regions="heat")


def test_words_are_dropped_aloud(plain: TetMesh) -> None:
    mesh = TetMesh(plain.points, plain.tets, cell_data={"words": np.array(["a"] * len(plain.tets))})
    with pytest.warns(WctWarning, match="pyvista's dataset cannot carry, so dropped: cell data 'words'"):
        to_pyvista(mesh)
