"""VTK's older files as VTK, gmsh and ParaView write them."""

from pathlib import Path
from typing import Any

import gmsh
import numpy as np
import pytest
import pyvista as pv
from support.builders import two_region_cube
from support.gmsh_session import add_two_boxes, gmsh_session
from support.volumes import tet_volumes
from support.vtk_writing import write_legacy
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter, vtkUnstructuredGridWriter

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import read
from wct_plugin.mesh import SurfaceMesh, TetMesh


@pytest.fixture
def grid() -> pv.UnstructuredGrid:
    cube = two_region_cube(3)
    skin = cube.topology.boundary
    end = skin[(cube.points[skin, 0] == 0).all(axis=1)]
    made = pv.UnstructuredGrid({10: cube.tets, 5: end}, cube.points * [1 / 4, 0.5, 2])
    count = made.n_cells
    made.cell_data["cell_tags"] = np.concatenate([cube.regions + 10, np.full(len(end), 7)]).astype("i4")
    for name, dtype in (("a b", "u1"), ("long", "i8"), ("short", "i2"), ("f4", "f4"), ("f8", "f8")):
        made.cell_data[name] = (np.arange(count) % 100).astype(dtype)
    made.cell_data["flag"] = np.random.default_rng(0).random(count) < 0.5
    made.cell_data["tensor"] = np.arange(9.0 * count).reshape(-1, 9)
    made.point_data["u"] = made.points * 2
    return made


@pytest.mark.parametrize("version", [42, 51])
@pytest.mark.parametrize("binary", [False, True])
def test_as_vtk_writes_it(version: int, binary: bool, grid: pv.UnstructuredGrid, tmp_path: Path) -> None:
    grid.cell_data["words"] = np.array(["one two", "", "x" * 100] * 60)
    grid.field_data["TimeValue"] = [0.5]
    # Active arrays are written as SCALARS, VECTORS, TENSORS and GLOBAL_IDS, the others as fields.
    grid.GetPointData().SetActiveVectors("u")
    grid.GetCellData().SetActiveTensors("tensor")
    grid.GetCellData().SetActiveScalars("cell_tags")
    grid.point_data["ids"] = np.arange(grid.n_points)
    grid.GetPointData().SetActiveGlobalIds("ids")
    write_legacy(vtkUnstructuredGridWriter(), grid, tmp_path / "a.vtk", version=version, binary=binary)
    with pytest.warns(WctWarning, match="not read: field data 'TimeValue', cell data 'words', which is text$"):
        mesh = read(tmp_path / "a.vtk")
    assert isinstance(mesh, TetMesh)
    tets = grid.celltypes == 10
    digits = 0 if binary else 1e-10
    assert np.allclose(mesh.points, grid.points, rtol=0, atol=digits)
    assert np.array_equal(mesh.tets, grid.cells_dict[10])
    assert np.array_equal(mesh.regions, grid.cell_data["cell_tags"][tets])
    assert np.array_equal(mesh.facets.tags, grid.cell_data["cell_tags"][~tets])
    for name in ("a b", "long", "short", "f4", "f8", "flag", "tensor"):
        assert np.array_equal(mesh.cell_data[name], np.asarray(grid.cell_data[name])[tets]), name
        assert mesh.cell_data[name].dtype.isnative
    assert np.allclose(mesh.point_data["u"], grid.point_data["u"], rtol=0, atol=digits)
    assert np.array_equal(mesh.point_data["ids"], np.arange(grid.n_points))


@pytest.mark.parametrize("binary", [0, 1])
def test_as_gmsh_writes_it(binary: int, tmp_path: Path) -> None:
    with gmsh_session():
        gmsh.option.setNumber("Mesh.Binary", binary)
        add_two_boxes()
        for tag in (1, 2):
            gmsh.model.addPhysicalGroup(3, [tag], tag)
        gmsh.model.mesh.setSize(gmsh.model.getEntities(0), 0.7)
        gmsh.model.mesh.generate(3)
        gmsh.write(str(tmp_path / "a.vtk"))
    mesh: Any = read(tmp_path / "a.vtk")
    ids = mesh.cell_data["CellEntityIds"].ravel() if "CellEntityIds" in mesh.cell_data else mesh.regions
    size = tet_volumes(mesh)
    assert np.bincount(ids, size)[1:].tolist() == pytest.approx([1, 1], rel=1e-12)


@pytest.mark.parametrize("version", [42, 51])
@pytest.mark.parametrize("binary", [False, True])
def test_polygons(version: int, binary: bool, tmp_path: Path) -> None:
    cube = pv.Cube()
    cube.cell_data["side"] = np.arange(6)
    write_legacy(vtkPolyDataWriter(), cube, tmp_path / "a.vtk", version=version, binary=binary)
    with pytest.warns(WctWarning, match="6 quads split into triangles$"):
        surface = read(tmp_path / "a.vtk")
    assert isinstance(surface, SurfaceMesh)
    assert surface.cell_data["side"].tolist() == np.repeat(np.arange(6), 2).tolist()
    assert np.linalg.det(surface.points[surface.triangles]).sum() / 6 == pytest.approx(1, rel=1e-12)


HEAD = (
    "# vtk DataFile Version 2.0\nby hand\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n"
)


def test_colours_tables_and_blank_lines(tmp_path: Path) -> None:
    (tmp_path / "a.vtk").write_text(
        HEAD + "\nCELLS 1 5\n4 0 1 2 3\n\nCELL_TYPES 1\n10\nCELL_DATA 1\nCOLOR_SCALARS rgb 3\n.5 0 1\n"
        "SCALARS mat_id int\nLOOKUP_TABLE colours\n7\nLOOKUP_TABLE colours 2\n0 0 0 1\n1 1 1 1\n"
        "POINT_DATA 4\nNORMALS n float\n1 0 0 1 0 0 1 0 0 1 0 0\nTEXTURE_COORDINATES t 2 float\n0 0 0 0 0 0 0 0"
    )
    mesh = read(tmp_path / "a.vtk")
    assert isinstance(mesh, TetMesh)
    assert mesh.cell_data["rgb"].tolist() == [[0.5, 0, 1]]
    assert mesh.point_data["n"].shape == (4, 3)
    assert mesh.point_data["t"].shape == (4, 2)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("# vtk DataFile Version 2.0\na\nTEXT\n", "does not begin with '# vtk DataFile Version', a title, and ASCII"),
        (HEAD.replace("UNSTRUCTURED_GRID", "STRUCTURED_POINTS"), "holds STRUCTURED_POINTS; allowed are UNSTRUCTURED"),
        (HEAD + "CELLS 1 5\n4 0 1 2 3\n", "has no CELL_TYPES"),
        (HEAD + "CELLS 2 5\n4 0 1 2 3\n", "has 1 cells but announces 2"),
        (HEAD + "CELLS 1 6\n4 0 1 2 3 5\n", "ends within a cell"),
        (HEAD + "CELLS 1 5\n4 0 1 2\n", "ends within its numbers"),
        (HEAD + "CELLS 1 5\n4 0 1 2 x\n", "has 'x' where a whole number should be"),
        (HEAD + "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nCELL_DATA 1\nSCALARS a quad\nLOOKUP_TABLE d\n1\n",
         "announces 1 numbers of the type 'quad'; allowed are unsigned_char"),
        (HEAD + "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nJUNK 1\n", "has the line 'JUNK 1', which means nothing in a"),
    ],
)  # fmt: skip
def test_refusals(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "a.vtk").write_text(text)
    with pytest.raises(InputError, match=rf"a\.vtk: cannot be read as VTK: {said}"):
        read(tmp_path / "a.vtk")
