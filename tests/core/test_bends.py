"""Sizes at a bend that is no crease: no facet may cut so far across it that it leaves the tolerance."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import cylinder, kuhn_grid, two_region_cube
from support.core_meshes import start

from wct_plugin import apply_filter
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import TetMesh
from wct_plugin.meshing.reference import given_surface, own_boundary

TOLERANCE = 1e-3
SAG = 1.31  # of a typical facet, in tolerances


def roof(bend, n=8):
    """A unit cube whose top bends by so many degrees at a ridge along y = 1/2."""
    grid = kuhn_grid((n, n, n))
    x, y, z = (grid.points / n).T
    return TetMesh(np.stack([x, y, z * (1.0 - np.tan(np.radians(bend / 2)) * np.abs(y - 0.5))], axis=1), grid.tets)


def size_on_ridge(mesh, crease_angle):
    found = start(mesh, own_boundary(mesh, crease_angle), TOLERANCE)
    on = (np.abs(found.mesh.points[:, 1] - 0.5) < 0.02) & (found.mesh.stratum == 1) & (found.mesh.points[:, 2] > 0.9)
    return found.mesh.size[on]


@pytest.mark.parametrize("bend", [60, 80])
def test_sizes_at_a_bend_follow_the_tolerance(bend):
    mesh = roof(bend)
    tolerance = TOLERANCE * own_boundary(mesh, 85.0).diagonal
    most = 4.0 * SAG * tolerance / np.tan(np.radians(bend / 2))
    found = size_on_ridge(mesh, 85.0)
    assert len(found) > 10
    assert np.median(found) <= 1.2 * most


def test_what_is_a_crease_is_not_a_bend():
    mesh = roof(60)
    found = start(mesh, own_boundary(mesh, 40.0), TOLERANCE)
    ridge = found.mesh.points[found.mesh.creases][:, :, 1].mean(axis=1)
    on = np.unique(found.mesh.creases[np.abs(ridge - 0.5) < 1e-9])
    assert np.median(found.mesh.size[on]) > 0.7 * np.median(found.mesh.size)


def test_bends_shallower_than_the_tolerance_are_noise():
    """A top in zigzag, up and down by 70 degrees at every row: no curvature, and no facet is too deep anywhere."""
    mesh, rows, tolerance = kuhn_grid((4, 4, 4)), 100, 1e-2
    zigzag = kuhn_grid((4, rows, 1))
    x, y, z = (zigzag.points / zigzag.points.max(axis=0)).T
    height = np.tan(np.radians(35.0)) / rows * (np.rint(rows * y) % 2)
    noisy = TetMesh(np.stack([x, y, z * (1.0 + height)], axis=1), zigzag.tets)
    mesh = TetMesh(mesh.points / mesh.points.max(), mesh.tets)
    found = start(mesh, given_surface(noisy.boundary_surface(), mesh, 85.0), tolerance)
    middle = (np.abs(found.mesh.points[:, :2] - 0.5) < 0.25).all(axis=1) & (found.mesh.points[:, 2] > 0.9)
    as_bends = 4.0 * SAG * tolerance * np.sqrt(3.0) / np.tan(np.radians(35.0))
    assert found.mesh.size[middle].min() > 1.1 * as_bends


def test_triangles_that_run_either_way_are_no_bends():
    """A flat interface between regions whose triangles do not all run the same way."""
    mesh = two_region_cube(4)
    own = own_boundary(mesh, 40.0)
    wall = own.strata.patch == own.strata.patch[-1]  # interfaces come last
    triangles = own.strata.triangles.copy()
    triangles[np.flatnonzero(wall)[::2]] = triangles[np.flatnonzero(wall)[::2]][:, ::-1]
    turned = replace(own, strata=replace(own.strata, triangles=triangles))
    sizes = [start(mesh, one, TOLERANCE).mesh.size.min() for one in (own, turned)]
    assert sizes[1] > 0.5 * sizes[0]


# Of 50 seeds 4 to 7 bend edges of a few more facets than is borne, and say so, which is not what this is about.
@pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")
def test_a_long_edge_that_bends_is_followed_all_along():
    """A prism of ten sides, no crease at 36 degrees, whose edges are a thousand tolerances long."""
    mesh = cylinder(10, layers=1)
    mesh = replace(mesh, points=mesh.points * [1.0, 1.0, 4.0])
    better, metrics = apply_filter("meshing_well_centered", mesh, tolerance=TOLERANCE, edge_length=0.6)
    assert metrics["bad"] == 0
    surface = mesh.boundary_surface()
    assert measure_deviation(better.boundary_surface(), surface).max <= TOLERANCE * surface.diagonal
