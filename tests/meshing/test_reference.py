"""What a resampled mesh is held against: how exact it is, and what is mended in a surface from elsewhere."""

import numpy as np
import pytest
from support.builders import ball, interleaved_ball, kuhn_cube, sphere_surface, two_region_cube

from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.triangle_surfaces import enclosed_volume
from wct_plugin.meshing.followed_surface import enclosed_volumes
from wct_plugin.meshing.reference import TOLERANCE, given_surface, own_boundary
from wct_plugin.meshing.reference_fit import bounds, clean, facing_out, gap, near


def _sag(points, triangles):
    """What the default tolerance is, where it is more than the least: a length."""
    surface = SurfaceMesh(points, triangles)
    reference = given_surface(surface, kuhn_cube(1), 60.0)
    return reference.auto_tolerance() * reference.diagonal


@pytest.mark.parametrize("count", [100, 400])
def test_the_tolerance_of_a_sphere_is_about_its_sag(count):
    surface = sphere_surface(count)
    sag = 1.0 - np.linalg.norm(surface.points[surface.triangles].mean(axis=1), axis=1)
    assert 0.8 * sag.max() <= _sag(surface.points, surface.triangles) <= 1.25 * sag.max()


@pytest.mark.parametrize("sides", [12, 32, 90])
@pytest.mark.parametrize("stretch", [0.3, 1.0, 20.0])
def test_the_tolerance_of_strips_is_the_sag_across_them(sides, stretch):
    """The facets of a cylinder's tessellation are as long as it is, and lie 1 - cos(pi / n) within it at most."""
    turn = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn])
    points = np.vstack([ring, ring + np.array([0.0, 0.0, 2.0 * stretch])])
    here = np.arange(sides)
    after = (here + 1) % sides
    triangles = np.vstack(
        [np.column_stack([here, after, after + sides]), np.column_stack([here, after + sides, here + sides])]
    )
    turned = np.random.default_rng(0).random(len(triangles)) < 0.5  # as the facets of a sheet inside may be
    triangles[turned] = triangles[turned, ::-1]
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    sag = 1.0 - np.cos(np.pi / sides)
    assert _sag(points, triangles) == pytest.approx(max(sag, TOLERANCE * diagonal), rel=0.02)


def test_the_tolerance_of_a_saddle_is_its_sag():
    """Facets of z = c x y leave it by c h^2 / 4 in the middle of the diagonals of squares of side h, c being small."""
    steps, bend = 8, 0.05
    x, y = np.meshgrid(np.arange(steps + 1.0), np.arange(steps + 1.0), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), bend * (x * y).ravel()])
    first = (np.arange(steps)[:, None] * (steps + 1) + np.arange(steps)).ravel()
    triangles = np.vstack(
        [
            np.column_stack([first, first + steps + 1, first + steps + 2]),
            np.column_stack([first, first + steps + 2, first + 1]),
        ]
    )
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    assert _sag(points, triangles) == pytest.approx(max(bend / 4.0, TOLERANCE * diagonal), rel=0.1)


def test_flat_faces_have_the_least_tolerance():
    assert own_boundary(kuhn_cube(3), 40.0).auto_tolerance() == TOLERANCE


def test_sides_of_an_interface():
    reference = own_boundary(two_region_cube(2), 40.0)
    assert np.array_equal(reference.regions, [1, 2])
    inner = reference.sides[:, 1] >= 0
    assert inner.sum() == 1
    assert sorted(reference.sides[inner][0]) == [0, 1]
    assert len(reference.corners) == 12


def test_a_given_surface_is_cleaned():
    whole = sphere_surface(80)
    soup = whole.points[whole.triangles].reshape(-1, 3)
    triangles = np.arange(len(soup)).reshape(-1, 3)
    flat = [[0, 1, 0], [3, 3, 4]]
    twice = triangles[:1]
    given = SurfaceMesh(soup, np.concatenate([triangles[:, ::-1], flat, twice]))
    reference = given_surface(facing_out(clean(given), own_boundary(ball(3), 60.0)), ball(3), 60.0)
    assert len(reference.points) == 80
    assert len(reference.strata.triangles) == len(whole.triangles)
    outward = enclosed_volume(whole.points, whole.triangles)
    assert enclosed_volume(reference.points, reference.strata.triangles) == pytest.approx(outward, rel=1e-12)
    assert (reference.strata.patch == 0).all()
    assert np.array_equal(reference.sides, [[0, -1]])


def test_a_surface_faces_out_of_the_mesh_however_its_triangles_run():
    """A cube with a cavity, on a surface with a loose piece within the cube that no facet of the mesh is near."""
    cube = kuhn_cube(6)
    hollow = TetMesh(cube.points, cube.tets[np.abs(cube.points[cube.tets].mean(axis=1) - 0.5).max(axis=1) > 1 / 6])
    own = own_boundary(hollow, 40.0)
    outward = hollow.boundary_surface()
    assert enclosed_volume(outward.points, outward.triangles) == pytest.approx(26 / 27, rel=1e-12)
    turned = np.random.default_rng(0).random(len(outward.triangles)) < 0.5
    given = SurfaceMesh(outward.points, np.where(turned[:, None], outward.triangles[:, ::-1], outward.triangles))
    assert np.array_equal(facing_out(given, own).triangles, outward.triangles)
    loose = sphere_surface(60, 0.02)
    both = _with_more(given, loose.points + 0.25, loose.triangles)
    assert np.array_equal(facing_out(both, own).triangles[len(turned) :], both.triangles[len(turned) :])


def _with_more(surface, points, triangles):
    return SurfaceMesh(
        np.concatenate([surface.points, points]),
        np.concatenate([surface.triangles, np.asarray(triangles) + len(surface.points)]),
    )


def test_a_surface_bounds_a_mesh_unless_it_has_holes_runs_on_inside_or_is_not_all_there():
    mesh, surface = ball(4), sphere_surface(400)
    own = own_boundary(mesh, 60.0)
    small = sphere_surface(60, 0.4)
    opened = SurfaceMesh(surface.points, surface.triangles[1:])
    inside = _with_more(surface, small.points, small.triangles)
    assert bounds(clean(surface), own)
    assert not bounds(clean(opened), own)
    assert not bounds(clean(inside), own)
    speck = SurfaceMesh(surface.points[0] + 1e-3 * small.points, small.triangles)  # in metres, not in millimetres
    assert not bounds(clean(speck), own)


def test_near_is_measured_by_the_edges_around():
    """A facet no longer than .14 among some of .55 to .79: what the mesher left out there is as large as those."""
    grid = kuhn_cube(5)
    mesh = TetMesh(np.interp(grid.points, [0.0, 0.4, 0.6, 1.0], [0.0, 0.45, 0.55, 1.0]), grid.tets)
    own, boundary = own_boundary(mesh, 40.0), mesh.boundary_surface()
    centers = boundary.points[boundary.triangles].mean(axis=1)
    middle = np.flatnonzero((centers[:, 2] == 1.0) & (np.abs(centers[:, :2] - 0.5).max(axis=1) < 0.05))
    corners = boundary.points[boundary.triangles[middle[:1]]].reshape(3, 3)
    assert len(middle) == 2
    for off, within in ((0.0, True), (0.1, True), (0.2, False)):
        above = SurfaceMesh(corners + np.array([0.0, 0.0, off]), np.array([[0, 1, 2]]))
        assert near(above, own, 0.5).tolist() == [within]


def test_the_gap_is_what_lies_between_mesh_and_surface():
    mesh = kuhn_cube(4)
    own = own_boundary(mesh, 40.0)
    boundary = mesh.boundary_surface()
    shifted = SurfaceMesh(boundary.points + np.array([1e-3, 0.0, 0.0]), boundary.triangles)
    assert gap(own, shifted, 5e-3) == pytest.approx(1e-3, rel=1e-6)
    assert gap(own, shifted, 1.5e-3) == pytest.approx(0.75e-3, rel=1e-6)


def test_facets_that_lead_to_the_fill_of_a_hole_are_no_gap():
    """A sphere without its cap, and a ball whose boundary closes the hole a little inside."""
    mesh, whole = ball(4), sphere_surface(2000)
    own = own_boundary(mesh, 60.0)
    sag = gap(own, whole, 0.1)
    cap = whole.points[whole.triangles].mean(axis=1)[:, 2] > 0.8
    opened = SurfaceMesh(whole.points, whole.triangles[~cap])
    assert gap(own, opened, 0.1) <= 1.01 * sag < 0.05


@pytest.mark.parametrize("seed", range(3))
def test_the_reference_knows_what_is_behind_and_before_each_patch(seed):
    mesh = interleaved_ball(seed)
    corners = mesh.points[mesh.tets]
    inside = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0
    volumes = enclosed_volumes(own_boundary(mesh, 40.0))
    for tag in (0, 1):
        assert volumes[str(tag)] == pytest.approx(inside[mesh.regions == tag].sum(), rel=1e-12)
