"""Cells beside tets and mid nodes in the objects of other libraries."""

import pickle
from copy import deepcopy
from pathlib import Path

import meshio
import numpy as np
import pytest
import pyvista as pv
from support.builders import jittered_cube

import wct_plugin as wct
from wct_plugin.objects.conversions import as_mesh, converted

DATA = Path(__file__).parents[1] / "data"
pytestmark = pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")


@pytest.mark.parametrize("library", ["pyvista", "meshio"])
def test_wedges_go_there_and_back(library):
    mesh = wct.read(DATA / "prismlayer.msh")
    back = as_mesh(converted(mesh, library))
    assert np.array_equal(back.points, mesh.points)
    assert np.array_equal(back.tets, mesh.tets)
    one, other = (m.others.points[m.others.cells["wedge"].vertices] for m in (mesh, back))
    assert np.array_equal(one, other)
    assert back.others.cells["wedge"].tags.tolist() == mesh.others.cells["wedge"].tags.tolist()


def test_pyvista_has_their_volumes():
    mesh = wct.read(DATA / "prismlayer.msh")
    grid = converted(mesh, "pyvista")
    sizes = grid.compute_cell_sizes(length=False, area=False)["Volume"]
    assert sizes[: len(mesh.tets)].sum() == pytest.approx(1.0, rel=1e-12)
    thickness = np.ptp(mesh.others.points[:, 2])
    assert abs(sizes[len(mesh.tets) :].sum()) == pytest.approx(thickness, rel=1e-12)
    assert set(grid.celltypes.tolist()) == {pv.CellType.TETRA, pv.CellType.WEDGE}


@pytest.mark.parametrize("kind", [np.float64, np.int32])
def test_the_array_of_the_regions_stays_on_all_cells(kind, recwarn):
    """Of a tet and a wedge: both keep their material, in its own type, and nothing is said to be lost."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -1], [1, 0, -1], [0, 1, -1.0]])
    cells = [("tetra", [[0, 1, 2, 3]]), ("wedge", [[4, 5, 6, 0, 1, 2]])]
    given = meshio.Mesh(points, cells, cell_data={"material": [np.array([1], dtype=kind), np.array([2], dtype=kind)]})
    made = converted(as_mesh(given), "meshio")
    assert [column.tolist() for column in made.cell_data["material"]] == [[1], [2]]
    assert {column.dtype for column in made.cell_data["material"]} == {np.dtype(kind)}
    assert not [one for one in recwarn if "dropped" in str(one.message)]


@pytest.mark.parametrize("library", ["pyvista", "meshio"])
def test_mid_nodes_come_again(library, tmp_path):
    wct.write(tmp_path / "a.vtu", jittered_cube(2), order=2)
    mesh = wct.read(tmp_path / "a.vtu")
    made = converted(mesh, library)
    kinds = {block.type for block in made.cells} if library == "meshio" else set(made.celltypes.tolist())
    assert kinds == ({"tetra10"} if library == "meshio" else {pv.CellType.QUADRATIC_TETRA})
    assert np.array_equal(as_mesh(made).tets, mesh.tets)


def test_meshes_with_them_pickle_and_copy(tmp_path):
    wct.write(tmp_path / "a.vtu", jittered_cube(2), order=2)
    for mesh in (wct.read(DATA / "prismlayer.msh"), wct.read(tmp_path / "a.vtu")):
        for again in (pickle.loads(pickle.dumps(mesh)), deepcopy(mesh)):
            assert np.array_equal(again.points, mesh.points)
            assert (again.others is None) == (mesh.others is None)
            assert (again.second_order is None) == (mesh.second_order is None)
            if mesh.others:
                assert not again.others.points.flags.writeable
                assert np.array_equal(again.others.shared, mesh.others.shared)
