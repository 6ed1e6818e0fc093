"""Vertices move, everything else stays; the counts come from quality.py, which shares nothing with the core."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import ball, cylinder, jittered_cube, kuhn_cube, two_region_cube

from wct_plugin import apply_filter
from wct_plugin.errors import WctError
from wct_plugin.measure import quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import Cells, SurfaceMesh
from wct_plugin.mesh.strata import find_strata
from wct_plugin.reports.report import make_report


def count(mesh, flag):
    return int(getattr(quality.measure(mesh), flag).sum())


@pytest.mark.parametrize("boundary", ["fixed", "slide"])
@pytest.mark.parametrize(("goal", "flag"), [("3wc", "well_centered_3"), ("cwc", "completely_well_centered")])
def test_more_tets_are_well_centered(goal, flag, boundary):
    mesh = jittered_cube(6, 1)
    better, metrics = apply_filter("apply_coord_well_centering", mesh, goal=goal, boundary=boundary)
    assert count(better, flag) > count(mesh, flag)
    assert count(better, "well_centered_3") >= count(mesh, "well_centered_3")
    assert metrics["bad_after"] == len(mesh.tets) - count(better, flag)
    assert np.array_equal(better.tets, mesh.tets)
    assert better.repairs.flipped == mesh.repairs.flipped


def test_the_input_stays_as_it_is():
    mesh = jittered_cube(5, 2)
    points = mesh.points.copy()
    apply_filter("apply_coord_well_centering", mesh)
    assert np.array_equal(mesh.points, points)


def test_a_fixed_boundary_keeps_its_bits():
    mesh = ball(5)
    better, _ = apply_filter("apply_coord_well_centering", mesh, boundary="fixed")
    on_boundary = mesh.topology.boundary_points
    assert np.array_equal(better.points[on_boundary], mesh.points[on_boundary])
    assert not np.array_equal(better.points, mesh.points)


def test_sliding_keeps_planes_and_creases_and_corners():
    mesh = jittered_cube(6, 3)
    better, _ = apply_filter("apply_coord_well_centering", mesh, boundary="slide")
    sides = np.isclose(mesh.points, mesh.points.min(axis=0)) | np.isclose(mesh.points, mesh.points.max(axis=0))
    assert np.abs((better.points - mesh.points)[sides]).max() <= 1e-12
    assert np.abs((better.points - mesh.points)[mesh.topology.boundary_points]).max() > 1e-3
    assert quality.volumes(better.points, better.tets).sum() == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("name", ["ball", "cylinder"])
@pytest.mark.parametrize("options", [{}, {"tolerance": 5e-3}])
def test_a_curved_boundary_stays_within_the_tolerance(name, options):
    mesh = {"ball": ball(4), "cylinder": cylinder(24, 5)}[name]
    better, metrics = apply_filter("apply_coord_well_centering", mesh, goal="3wc", **options)
    tolerance = options.get("tolerance", 1e-3)
    diagonal = np.linalg.norm(np.ptp(mesh.points, axis=0))
    was, now = (SurfaceMesh(m.points, m.topology.boundary) for m in (mesh, better))
    assert 0 < measure_deviation(was, now, spacing=0.02).max <= tolerance * diagonal
    area = np.linalg.norm(np.cross(*np.moveaxis(np.diff(was.points[was.triangles], axis=1), 1, 0)), axis=1).sum() / 2
    volume_was, volume_now = (quality.volumes(m.points, m.tets).sum() for m in (mesh, better))
    assert abs(volume_now - volume_was) <= area * tolerance * diagonal
    assert metrics["bad_after"] < metrics["bad_before"]


def test_without_a_tolerance_a_curved_boundary_goes_further():
    mesh = ball(4)
    near, far = (
        apply_filter("apply_coord_well_centering", mesh, goal="3wc", tolerance=t)[0].points for t in (1e-3, None)
    )
    volumes = [quality.volumes(points, mesh.tets).sum() for points in (mesh.points, near, far)]
    assert volumes[2] < 0.995 * volumes[0]
    assert volumes[1] > 0.995 * volumes[0]


@pytest.mark.parametrize("mesh", [jittered_cube(5, 3), two_region_cube(4)], ids=["cube", "two regions"])
def test_plane_boundaries_know_no_tolerance(mesh):
    near, far = (apply_filter("apply_coord_well_centering", mesh, tolerance=t)[0].points for t in (1e-6, None))
    assert np.array_equal(near, far)


@pytest.mark.parametrize("tolerance", [0.0, -1e-3, 0.2, float("nan")])
def test_a_tolerance_out_of_range_is_refused(tolerance):
    with pytest.raises(WctError, match="tolerance"):
        apply_filter("apply_coord_well_centering", jittered_cube(3), tolerance=tolerance)


def test_regions_and_their_interface_stay():
    mesh = two_region_cube(5)
    better, _ = apply_filter("apply_coord_well_centering", mesh, boundary="slide")
    for tag in np.unique(mesh.regions):
        old, new = (quality.volumes(m.points, m.tets)[m.regions == tag].sum() for m in (mesh, better))
        assert new == pytest.approx(old, rel=1e-12)
    assert np.array_equal(better.topology.interfaces, mesh.topology.interfaces)


def test_tags_sets_and_data_travel():
    mesh = jittered_cube(4, 4)
    facets = Cells(mesh.topology.boundary[:5], tags=[7] * 5, sets={"inlet": [0, 3]})
    mesh = replace(mesh, facets=facets, point_data={"t": np.arange(len(mesh.points))}, point_sets={"probe": [2]})
    better, _ = apply_filter("apply_coord_well_centering", mesh)
    assert np.array_equal(better.facets.tags, facets.tags)
    assert np.array_equal(better.facets.sets["inlet"], [0, 3])
    assert np.array_equal(better.point_data["t"], mesh.point_data["t"])
    assert np.array_equal(better.point_sets["probe"], [2])


def test_a_tagged_vertex_and_a_tagged_edge_hold():
    mesh = jittered_cube(6, 5)
    surface = find_strata(mesh)
    free = np.flatnonzero(surface.stratum == 1)
    edges = mesh.topology.edges
    between = edges[np.isin(edges, free).all(axis=1)]
    on_surface = {tuple(sorted(pair)) for f in surface.triangles for pair in zip(f, np.roll(f, 1), strict=True)}
    edge = next(e for e in between if tuple(e) in on_surface)
    node = next(v for v in free if v not in edge)
    tagged = replace(mesh, edges=Cells([edge], tags=[1]), nodes=Cells([[node]], tags=[2]))
    better, _ = apply_filter("apply_coord_well_centering", tagged, boundary="slide")
    assert np.array_equal(better.points[node], mesh.points[node])
    assert np.array_equal(better.points[edge], mesh.points[edge])  # both ends of a chain of one edge are corners


def test_the_same_bits_twice():
    mesh = jittered_cube(5, 6)
    first, second = (apply_filter("apply_coord_well_centering", mesh)[0].points for _ in range(2))
    assert np.array_equal(first, second)


def test_progress_can_stop_it_and_the_best_so_far_is_kept():
    mesh = jittered_cube(6, 7)
    seen = []

    def stop(state):
        seen.append(state)
        return len(seen) < 3

    better, metrics = apply_filter("apply_coord_well_centering", mesh, progress=stop)
    assert metrics["stopped"]
    assert len(seen) == 3
    assert all(0.0 <= state.done <= 1.0 and state.bad is not None for state in seen)
    assert count(better, "well_centered_3") >= count(mesh, "well_centered_3")


def test_an_exception_in_progress_comes_through():
    def fail(state):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        apply_filter("apply_coord_well_centering", jittered_cube(5, 8), progress=fail)


def test_it_says_what_the_connectivity_rules_out():
    mesh = kuhn_cube(2)
    for boundary in ("slide", "fixed"):
        better, metrics = apply_filter("apply_coord_well_centering", mesh, goal="cwc", boundary=boundary)
        left = metrics["remaining"]
        assert left["count"] == metrics["bad_after"] > 0
        assert left["proven"] > 0
        assert all(kind["option"].endswith("filters.meshing_well_centered") for kind in left["reasons"])
        report = make_report(better, found=metrics)
        assert len(report.why()) == len(left["reasons"])


def test_volumes_and_groups_that_change_by_too_much_are_losses():
    mesh = ball(4)
    mesh = replace(mesh, facets=Cells(mesh.topology.boundary, np.full(len(mesh.topology.boundary), 7)))
    _, metrics = apply_filter("apply_coord_well_centering", mesh, goal="3wc", tolerance=0.05)
    ((tag, volume),) = metrics["volumes"].items()
    change = volume["change"]
    assert change < -0.005
    assert {(loss["kind"], loss["name"]) for loss in metrics["losses"]} == {("volume", tag), ("group", "7")}
    assert f"{100 * change:+.2f} %" in metrics["losses"][0]["text"]
    _, metrics = apply_filter("apply_coord_well_centering", jittered_cube(3, 1), goal="3wc")
    assert metrics["losses"] == []
    assert metrics["volumes"][tag]["change"] == pytest.approx(0.0, abs=1e-12)
