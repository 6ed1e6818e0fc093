"""The local search: fewer bad tets, and whatever happens a valid mesh with the surface it had."""

from copy import deepcopy
from dataclasses import fields

import numpy as np
import pytest
from support.builders import ball, cylinder, jittered_cube, sphere_surface
from support.core_meshes import FACETS, NO_SEGMENTS
from support.searching import arguments, bad, check_valid, rows, search

from wct_plugin.core import _core
from wct_plugin.core.requests import SearchOptions
from wct_plugin.measure import quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.topology import Topology
from wct_plugin.mesh.triangle_surfaces import enclosed_volume


def places(points, cells):
    """Cells by where their points are, not by number."""
    return {tuple(sorted(map(tuple, points[cell].tolist()))) for cell in cells}


@pytest.mark.parametrize("mesh", [jittered_cube(3, 1), ball(3)], ids=["cube", "ball"])
def test_fewer_tets_are_bad_and_the_mesh_is_valid(mesh):
    found = search(mesh)
    check_valid(found)
    assert found.bad < bad(mesh.points, mesh.tets)
    assert found.bad >= bad(found.mesh.points, found.mesh.tets)  # a tet far from its best counts, too
    assert found.passes <= 2
    assert found.evaluations > 0


@pytest.mark.parametrize(("mesh", "curved"), [(jittered_cube(3, 1), False), (ball(3), True)], ids=["cube", "ball"])
def test_looks_at_curved_surfaces_are_work_too(mesh, curved):
    found = search(mesh)
    assert (found.work > found.evaluations) == curved
    assert (found.work - found.evaluations) % 20 == 0


@pytest.mark.parametrize("mesh", [jittered_cube(3, 1), ball(3)], ids=["cube", "ball"])
def test_it_ends_where_its_work_does(mesh):
    whole = search(mesh)
    half = search(mesh, most_work=whole.work // 2)
    assert half.work < 0.9 * whole.work  # a kick, or a pass, is carried to its end
    assert half.bad >= whole.bad


def test_flat_faces_keep_the_volume_and_the_box():
    mesh = jittered_cube(3, 2)
    found = search(mesh)
    assert quality.volumes(found.mesh.points, found.mesh.tets).sum() == pytest.approx(1.0, abs=1e-12)
    triangles = Topology(found.mesh.tets, found.mesh.regions, len(found.mesh.points)).boundary
    assert enclosed_volume(found.mesh.points, triangles) == pytest.approx(1.0, abs=1e-12)
    assert np.abs(np.clip(found.mesh.points, 0, 1) - found.mesh.points).max() <= 1e-12


@pytest.mark.parametrize(("far", "pinned"), [(100.0, False), (100.0, True), (1.0, False)])
def test_corners_of_a_small_feature_move_within_half_the_tolerance(far, pinned):
    """A cube of 24 tolerances, less than 3 % of a surface with a point far away; without that one it is the shape."""
    mesh, tolerance = jittered_cube(3, 2), 0.06
    given, _ = arguments(mesh)
    corner = given.stratum == 3
    change = {
        "surface_points": np.vstack([mesh.points, np.full((1, 3), far)]),
        "label": np.where(corner, -1 if pinned else np.arange(len(corner)), given.label),
    }
    found = search(mesh, change=change, tolerance=tolerance)
    check_valid(found)
    corners = found.mesh.points[found.mesh.stratum == 3]
    moved = np.linalg.norm(corners - np.round(corners), axis=1)
    assert rows(np.round(corners)) == rows(mesh.points[corner])
    assert moved.max() <= tolerance / 2 + 1e-12
    assert (moved.max() > 1e-3) == (far == 100.0 and not pinned)


@pytest.mark.parametrize("seed", [2, 3])
def test_a_point_where_creases_cross_is_not_taken_away(seed):
    """Every boundary edge between points of two creases is one as well: without its end it would be left over."""
    mesh = jittered_cube(3, seed)
    given, _ = arguments(mesh)
    ends = given.facets[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    between = rows(ends[(given.stratum[ends] == 2).all(axis=1)]) - rows(given.creases)
    more = np.array(sorted(between))
    curve = np.append(given.crease_curve, given.label[more[:, 0]])
    found = search(mesh, change={"creases": np.concatenate([given.creases, more]), "crease_curve": curve})
    check_valid(found)
    assert len(found.mesh.creases) >= len(more)


def near_sphere(mesh, count=2000):
    """Change the surface to stay near to a fine sphere."""
    sphere = sphere_surface(count)
    return sphere, {
        "label": np.zeros(len(mesh.points), dtype=np.int64),
        "surface_points": sphere.points,
        "surface_triangles": sphere.triangles,
        "surface_patch": np.zeros(len(sphere.triangles), dtype=np.int64),
        "surface_segments": np.zeros((0, 2), dtype=np.int64),
        "surface_curve": np.zeros(0, dtype=np.int64),
    }


def apart(found, surface):
    used, place = np.unique(found.mesh.facets, return_inverse=True)
    return measure_deviation(SurfaceMesh(found.mesh.points[used], place.reshape(-1, 3)), surface, 0.01)


@pytest.mark.parametrize("tolerance", [0.03, 0.1])
def test_coarse_facets_stay_within_the_tolerance_both_ways(tolerance):
    mesh = ball(4)  # its own facets bend by 12 degrees at their edges: chords would cut these off
    found = search(mesh, tolerance=tolerance, kicks=50)
    check_valid(found)
    assert len(rows(found.mesh.facets) ^ rows(mesh.topology.boundary)) > 10
    between = apart(found, mesh.boundary_surface())
    assert max(between.max_ab, between.max_ba) <= tolerance


def test_facets_too_far_away_come_nearer():
    mesh = ball(3)
    sphere, change = near_sphere(mesh)
    before = measure_deviation(mesh.boundary_surface(), sphere, 0.01).max
    tolerance = 0.7 * before
    found = search(mesh, change=change, tolerance=tolerance, passes=6, kicks=100)
    check_valid(found)
    assert before > tolerance
    assert apart(found, sphere).max <= tolerance


def test_facets_end_as_much_before_the_surface_as_behind_it():
    mesh = ball(3)
    sphere, change = near_sphere(mesh)
    full = enclosed_volume(sphere.points, sphere.triangles)
    found = search(mesh, change=change, tolerance=0.06)
    assert quality.volumes(mesh.points, mesh.tets).sum() < 0.95 * full
    assert quality.volumes(found.mesh.points, found.mesh.tets).sum() == pytest.approx(full, rel=5e-3)


@pytest.mark.parametrize("n", [2, 3])
def test_no_tet_gives_the_goal_up_for_the_margins_of_others(n):
    mesh = ball(n)
    assert search(mesh, passes=6, kicks=400, margin=2e-3).bad == 0
    found = search(mesh, passes=6, kicks=400, margin=0.1)  # more than it can get everywhere
    check_valid(found)
    assert bad(found.mesh.points, found.mesh.tets) == found.bad == 0


def expect_same_bits(first, second):
    for one, other in ((first, second), (first.mesh, second.mesh)):
        for field in fields(one):
            if field.name != "mesh":
                assert np.array_equal(getattr(one, field.name), getattr(other, field.name)), field.name


def test_the_same_bits_twice():
    mesh = jittered_cube(3, 3)
    expect_same_bits(search(mesh, seed=4), search(mesh, seed=4))


@pytest.mark.parametrize("mesh", [jittered_cube(3, 0), ball(3)])
def test_any_number_of_threads_gives_the_same_bits(mesh):
    of, on = arguments(mesh)
    options = SearchOptions(tolerance=0.05, passes=6, kicks=100)
    runs = [_core.search_well_centered(of, on, options, threads=threads) for threads in (1, 2, 5)]
    assert runs[0].kicks > 5
    for run in runs[1:]:
        expect_same_bits(runs[0], run)


def test_the_input_stays_as_it_is():
    mesh = jittered_cube(3, 3)
    before = [deepcopy(vars(one)) for one in arguments(mesh)]
    search(mesh)
    for one, other in zip(arguments(mesh), before, strict=True):
        for name, values in vars(one).items():
            assert np.array_equal(values, other[name]), name


def test_progress_can_stop_it():
    mesh = jittered_cube(3, 4)
    heard = []

    def listen(phase, done, count):
        heard.append((phase, done, count))
        return len(heard) < 2

    found = search(mesh, progress=listen)
    assert len(heard) == 2
    assert found.stopped
    assert heard[0][0] == "passes"
    assert heard[0][2] >= bad(mesh.points, mesh.tets)
    assert found.bad <= heard[0][2]
    check_valid(found)


def test_a_listener_that_says_nothing_does_not_stop_it():
    assert not search(jittered_cube(3, 4), passes=1, kicks=0, progress=lambda *_: None).stopped


def test_an_exception_in_progress_comes_through():
    def fail(phase, done, count):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        search(jittered_cube(3, 4), progress=fail)


def test_without_flips_and_splits_boundary_facets_stay():
    mesh = jittered_cube(3, 5)
    found = search(mesh, pinned=True, flip_surface=False, split_surface=False)
    check_valid(found)
    assert places(found.mesh.points, found.mesh.facets) == places(mesh.points, mesh.topology.boundary)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"points": np.zeros((64, 2))}, r"points has shape \(64, 2\); allowed is \(n, 3\)"),
        ({"points": np.full((64, 3), np.nan)}, "point 0 is not finite"),
        ({"tets": np.array([[0, 1, 2, 64]])}, "tets names point 64; there are 64"),
        ({"regions": np.zeros(3, dtype=np.int64)}, "regions has length 3"),
        ({"stratum": np.full(64, 4, dtype=np.int8)}, "stratum 4; allowed are 0, 1, 2 and 3"),
        ({"label": np.full(64, 99)}, "label of point .* is 99; there are "),
        ({"size": np.zeros(64)}, "size holds 0.0+; it must be positive"),
        ({"facets": np.zeros((0, 3), dtype=np.int64)}, "facet_patch has length"),
        ({"creases": np.array([[0, 64]])}, "creases names point 64"),
        ({"surface_triangles": np.array([[0, 1, 64]])}, "triangles names point 64"),
        ({"surface_segments": np.zeros((2, 3), dtype=np.int64)}, "segments has shape"),
    ],
)
def test_bad_arrays_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        search(jittered_cube(3, 6), change=change)


def test_a_missing_boundary_facet_and_inverted_tets_are_refused():
    mesh = jittered_cube(3, 6)
    given, _ = arguments(mesh)
    less = {"facets": given.facets[1:], "facet_patch": given.facet_patch[1:]}
    with pytest.raises(ValueError, match=r"facets: boundary facet \(.*\) is missing"):
        search(mesh, change=less)
    with pytest.raises(ValueError, match="tet 0 is inverted or flat"):
        search(mesh, change={"tets": mesh.tets[:, [0, 1, 3, 2]].copy()})


@pytest.mark.parametrize("option", [{"tolerance": 0.0}, {"margin": 0.4}, {"passes": -1}])
def test_bad_options_are_refused(option):
    with pytest.raises(ValueError, match=next(iter(option))):
        search(jittered_cube(3, 6), **option)


# --- where the surface stays ----------------------------------------------------------------------------------------


def fixed(mesh, **options):
    return search(mesh, pinned=True, flip_surface=False, split_surface=False, **options)


def test_no_kick_is_spent_on_tets_whose_facets_rule_the_goal_out():
    mesh = cylinder(12, 4)  # all its facets are right or obtuse
    facets = len(arguments(mesh)[0].facets)
    all_out = fixed(mesh, passes=12, kicks=2000, ruled_out=np.arange(facets))
    none_out = fixed(mesh, passes=12, kicks=2000, ruled_out=np.arange(0))
    plain = fixed(mesh, passes=12, kicks=2000)
    assert 3 * all_out.kicks < none_out.kicks
    assert all_out.bad == bad(all_out.mesh.points, all_out.mesh.tets) > 0  # they are counted all the same
    assert len(all_out.stuck) == 0  # no other start would help them
    assert bad(none_out.mesh.points, none_out.mesh.tets[none_out.stuck]) == len(none_out.stuck) == none_out.bad
    assert np.array_equal(none_out.mesh.points, plain.mesh.points)


def test_kicks_stop_where_they_cost_more_than_they_are_worth():
    mesh = ball(3)
    nothing, all_of_it = (fixed(mesh, kicks=2000, worth=worth) for worth in (0.0, np.inf))
    assert nothing.kicks <= 1
    assert all_of_it.kicks > 10
    assert all_of_it.bad < nothing.bad


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"ruled_out": np.array([0])}, "ruled_out is for facets that stay"),
        ({"ruled_out": np.array([10**6]), "flip_surface": False, "split_surface": False}, "ruled_out holds 1000000"),
        ({"worth": -1.0}, "worth is -1.0"),
    ],
)
def test_what_cannot_be_ruled_out_or_worth_is_refused(options, message):
    with pytest.raises(ValueError, match=message):
        search(jittered_cube(2), **options)


def test_numbers_of_patches_and_curves_may_be_left_out():
    mesh = jittered_cube(3)
    given, on = arguments(mesh)
    shared = given.stratum == 1, given.stratum == 2
    apart = {
        "label": np.select(shared, (2 * given.label + 1, 3 * given.label), given.label),
        "facet_patch": 2 * given.facet_patch + 1,
        "surface_patch": 2 * on.patch + 1,
        "surface_sides": NO_SEGMENTS,
        "crease_curve": 3 * given.crease_curve,
        "surface_curve": 3 * on.curve,
    }
    plain, found = search(mesh), search(mesh, change=apart)
    assert np.array_equal(found.mesh.points, plain.mesh.points)
    assert np.array_equal(found.mesh.facet_patch, 2 * plain.mesh.facet_patch + 1)
    assert np.array_equal(found.mesh.crease_curve, 3 * plain.mesh.crease_curve)
    on_none = {"facet_patch": (0, "facet_patch holds 0"), "crease_curve": (1, "crease_curve holds 1")}
    for name, (number, message) in on_none.items():
        wrong = apart[name].copy()
        wrong[0] = number
        with pytest.raises(ValueError, match=f"{message}, of which the surface has no piece"):
            search(mesh, change=apart | {name: wrong})
    for stratum, number in ((1, 0), (2, 1)):
        wrong = apart["label"].copy()
        wrong[np.flatnonzero(given.stratum == stratum)[0]] = number
        with pytest.raises(ValueError, match=f"label holds {number}, of which the surface has no piece"):
            search(mesh, change=apart | {"label": wrong})


def facet_counts(tets):
    facets = np.sort(tets[:, FACETS].reshape(-1, 3), axis=1)
    return np.unique(facets, axis=0, return_counts=True)[1]


def test_an_edge_that_overlapping_tets_have_already_is_not_made_again():
    corners = [[np.cos(a), np.sin(a), 0.0] for a in np.radians([0, 120, 240])]
    points = np.array([*corners, [0, 0, -0.2], [0, 0, 0.2], [3, 0.2, 0]])
    pair = np.array([[0, 1, 2, 4], [0, 2, 1, 3]])  # flat: three round the edge 3-4 serve better
    beside = np.array([[0, 3, 4, 5]])  # reaches into the pair, and has that edge
    assert quality.volumes(points, beside)[0] > 0
    alone = search(TetMesh(points[:5], pair), pinned=True, flip_surface=False, split_surface=False)
    assert len(alone.mesh.tets) == 3
    found = search(
        TetMesh(points, np.concatenate([pair, beside])), pinned=True, flip_surface=False, split_surface=False
    )
    assert facet_counts(found.mesh.tets).max() == 2


def test_a_facet_that_an_overlapping_tet_has_already_is_not_made_again():
    corners = [[np.cos(a), np.sin(a), 0.0] for a in np.radians([0, 120, 240])]
    points = np.array([*corners, [0, 0, -1.4], [0, 0, 1.4], [0.1, 0.2, 3]])
    three = np.array([[3, 4, 0, 1], [3, 4, 1, 2], [3, 4, 2, 0]])  # two on the facet 0-1-2 serve better
    beside = np.array([[0, 1, 2, 5]])  # reaches through the three, and has that facet
    assert (quality.volumes(points, np.concatenate([three, beside])) > 0).all()
    alone = search(TetMesh(points[:5], three), pinned=True, flip_surface=False, split_surface=False)
    assert len(alone.mesh.tets) == 2
    found = search(
        TetMesh(points, np.concatenate([three, beside])), pinned=True, flip_surface=False, split_surface=False
    )
    assert facet_counts(found.mesh.tets).max() == 2


def ball_with_an_ear():
    """A dented ball, its own surface as reference, and a mesh of it with a tet more that fills the dent."""
    mesh = ball(3)
    points = mesh.points.copy()
    a, b, r, s = 0, 3, 1, 8
    ear = [a, b, s, r]
    points[[a, b]] *= 0.72
    dented, filled = TetMesh(points, mesh.tets), TetMesh(points, np.vstack([mesh.tets, [ear]]))
    assert (_core.orientation(points, filled.tets) == 1).all()
    surface = {f"surface_{name}": values for name, values in vars(arguments(dented, crease_angle=180.0)[1]).items()}
    assert {tuple(sorted((a, b, r))), tuple(sorted((a, b, s)))} <= rows(surface["surface_triangles"])
    return filled, surface, dented.boundary_surface()


@pytest.mark.parametrize("seed", range(3))
def test_a_tet_that_fills_a_dent_is_cut_off(seed):
    mesh, change, surface = ball_with_an_ear()
    tolerance = 0.05
    assert measure_deviation(mesh.boundary_surface(), surface).max_ab > 3 * tolerance
    asked = {"tolerance": tolerance, "passes": 1, "kicks": 0, "split_surface": False}
    found = search(mesh, change=change, crease=180.0, seed=seed, **asked)
    check_valid(found)
    apart = measure_deviation(SurfaceMesh(found.mesh.points, found.mesh.facets), surface)
    assert max(apart.max_ab, apart.max_ba) < tolerance


@pytest.mark.parametrize(  # where the vertices round the edge settle first, it takes kicks
    ("edge", "tops", "kicks"), [((40, 48), (61, 27), 0), ((59, 67), (80, 46), 0), ((63, 71), (50, 84), 1000)]
)
def test_an_edge_across_a_ridge_is_flipped_onto_it(edge, tops, kicks):
    mesh = ball(3)
    points = mesh.points.copy()
    points[list(tops)] *= 1.15
    mesh = TetMesh(points, mesh.tets)
    triangles = arguments(mesh, crease_angle=180.0)[1].triangles.copy()
    for triangle in triangles:  # turned where they meet along the edge, so that they meet along the ridge
        if set(edge) <= set(triangle):
            i = int(np.flatnonzero(np.isin(triangle, tops))[0])
            triangle[(i + 2) % 3] = sum(tops) - triangle[i]
    surface = SurfaceMesh(points, triangles)
    first, second = (np.cross(*(points[t[1:]] - points[t[0]])) for t in triangles if set(tops) <= set(t))
    assert first @ second < np.cos(np.radians(55)) * np.linalg.norm(first) * np.linalg.norm(second)
    tolerance = 0.02
    assert measure_deviation(mesh.boundary_surface(), surface).max_ab > 3 * tolerance
    asked = {"tolerance": tolerance, "passes": 1, "kicks": kicks, "split_surface": False}
    found = search(mesh, change={"surface_triangles": triangles}, crease=180.0, **asked)
    check_valid(found)
    apart = measure_deviation(SurfaceMesh(found.mesh.points, found.mesh.facets), surface)
    assert max(apart.max_ab, apart.max_ba) < tolerance
