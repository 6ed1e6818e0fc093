"""Walls that a surface within the tolerance may pass through are named, and nothing else is."""

import numpy as np
import pytest
from support.builders import ball, cylinder, kuhn_cube, kuhn_grid, l_shape, rotation

from wct_plugin import apply_filter
from wct_plugin.errors import WctWarning
from wct_plugin.measure.thin_walls import thinnest
from wct_plugin.mesh import TetMesh


def plate(thickness, turn=None):
    """One by one, and so thick."""
    mesh = kuhn_grid((5, 5, 1), lambda c: c[:, 0] >= 0)
    points = mesh.points * [0.2, 0.2, thickness]
    return TetMesh(points if turn is None else points @ turn.T, mesh.tets, mesh.regions)


@pytest.mark.parametrize("below", [0.025, 0.1, 0.3])
def test_a_plate_is_as_thick_as_it_is(below):
    found = thinnest(plate(0.02, rotation(4)), below)
    assert found.thickness == pytest.approx(0.02)
    x, y, z = np.array(found.place) @ rotation(4)
    assert 0 < x < 1
    assert 0 < y < 1
    assert z == pytest.approx(0.01)
    assert thinnest(plate(0.02), 0.0199) is None


def wedge(degrees):
    """A bar with a triangle for a section, sharp along x = y = 0."""
    mesh = kuhn_grid((8, 1, 4), lambda c: c[:, 0] >= 0)
    x, y, z = (mesh.points / [8, 1, 4]).T
    height = (0.02 + 0.98 * x) * np.tan(np.radians(degrees))
    return TetMesh(np.column_stack([x, (y - 0.5) * height, z]), mesh.tets)


@pytest.mark.parametrize(
    "mesh",
    [kuhn_cube(3), l_shape(3), ball(4), cylinder(24, 6), wedge(15), wedge(40)],
    ids=["cube", "L", "ball", "cylinder", "wedge", "blunt wedge"],
)
def test_edges_and_bodies_that_are_thick_enough_are_no_walls(mesh):
    assert thinnest(mesh, 0.1 * mesh.diagonal) is None


def test_a_layer_between_two_regions_is_named_by_its_tag():
    mesh = kuhn_grid((4, 4, 3), lambda c: c[:, 0] >= 0)
    heights = np.array([0.0, 2.0, 2.05, 4.0])
    layer = np.floor(mesh.points[mesh.tets].mean(axis=1)[:, 2]).astype(np.int64)
    points = np.column_stack([mesh.points[:, :2], heights[mesh.points[:, 2].astype(int)]])
    found = thinnest(TetMesh(points, mesh.tets, regions=layer + 5), 0.2)
    assert found.region == 6
    assert found.thickness == pytest.approx(0.05)


def test_before_the_work_a_wall_thinner_than_the_tolerance_allows_is_named():
    mesh = plate(0.02)
    half = 0.01 / mesh.diagonal

    def stop(_):
        return False

    with pytest.warns(WctWarning, match=rf"the body is 0\.02 thick near \(.*use a tolerance below {half:.2e}"):
        apply_filter("meshing_well_centered", mesh, tolerance=0.05, progress=stop)
    with pytest.warns(WctWarning, match=r"the body is 0\.02 thick near"):
        apply_filter("meshing_well_centered", mesh, tolerance=0.05, boundary="keep", progress=stop)
    for options in ({"tolerance": 0.99 * half}, {"tolerance": 0.05, "boundary": "fixed"}):
        apply_filter("meshing_well_centered", mesh, progress=stop, **options)  # a warning would be an error
