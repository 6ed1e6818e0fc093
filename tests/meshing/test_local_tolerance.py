"""The tolerance place by place: closed forms for walls, gaps, radii and wedges."""

import numpy as np
import pytest
from support.builders import kuhn_grid

from wct_plugin.core import _core
from wct_plugin.core.domain import StratifiedSurface
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.meshing.local_tolerance import describe, find_tolerance
from wct_plugin.meshing.reference import given_surface, own_boundary
from wct_plugin.meshing.reference_fit import apart_at


def _box(low, high):
    """Twelve triangles that face out of a box, each side a patch, each edge a curve."""
    points = np.array([[(low, high)[k >> a & 1][a] for a in range(3)] for k in range(8)], dtype=float)
    quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    edges = np.array([(i, i | 1 << a) for i in range(8) for a in range(3) if not i >> a & 1])
    return points, triangles, np.repeat(np.arange(6), 2), edges


def _joined(*boxes):
    points, triangles, patch, edges = [], [], [], []
    for n, (p, t, q, e) in enumerate(boxes):
        points.append(p), triangles.append(t + 8 * n), patch.append(q + 6 * n), edges.append(e + 8 * n)
    return np.concatenate(points), np.concatenate(triangles), np.concatenate(patch), np.concatenate(edges)


def _local(points, triangles, patch, edges, most, floor=0.0):
    sides = np.tile([0, -1], (patch.max() + 1, 1))
    surface = StratifiedSurface(points, triangles, patch, edges, np.arange(len(edges)), sides)
    return _core.local_tolerance(surface, tolerance=most, floor=floor)


@pytest.mark.parametrize("thickness", [0.02, 0.05])
def test_a_plate_is_held_within_a_tenth_of_its_thickness(thickness):
    found = _local(*_box((0, 0, 0), (1, 1, thickness)), most=0.02)
    assert found == pytest.approx(np.full(8, thickness / 10))


def test_no_less_than_the_floor_and_no_more_than_the_global_one():
    assert _local(*_box((0, 0, 0), (1, 1, 0.02)), most=0.01, floor=0.005) == pytest.approx(np.full(8, 0.005))
    assert (_local(*_box((0, 0, 0), (1, 1, 1)), most=0.01) == 0.01).all()


def test_a_gap_between_two_bodies_counts_as_a_wall_does():
    found = _local(*_joined(_box((0, 0, 0), (1, 1, 1)), _box((0, 0, 1.03), (1, 1, 2.03))), most=0.01)
    facing = [4, 5, 6, 7, 8, 9, 10, 11]
    assert found[facing] == pytest.approx(np.full(8, 0.003))
    assert (np.delete(found, facing) == 0.01).all()  # the far sides are thick


def _cylinder(radius, n, height, inward):
    """The side of a cylinder, one patch without ends."""
    turn = 2 * np.pi * np.arange(n) / n
    layers = 5
    points = np.concatenate(
        [
            np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(n, height * k / (layers - 1))])
            for k in range(layers)
        ]
    )
    triangles = []
    for k in range(layers - 1):
        for i in range(n):
            a, b, c, d = k * n + i, k * n + (i + 1) % n, (k + 1) * n + (i + 1) % n, (k + 1) * n + i
            triangles += [(a, b, c), (a, c, d)]
    triangles = np.array(triangles)
    return points, triangles[:, ::-1].copy() if inward else triangles, np.zeros(len(triangles), dtype=np.int64)


@pytest.mark.parametrize("inward", [False, True], ids=["rod", "hole"])
def test_round_a_rod_or_a_hole_the_radius_counts(inward):
    found = _local(*_cylinder(0.1, 32, 1.0, inward), np.empty((0, 2), dtype=np.int64), most=0.05)
    assert found == pytest.approx(np.full(len(found), 0.01), rel=0.02)


def test_a_tube_is_held_by_its_wall():
    outer, inner = _cylinder(0.1, 32, 1.0, False), _cylinder(0.085, 32, 1.0, True)
    points = np.concatenate([outer[0], inner[0]])
    triangles = np.concatenate([outer[1], inner[1] + len(outer[0])])
    patch = np.concatenate([outer[2], inner[2] + 1])
    found = _local(points, triangles, patch, np.empty((0, 2), dtype=np.int64), most=0.05)
    assert found == pytest.approx(np.full(len(found), 0.0015), rel=0.02)


def test_no_wall_where_two_sides_meet_at_a_sharp_edge():
    points = np.array([[0, 0, 0], [0, 1, 0], [1, 0, -0.1], [1, 1, -0.1], [1, 0, 0.1], [1, 1, 0.1]], dtype=float)
    triangles = np.array([[0, 4, 1], [4, 5, 1], [0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5], [0, 2, 4], [1, 5, 3]])
    edges = np.array([[0, 1], [0, 2], [0, 4], [1, 3], [1, 5], [2, 3], [4, 5], [2, 4], [3, 5]])
    found = _local(points, triangles, np.array([0, 0, 1, 1, 2, 2, 3, 4]), edges, most=0.02)
    assert (found == 0.02).all()


def _plate():
    """One of .04, eight cells wide, and its own boundary."""
    grid = kuhn_grid((8, 8, 1))
    extent = np.ptp(grid.points, axis=0)
    mesh = TetMesh(grid.points * np.array([1.0, 1.0, 0.04]) / extent, grid.tets)
    return mesh, own_boundary(mesh, 40.0)


def _with_tip(mesh, height):
    """Its surface with the vertex in the middle of the top higher; the points at triangles with that."""
    surface = mesh.boundary_surface()
    tip = int(np.argmin(np.linalg.norm(surface.points - np.array([0.5, 0.5, 0.04]), axis=1)))
    points = surface.points.copy()
    points[tip, 2] += height
    beside = np.unique(surface.triangles[(surface.triangles == tip).any(axis=1)])
    return SurfaceMesh(points, surface.triangles), beside


def test_how_far_the_mesh_came_from_a_tip_that_its_mesher_left_out():
    mesh, own = _plate()
    surface, beside = _with_tip(mesh, 0.01)
    on = given_surface(surface, mesh, 40.0)
    near = np.linalg.norm(on.points[:, None] - surface.points[beside], axis=2).min(axis=1) < 1e-12
    apart = apart_at(on, own)
    assert near.sum() == len(beside) == 7
    assert apart[near] == pytest.approx(np.full(7, 0.01))
    assert (apart[~near] < 1e-15).all()


def test_the_tolerance_is_no_less_than_how_far_the_mesh_came_there():
    mesh, own = _plate()
    most = 0.012  # a quarter is .003, a tenth of the plate .004
    on = given_surface(_with_tip(mesh, 0.01)[0], mesh, 40.0)
    apart = apart_at(on, own)
    exact, lifted = find_tolerance(on, most).local, find_tolerance(on, most, 0.0, own).local
    assert exact.min() == pytest.approx(0.004)
    assert (lifted == np.maximum(exact, apart)).all()
    assert (lifted > exact).sum() == 7
    assert find_tolerance(on, 0.008, 0.0, own).local.max() == 0.008  # and no more than is asked for


def test_a_coarse_default_and_a_small_place_are_named():
    assert describe(1e-3, True, None) == ""
    assert "3.6e-03" in describe(3.6e-3, True, None)
    assert describe(3.6e-3, False, None) == ""
    assert "near (1, 2, 3)" in describe(1e-3, True, {"least": 2.5e-4, "at": [1.0, 2.0, 3.0]})
