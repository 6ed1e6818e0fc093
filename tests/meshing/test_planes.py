"""Planes of a surface are put right where a file rounded them, and nothing else is."""

import numpy as np
import pytest
from support.builders import kuhn_cube, rotation, sphere_surface

from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.meshing.planes import precision, straightened, straightened_mesh
from wct_plugin.meshing.reference import given_surface, own_boundary


def turned(points, seed=0):
    axes, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return points @ axes.T


def rounded(points, decimals):
    return np.round(points, decimals)


def single(points):
    return points.astype(np.float32).astype(np.float64)


def of(points, triangles, crease_angle=40.0):
    return given_surface(SurfaceMesh(points, np.asarray(triangles)), kuhn_cube(1), crease_angle)


def off_planes(points, on):
    """How far the vertices of each patch are from the plane nearest to them."""
    out = []
    for patch in np.unique(on.strata.patch):
        own = points[np.unique(on.strata.triangles[on.strata.patch == patch])]
        out.append(np.linalg.svd(own - own.mean(axis=0), full_matrices=False)[1][-1])
    return np.array(out)


@pytest.mark.parametrize(("write", "exact"), [(single, 2.0**-24), (lambda x: rounded(x, 6), 5e-7), (lambda x: x, 1e-9)])
@pytest.mark.parametrize("unit", [1.0, 2.0**20])
def test_precision_is_that_of_the_file(write, exact, unit):
    points = write(np.random.default_rng(1).random((200, 3)))
    points[:2] = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]
    assert precision(points / unit, round(np.log2(unit))) == pytest.approx(exact / unit, rel=1e-12)


@pytest.mark.parametrize("largest", [0.7, 1.0, 1.4, 7.0, 70.0])
def test_precision_of_significant_digits_is_that_of_the_largest(largest):
    points = largest * np.random.default_rng(1).random((200, 3))
    written = np.array([float(f"{x:.6g}") for x in points.ravel()]).reshape(-1, 3)
    step = 10.0 ** (np.floor(np.log10(written.max())) - 5)
    assert precision(written) == pytest.approx(step / 2.0, rel=1e-12)


def test_numbers_of_few_digits_are_meant():
    """A grid of twentieths is no cube of nearly plane faces."""
    grid = np.random.default_rng(1).integers(0, 21, (200, 3)) / 20.0
    assert precision(grid) == pytest.approx(1e-9 * np.ptp(grid, axis=0).max())


@pytest.mark.parametrize("write", [single, lambda x: rounded(x, 6), lambda x: x + 1e-9 * np.sin(1e3 * x)])
@pytest.mark.parametrize("seed", [0, 1])
def test_the_faces_of_a_turned_cube_are_planes_again(write, seed):
    cube = kuhn_cube(3)
    points = write(turned(cube.points, seed))
    mesh = TetMesh(points, cube.tets)
    own = own_boundary(mesh, 40.0)
    exact = precision(points)
    assert off_planes(points, own).max() > 0.1 * exact
    straight, on, count = straightened_mesh(mesh, own, exact)
    assert count["planes"] == count["patches"] == 6
    assert count["axis"] == 0
    assert off_planes(on.points, on).max() < 4 * np.finfo(float).eps * 3
    assert np.array_equal(straight.points, on.points)
    inside = own.strata.stratum == 0
    assert np.array_equal(on.points[inside], points[inside])
    apart = np.linalg.norm(on.points - points, axis=1).max()
    assert apart <= 16 * exact
    assert count["moved"] == pytest.approx(apart / own.diagonal)


@pytest.mark.parametrize("write", [single, lambda x: rounded(x, 6), lambda x: x + 1e-7 * np.sin(1e3 * x)])
@pytest.mark.parametrize("size", [1.0, 3e-7, 4e4])
def test_so_are_those_of_one_that_was_rounded_and_then_turned(write, size):
    cube = kuhn_cube(3)
    points = size * (write(turned(cube.points, 1)) @ rotation(2).T)
    mesh = TetMesh(points, cube.tets)
    own = own_boundary(mesh, 40.0)
    assert precision(points) <= 2e-9 * size
    straight, on, count = straightened_mesh(mesh, own, precision(points))
    assert count["planes"] == count["patches"] == 6
    assert off_planes(on.points, on).max() < 4 * np.finfo(float).eps * 3 * size
    assert np.linalg.norm(on.points - points, axis=1).max() <= 4e-6 * size
    assert np.array_equal(straight.points, on.points)


def test_what_bends_by_more_than_rounding_stays_in_a_mesh_with_noise():
    cube = kuhn_cube(8)
    points = cube.points.copy()
    top = points[:, 2] == 1.0
    points[top, 2] += 1e-5 * np.sin(np.pi * points[top, 0]) * np.sin(np.pi * points[top, 1])
    points = single(turned(points)) @ rotation(2).T
    on, count = straightened(own_boundary(TetMesh(points, cube.tets), 40.0), precision(points))
    assert count["planes"] == 5
    middle = (np.abs(cube.points - [0.5, 0.5, 1.0]) < 0.3).all(axis=1) & top
    assert np.array_equal(on.points[middle], points[middle])


def test_planes_of_an_axis_get_one_coordinate_and_exact_ones_keep_theirs():
    cube = kuhn_cube(3)
    noise = 1e-9 * np.random.default_rng(0).normal(size=cube.points.shape)
    noise[cube.points[:, 2] == 0.0, 2] = 0.0
    points = cube.points + noise + [0.1, 0.0, 0.3]
    own = own_boundary(TetMesh(points, cube.tets), 40.0)
    on, count = straightened(own, precision(points))
    assert count["axis"] == 6
    for axis in range(3):
        for side in (0.0, 1.0):
            levels = np.unique(on.points[cube.points[:, axis] == side, axis])
            assert len(levels) == 1
            assert abs(levels[0] - side - [0.1, 0.0, 0.3][axis]) < 2e-9
    floor = cube.points[:, 2] == 0.0
    assert np.array_equal(on.points[floor, 2], points[floor, 2])


def test_what_bends_is_no_plane():
    ball = sphere_surface(400)
    assert straightened(of(single(ball.points), ball.triangles, 80.0), 2.0**-24)[1]["planes"] == 0
    cube = kuhn_cube(8)
    dome = cube.points.copy()
    top = dome[:, 2] == 1.0
    dome[top, 2] += 1e-5 * np.sin(np.pi * dome[top, 0]) * np.sin(np.pi * dome[top, 1])
    dome = single(turned(dome))
    own = own_boundary(TetMesh(dome, cube.tets), 40.0)
    on, count = straightened(own, precision(dome))
    assert count["planes"] == 5
    middle = (np.abs(cube.points - [0.5, 0.5, 1.0]) < 0.3).all(axis=1) & top
    assert np.array_equal(on.points[middle], dome[middle])


def test_vertices_of_four_planes_stay_and_the_planes_go_through_them():
    corners = np.vstack([np.eye(3), -np.eye(3)])
    faces = [[x, y, z] for x in (0, 3) for y in (1, 4) for z in (2, 5)]
    middle = corners[faces].mean(axis=1)
    points = single(turned(np.vstack([corners, middle])))
    triangles = [[f[k], f[(k + 1) % 3], 6 + i] for i, f in enumerate(faces) for k in range(3)]
    surface = of(points, triangles)
    assert off_planes(points, surface).max() > 1e-9
    on, count = straightened(surface, precision(points))
    assert count["planes"] == 8
    assert np.array_equal(on.points[:6], points[:6])
    assert off_planes(on.points, on).max() < 1e-15


def test_patches_of_one_plane_share_it():
    """A face in two halves of other tags, and a step apart from them: no crease between two nearly equal planes."""
    cube = kuhn_cube(4)
    points = single(turned(cube.points))
    facets = cube.topology.boundary
    low = cube.points[facets].mean(axis=1)[:, 0] < 0.5
    tagged = SurfaceMesh(points, facets, low.astype(int))
    on, count = straightened(given_surface(tagged, kuhn_cube(1), 40.0), precision(points))
    assert count["patches"] == 10
    for axis in range(3):
        for side in (0.0, 1.0):
            face = on.points[cube.points[:, axis] == side]
            assert np.linalg.svd(face - face.mean(axis=0), full_matrices=False)[1][-1] < 3e-15


def test_nothing_is_put_right_where_a_tet_would_turn_over():
    cube = kuhn_cube(2)
    points = cube.points.copy()
    center = np.flatnonzero((points == 0.5).all(axis=1))
    points[center] = [0.5, 0.5, 1.0 + 5e-9]  # as flat as the noise
    points[(cube.points == [0.5, 0.5, 1.0]).all(axis=1)] = [0.5, 0.5, 1.0 + 6e-9]
    mesh = TetMesh(points, cube.tets)
    straight, own, count = straightened_mesh(mesh, own_boundary(mesh, 40.0), 1e-9)
    assert straight is mesh
    assert own.points is mesh.points
    assert count["planes"] == 0
