"""Deviations and volumes of a changed mesh against closed forms."""

import json
from dataclasses import replace

import numpy as np
import pytest
from builders import ball, sphere_surface, two_region_cube

from wct_plugin.deviation import deviation
from wct_plugin.fidelity import fidelity, worst
from wct_plugin.mesh import TetMesh


def raised(mesh, by):
    """The two-region cube with its interface lifted, all else as it was."""
    points = mesh.points.copy()
    points[points[:, 2] == 0.5, 2] += by
    return TetMesh(points, mesh.tets, mesh.regions)


def test_nothing_changed():
    mesh = two_region_cube(4)
    found = fidelity(mesh, mesh, None)
    assert json.loads(json.dumps(found)) == found
    assert set(found["volumes"]) == {"1", "2"}
    assert all(one["change"] == 0 for one in found["volumes"].values())
    assert all(off < 1e-12 for _, off in worst(found))


def test_a_lifted_interface_shows_though_the_boundary_is_as_it_was():
    mesh = two_region_cube(4)
    found = fidelity(mesh, raised(mesh, 0.1), None)
    assert found["deviation"]["max"] < 1e-12
    apart = found["interfaces"]["1|2"]
    assert apart["to_reference"] == pytest.approx(0.1)
    assert apart["from_reference"] == pytest.approx(0.1)
    assert apart["fraction_of_diagonal"] == pytest.approx(0.1 / np.sqrt(3.0))
    assert found["volumes"]["1"]["change"] == pytest.approx(0.2)
    assert found["volumes"]["2"]["change"] == pytest.approx(-0.2)
    assert dict(worst(found)) == pytest.approx({"boundary": 0.0, "interface 1|2": 0.1 / np.sqrt(3.0)}, abs=1e-12)


def test_an_interface_that_lost_a_piece_is_seen_from_the_old_side():
    mesh = two_region_cube(4)
    centers = mesh.points[mesh.tets].mean(axis=1)
    hole = (centers[:, :2] < 0.5).all(axis=1)  # region 1 takes a column of region 2
    found = fidelity(mesh, replace(mesh, regions=np.where(hole, 1, mesh.regions)), None)
    assert found["interfaces"]["1|2"]["from_reference"] > 0.4


def test_a_lost_interface_is_infinitely_far():
    mesh = two_region_cube(2)
    found = fidelity(mesh, replace(mesh, regions=np.ones(len(mesh.tets), dtype=int)), None)
    assert found["interfaces"] == {"1|2": None}
    assert dict(worst(found))["interface 1|2"] == np.inf
    assert found["volumes"]["2"] == {"before": pytest.approx(0.5), "after": 0.0, "change": -1.0}


def test_the_boundary_is_measured_against_the_surface():
    mesh, surface = ball(4), sphere_surface(2000)
    apart = deviation(mesh.boundary_surface(), surface)
    found = fidelity(mesh, mesh, surface)["deviation"]
    assert found["max"] == pytest.approx(apart.max)
    assert found["fraction_of_diagonal"] == pytest.approx(apart.max / surface.diagonal)
