"""The floor of shape: counts as quality.py sees them, blame only where creases and corners of the domain force it."""

import numpy as np
import pytest
from support.builders import bcc, jittered_cube, kuhn_cube, single

from wct_plugin.measure import quality
from wct_plugin.measure.opening_angles import corner_angles, wedge_angles
from wct_plugin.measure.shape_floor import describe, measure_shape_floor
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import find_strata
from wct_plugin.mesh.topology import EDGES


def blade(degrees, n=4):
    """A wedge of n slices whose two long faces meet at this angle along the z axis."""
    angle = np.radians(degrees)
    flat = np.array([[0.0, 0.0], [1.0, 0.0], [np.cos(angle), np.sin(angle)]])
    points = np.vstack([np.column_stack([flat, np.full(3, z)]) for z in np.linspace(0.0, 1.0, n + 1)])
    low = 3 * np.arange(n)[:, None]
    tets = np.concatenate([low + row for row in ([0, 1, 2, 5], [0, 1, 4, 5], [0, 3, 4, 5])])
    volume = np.linalg.det(points[tets[:, 1:]] - points[tets[:, :1]])
    tets[volume < 0] = tets[volume < 0][:, [0, 1, 3, 2]]
    return TetMesh(points, tets)


def floor_of(mesh, domain=None, tolerance=1e-3):
    domain = domain or mesh
    return measure_shape_floor(mesh, quality.measure(mesh), domain, find_strata(domain), tolerance)


def test_wedges_of_a_cube():
    mesh = jittered_cube(3, 1)
    of = find_strata(mesh)
    angles = wedge_angles(mesh, np.arange(len(mesh.tets)))
    ends = np.sort(mesh.tets[:, EDGES], axis=2)
    surface = np.sort(of.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    keys = [set((rows @ [1000, 1]).tolist()) for rows in (of.segments, surface)]
    at = (ends @ [1000, 1]).ravel()
    wanted = np.select([np.isin(at, list(keys[0])), np.isin(at, list(keys[1]))], [90.0, 180.0], 360.0)
    assert np.allclose(angles.ravel(), wanted, atol=1e-9)
    some = np.array([5, 2])
    assert np.allclose(wedge_angles(mesh, some), angles[some], atol=1e-9)


def test_angles_at_the_corners_of_a_cube():
    mesh = kuhn_cube(2)
    corners, angle = corner_angles(mesh.points, find_strata(mesh))
    assert np.array_equal(np.bincount(corners)[np.unique(corners)], [3] * 8)
    assert np.allclose(angle, 90.0)


def test_good_shapes_say_nothing():
    found = floor_of(bcc(2))
    assert found["min_dihedral_angle"] == pytest.approx(60.0)
    assert found["max_radius_over_edge"] == pytest.approx(0.6455, abs=1e-4)
    assert describe(found) == ""


def test_a_thin_blade_forces_flat_angles():
    mesh = blade(6.0)
    found = floor_of(mesh)
    below = (quality.measure(mesh).min_dihedral_angle < 10.0).sum()
    assert found["dihedral_below_floor"] == found["dihedral_forced"] == below > 0
    assert "at creases that open no wider" in describe(found)


def test_a_flat_tet_where_the_domain_is_blunt_is_not_forced():
    """The same flat tets against a domain that opens by 90 degrees, or whose sharp crease is somewhere else."""
    mesh = blade(6.0)
    moved = TetMesh(mesh.points + np.array([0.0, 0.5, 0.0]), mesh.tets)
    for domain in (kuhn_cube(2), moved):
        found = floor_of(mesh, domain)
        assert found["dihedral_below_floor"] > 0
        assert found["dihedral_forced"] == 0


def test_narrow_corners_force_the_radius():
    spike = single([[0, 0, 0], [1, 0.05, 0], [1, -0.05, 0], [1, 0, 0.09]])
    found = floor_of(spike)
    assert found["max_radius_over_edge"] > 3.0
    assert found["radius_above_floor"] == found["radius_forced"] == 1
    blunt = floor_of(spike, kuhn_cube(2))
    assert (blunt["radius_above_floor"], blunt["radius_forced"]) == (1, 0)
