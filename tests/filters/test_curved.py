"""Tets with curved mid nodes: improved by their corners, vertices and new mid nodes on the curved surface."""

import meshio
import numpy as np
import pytest
from support.second_order import cylinder, made, tens, volumes

import wct_plugin as wct
from wct_plugin.measure.second_order import CurvedCells, middles_as_read

pytestmark = pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")


@pytest.fixture(scope="module")
def given(tmp_path_factory):
    return made(tmp_path_factory.mktemp("curved") / "cylinder.msh", cylinder, 0.3)


@pytest.fixture(scope="module")
def better(given):
    return wct.apply_filter("meshing_well_centered", wct.read(given))


def test_volumes_and_areas_of_curved_cells(given):
    mesh = wct.read(given)
    cells = CurvedCells(mesh, middles_as_read(mesh))
    found, _ = volumes(tens(meshio.read(given)))
    assert cells.volumes().sum() == pytest.approx(found.sum(), rel=1e-12)
    assert found.sum() == pytest.approx(np.pi / 4, rel=2e-4)
    assert cells.areas(mesh.topology.boundary).sum() == pytest.approx(1.5 * np.pi, rel=2e-4)
    rim = mesh.topology.edges[(np.hypot(*mesh.points[:, :2].T) > 0.4999)[mesh.topology.edges].all(axis=1)]
    rim = rim[(mesh.points[rim][:, :, 2] == 1).all(axis=1)]
    assert cells.lengths(rim).sum() == pytest.approx(np.pi, rel=2e-4)


def test_the_goal_is_met_on_the_curved_surface(better):
    mesh, metrics = better
    assert metrics["bad"] == 0
    assert metrics["losses"] == []
    assert metrics["default_tolerance"]
    assert metrics["volumes"]["1"]["before"] == pytest.approx(np.pi / 4, rel=2e-4)
    assert abs(metrics["volumes"]["1"]["change"]) < 1e-3
    assert metrics["deviation"]["fraction_of_diagonal"] < 2e-3
    assert metrics["groups"]["skin"]["before"] == pytest.approx(1.5 * np.pi, rel=2e-4)
    radius = np.hypot(*mesh.points[:, :2].T)
    side = mesh.topology.boundary_points & (radius > 0.45)
    assert (np.abs(radius[side] - 0.5) < 1e-3).mean() > 0.95  # the input's own facets are off by so much


def test_it_is_written_with_curved_mid_nodes(better, tmp_path):
    mesh, _ = better
    wct.write(tmp_path / "a.msh", mesh)
    found, least = volumes(tens(meshio.read(tmp_path / "a.msh")))
    assert least > 0
    assert found.sum() == pytest.approx(np.pi / 4, rel=1e-3)
    back = wct.read(tmp_path / "a.msh")
    assert back.second_order.curved
    assert len(back.tets) == len(mesh.tets)


def test_fixed_facets_keep_their_mid_nodes(given, tmp_path):
    mesh = wct.read(given)
    made_of, metrics = wct.apply_filter("meshing_well_centered", mesh, boundary="fixed", goal="3wc")
    assert metrics["volumes"]["1"]["change"] == pytest.approx(0.0, abs=1e-12)
    wct.write(tmp_path / "a.vtu", made_of)
    found, _ = volumes(tens(meshio.read(tmp_path / "a.vtu")))
    assert found.sum() == pytest.approx(volumes(tens(meshio.read(given)))[0].sum(), rel=1e-12)


def test_straight_ones_are_as_those_without_mid_nodes(tmp_path):
    cube, _ = wct.apply_filter("create_cube", variant="84")
    wct.write(tmp_path / "a.vtu", cube, order=2)
    second = wct.read(tmp_path / "a.vtu")
    assert second.reference is None
    one, _ = wct.apply_filter("meshing_well_centered", cube)
    other, _ = wct.apply_filter("meshing_well_centered", second)
    assert np.array_equal(one.points, other.points)
    assert other.second_order is not None
