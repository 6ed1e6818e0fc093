"""Files we write, read by the programs they are for; gmsh has a file of its own, MeshLab is with the surfaces."""

import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista as pv
from support.builders import two_region_cube
from vtkmodules.vtkIOXdmf2 import vtkXdmfReader

from wct_plugin.io import read, write
from wct_plugin.mesh import Cells, TetMesh


def _by_vtk(path: Path) -> Any:
    if path.suffix != ".xdmf":
        return pv.read(path)
    reader = vtkXdmfReader()  # pyvista's own wants time steps
    reader.SetFileName(str(path))
    reader.Update()
    return pv.wrap(reader.GetOutputDataObject(0))


@pytest.mark.filterwarnings("ignore:.*cannot carry:wct_plugin.errors.WctWarning")
@pytest.mark.parametrize("suffix", [".vtu", ".vtk", ".xdmf"])
def test_vtk_reads_cells_tags_data_and_sets(suffix: str, full: TetMesh, tmp_path: Path) -> None:
    write(tmp_path / f"a{suffix}", full)
    grid = _by_vtk(tmp_path / f"a{suffix}")
    assert np.array_equal(grid.points, full.points)
    tets = np.asarray(grid.celltypes) == pv.CellType.TETRA
    assert [int(tets.sum()), grid.n_cells] == [48, 48 + 48 + 5 + 3]
    volumes = grid.compute_cell_sizes(length=False, area=False)["Volume"]
    edges = full.points[full.tets[:, 1:]] - full.points[full.tets[:, :1]]
    assert np.asarray(volumes)[tets] == pytest.approx(np.linalg.det(edges) / 6)
    tags = np.asarray(grid.cell_data["gmsh:physical"])
    assert np.array_equal(tags[tets], full.regions)
    assert np.array_equal(tags[np.asarray(grid.celltypes) == pv.CellType.TRIANGLE], full.facets.tags)
    assert np.array_equal(grid.cell_data["heat"][tets], full.cell_data["heat"])
    assert np.isnan(grid.cell_data["flux"][tets]).all()
    assert np.array_equal(grid.point_data["u"], full.point_data["u"])
    assert np.flatnonzero(grid.point_data["set:fixed"]).tolist() == [0, 2, 3]
    assert np.flatnonzero(grid.cell_data["set:core"]).tolist() == [2, 9]


def test_tetgen_refines_what_we_write(tmp_path: Path) -> None:
    """With the regions' volumes and the facet markers' areas as they were."""
    cube = two_region_cube(2)
    skin = cube.topology.boundary
    top = (cube.points[skin][:, :, 2] == 1).all(axis=1)
    given = replace(cube, facets=Cells(skin, np.where(top, 6, 7)))
    write(tmp_path / "a.1.ele", given)
    done = subprocess.run(
        ["tetgen", "-rzqa0.002", str(tmp_path / "a.1")], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stdout
    finer = read(tmp_path / "a.2.ele")
    assert isinstance(finer, TetMesh)
    assert len(finer.tets) > 2 * len(cube.tets)
    for mesh in (given, finer):
        edges = mesh.points[mesh.tets[:, 1:]] - mesh.points[mesh.tets[:, :1]]
        volumes = np.linalg.det(edges) / 6
        assert [volumes[mesh.regions == tag].sum() for tag in (1, 2)] == pytest.approx([0.5, 0.5])
        legs = mesh.points[mesh.facets.vertices[:, 1:]] - mesh.points[mesh.facets.vertices[:, :1]]
        areas = np.linalg.norm(np.cross(legs[:, 0], legs[:, 1]), axis=1) / 2
        assert [areas[mesh.facets.tags == tag].sum() for tag in (6, 7)] == pytest.approx([1, 5])
