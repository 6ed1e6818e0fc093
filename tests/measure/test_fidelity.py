"""Deviations and volumes of a changed mesh against closed forms."""

import json
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest
from support.builders import ball, sphere_surface, two_region_cube

from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.measure.fidelity import beyond, describe, measure_fidelity, region_names
from wct_plugin.mesh import TetMesh


def raised(mesh, by):
    """The two-region cube with its interface lifted, all else as it was."""
    points = mesh.points.copy()
    points[points[:, 2] == 0.5, 2] += by
    return TetMesh(points, mesh.tets, mesh.regions)


def said(found, names=MappingProxyType({})):
    return describe(found["volumes"], found["interfaces"], names)


def test_nothing_changed():
    mesh = two_region_cube(4)
    found = measure_fidelity(mesh, mesh, None)
    assert json.loads(json.dumps(found)) == found
    assert set(found["volumes"]) == {"1", "2"}
    assert all(one["change"] == 0 for one in found["volumes"].values())
    assert list(beyond(found, 1e-12, {}).values()) == []
    assert said(measure_fidelity(ball(3), ball(3), None)) == ""


def test_a_lifted_interface_shows_though_the_boundary_is_as_it_was():
    mesh = two_region_cube(4)
    found = measure_fidelity(mesh, raised(mesh, 0.1), None)
    assert found["deviation"]["max"] < 1e-12
    apart = found["interfaces"]["1|2"]
    assert apart["to_reference"] == pytest.approx(0.1)
    assert apart["from_reference"] == pytest.approx(0.1)
    assert apart["fraction_of_diagonal"] == pytest.approx(0.1 / np.sqrt(3.0))
    assert found["volumes"]["1"]["change"] == pytest.approx(0.2)
    assert found["volumes"]["2"]["change"] == pytest.approx(-0.2)
    assert list(beyond(found, 0.06, {}).values()) == []
    assert list(beyond(found, 0.05, {}).values()) == ["the interface 1|2 is 5.77e-02 of the diagonal from the old one"]
    assert said(found) == (
        "region 1: volume +20.000 %; region 2: volume -20.000 %; "
        "interface 1|2: 5.77e-02 of the diagonal from the old one"
    )


def test_regions_are_called_by_their_names():
    mesh = two_region_cube(4)
    named = replace(mesh, names={"silicon": (1, 3), "lid": (2, 2)})  # the second is a group of facets
    names = region_names(named)
    assert names == {"1": "silicon"}
    found = measure_fidelity(mesh, raised(mesh, 0.1), None)
    assert said(found, names) == (
        "region 1 (silicon): volume +20.000 %; region 2: volume -20.000 %; "
        "interface 1|2 (silicon|2): 5.77e-02 of the diagonal from the old one"
    )
    assert "the interface 1|2 (silicon|2) is" in beyond(found, 0.05, names)["1|2"]


def test_an_interface_that_lost_a_piece_is_seen_from_the_old_side():
    mesh = two_region_cube(4)
    centers = mesh.points[mesh.tets].mean(axis=1)
    hole = (centers[:, :2] < 0.5).all(axis=1)  # region 1 takes a column of region 2
    found = measure_fidelity(mesh, replace(mesh, regions=np.where(hole, 1, mesh.regions)), None)
    assert found["interfaces"]["1|2"]["from_reference"] > 0.4


def test_a_lost_interface_is_named():
    mesh = two_region_cube(2)
    found = measure_fidelity(mesh, replace(mesh, regions=np.ones(len(mesh.tets), dtype=int)), None)
    assert found["interfaces"] == {"1|2": None}
    assert list(beyond(found, 0.1, {}).values()) == ["the interface 1|2 is lost"]
    assert said(found).endswith("interface 1|2: lost")
    assert found["volumes"]["2"] == {"before": pytest.approx(0.5), "after": 0.0, "change": -1.0}


def test_the_boundary_is_measured_against_the_surface():
    mesh, surface = ball(4), sphere_surface(2000)
    apart = measure_deviation(mesh.boundary_surface(), surface)
    found = measure_fidelity(mesh, mesh, surface)["deviation"]
    assert found["max"] == pytest.approx(apart.max)
    assert found["fraction_of_diagonal"] == pytest.approx(apart.max / surface.diagonal)
    assert "from the reference" in next(iter(beyond(measure_fidelity(mesh, mesh, surface), 1e-4, {}).values()))
