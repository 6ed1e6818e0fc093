"""The goals of the whole mesh, Delaunay and one-sided: reached with the surface's vertices in place, by duals.py."""

import json

import numpy as np
import pytest
from scipy.spatial import Delaunay
from support.builders import ball, cylinder, jittered_cube, kuhn_cube, kuhn_grid, l_shape, rotation, two_region_cube
from support.couples import couples
from support.gmsh_bodies import ball_in_box, layered_box

from wct_plugin import apply_filter
from wct_plugin import write as write_mesh
from wct_plugin.cli import main
from wct_plugin.errors import OptionError, WctWarning
from wct_plugin.measure import duals, quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.measure.goals import misses
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.topology import FACETS


def run(mesh, goal, **options):
    return apply_filter("meshing_well_centered", mesh, goal=goal, **options)


def crooked(n=4):
    """A cube that is not Delaunay: the points of its inside have moved on."""
    return TetMesh(jittered_cube(n, 1, 0.3).points, jittered_cube(n, 1, 0.1).tets)


def places(points, cells):
    return {tuple(sorted(map(tuple, points[cell].tolist()))) for cell in cells}


def area(mesh):
    corners = mesh.points[mesh.topology.boundary]
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2


def region_volumes(mesh):
    return np.bincount(mesh.regions, quality.volumes(mesh.points, mesh.tets))


def negatives(mesh):
    """Duals that are not positive: lengths, areas, volumes."""
    found = duals.compute_duals(mesh)
    signed = (
        (found.lengths, found.errors),
        (found.areas, found.area_errors),
        (found.volumes, found.volume_errors),
    )
    return [int((~(values > errors)).sum()) for values, errors in signed]


TURNED = TetMesh(kuhn_cube(3).points @ rotation(3).T, kuhn_cube(3).tets)
FLAT = {
    "cube": kuhn_cube(3),
    "turned cube": TURNED,
    "one cell": kuhn_cube(1),
    "L": l_shape(2),
    "plate": kuhn_grid((5, 5, 1)),
    "two regions": two_region_cube(4),
    "crooked cube": crooked(),
}


@pytest.mark.parametrize("mesh", FLAT.values(), ids=FLAT.keys())
def test_flat_domains_become_one_sided_and_stay_the_same_solid(mesh):
    assert any(negatives(mesh))
    points, tets = mesh.points.copy(), mesh.tets.copy()
    better, metrics = run(mesh, "one-sided", boundary="keep")
    assert negatives(better) == [0, 0, 0]
    assert duals.tiers(better).one_sided
    assert metrics["bad"] == metrics["remaining"]["count"] == 0
    assert places(mesh.points, np.unique(mesh.topology.boundary)[:, None]) <= places(
        better.points, np.unique(better.topology.boundary)[:, None]
    )
    assert area(better) == pytest.approx(area(mesh), rel=1e-9)
    np.testing.assert_allclose(region_volumes(better), region_volumes(mesh), rtol=1e-9)
    assert np.isin(np.arange(len(better.points)), better.tets).all()
    ends = np.sort(better.topology.boundary[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(ends, axis=0, return_counts=True)[1] == 2).all()
    np.testing.assert_array_equal(mesh.points, points)
    np.testing.assert_array_equal(mesh.tets, tets)


@pytest.mark.parametrize("mesh", [ball(4), cylinder(16, 6)], ids=["ball", "cylinder"])
def test_curved_domains_become_one_sided_within_the_tolerance(mesh):
    assert any(negatives(mesh))
    better, metrics = run(mesh, "one-sided", boundary="keep")
    assert negatives(better) == [0, 0, 0]
    surface = mesh.boundary_surface()
    assert measure_deviation(better.boundary_surface(), surface).max <= metrics["tolerance"] * surface.diagonal
    assert places(mesh.points, np.unique(mesh.topology.boundary)[:, None]) <= places(
        better.points, np.unique(better.topology.boundary)[:, None]
    )


def test_a_mesh_that_has_reached_the_goal_is_left_as_it_is():
    for mesh, goal in ((kuhn_cube(3), "delaunay"), (jittered_cube(5), "one-sided")):
        better, metrics = run(mesh, goal, boundary="move")
        np.testing.assert_array_equal(better.points, mesh.points)
        np.testing.assert_array_equal(better.tets, mesh.tets)
        assert metrics["bad"] == 0


@pytest.mark.parametrize("boundary", ["keep", "move"])
def test_delaunay_takes_the_same_points_joined_anew(boundary):
    mesh = crooked()
    assert not duals.tiers(mesh).delaunay
    better, metrics = run(mesh, "delaunay", boundary=boundary)
    assert duals.tiers(better).delaunay
    assert metrics["bad"] == 0
    assert places(better.points, np.arange(len(better.points))[:, None]) == places(
        mesh.points, np.arange(len(mesh.points))[:, None]
    )


def test_fixed_facets_stay_and_the_inside_gives_way():
    mesh = ball(4)
    assert any(negatives(mesh))
    better, _ = run(mesh, "one-sided", boundary="fixed")
    assert negatives(better) == [0, 0, 0]
    assert places(better.points, better.topology.boundary) == places(mesh.points, mesh.topology.boundary)


def test_what_fixed_facets_rule_out_is_listed_with_the_option_that_frees_it():
    mesh = kuhn_cube(2)  # four corners of each fixed square are on one sphere with every fifth point
    with pytest.warns(WctWarning, match="nothing better"):
        better, metrics = run(mesh, "one-sided", boundary="fixed")
    assert metrics["bad"] == len(better.tets) == len(mesh.tets)
    assert {tet["misses"] for tet in metrics["remaining"]["tets"]} == {"one-sided"}
    assert {tet["option"] for tet in metrics["remaining"]["tets"]} == {"boundary=keep or move"}
    assert json.loads(json.dumps(metrics["remaining"])) == metrics["remaining"]


def test_tags_sets_data_and_interfaces_are_carried():
    mesh = two_region_cube(4)
    triangles = mesh.topology.boundary
    top = triangles[(mesh.points[triangles, 2] == 1).all(axis=1)]
    mesh = TetMesh(
        mesh.points,
        mesh.tets,
        mesh.regions,
        facets=Cells(top, np.full(len(top), 7)),
        point_data={"height": mesh.points[:, 2]},
    )
    better, metrics = run(mesh, "one-sided", boundary="keep")
    assert duals.tiers(better).one_sided
    assert (better.points[better.facets.vertices, 2] == 1).all()
    assert (better.facets.tags == 7).all()
    corners = better.points[better.facets.vertices]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.linalg.norm(across, axis=1).sum() / 2 == pytest.approx(1.0)
    np.testing.assert_allclose(better.point_data["height"], better.points[:, 2], atol=1e-12)
    np.testing.assert_array_equal(better.points[better.topology.interfaces, 2], 0.5)
    assert metrics["interfaces"]["1|2"]["max"] < 1e-12


def test_tagged_facets_inside_a_region_stay():
    mesh = crooked()
    pairs = mesh.topology.interior_pairs
    inner = mesh.tets[pairs[:3, :1], FACETS[pairs[:3, 1]]]
    mesh = TetMesh(mesh.points, mesh.tets, facets=Cells(inner, np.full(3, 5)))
    better, metrics = run(mesh, "delaunay", boundary="keep")
    assert metrics["bad"] < int(misses(mesh, quality.measure(mesh), "delaunay").sum())
    assert places(better.points, better.facets.vertices) == places(mesh.points, inner)


def test_same_input_and_seed_give_the_same_bits():
    one, two, other = (run(kuhn_cube(2), "one-sided", boundary="keep", seed=seed)[0] for seed in (4, 4, 5))
    assert one.points.tobytes() == two.points.tobytes()
    assert one.tets.tobytes() == two.tets.tobytes()
    assert one.points.tobytes() != other.points.tobytes()


def test_stopped_at_once_the_mesh_stays():
    better, metrics = run(kuhn_cube(2), "one-sided", progress=lambda state: False)
    np.testing.assert_array_equal(better.tets, kuhn_cube(2).tets)
    assert metrics["stopped"]


def test_tets_that_miss_a_goal_are_none_just_where_the_tier_is_reached():
    for mesh in (kuhn_cube(2), crooked(), ball(4), jittered_cube(4)):
        measured, tier = quality.measure(mesh), duals.tiers(mesh)
        assert misses(mesh, measured, "delaunay").any() == (not tier.delaunay)
        assert misses(mesh, measured, "one-sided").any() == any(negatives(mesh))


def test_edge_length_means_nothing_to_the_cheapest_change():
    with pytest.raises(OptionError, match="edge_length"):
        run(kuhn_cube(2), "delaunay", edge_length=0.1)


def test_exit_codes_of_optimize_and_report(tmp_path, capsys):
    given, kept, fixed = (str(tmp_path / name) for name in ("given.vtu", "kept.vtu", "fixed.vtu"))
    write_mesh(given, kuhn_cube(2))
    assert main.run(["optimize", given, kept, "--goal", "one-sided", "--boundary", "keep"]) == 0
    assert main.run(["optimize", given, fixed, "--goal", "one-sided", "--boundary", "fixed"]) == 1
    assert "tets miss the goal" in capsys.readouterr().out
    assert main.run(["report", kept, "--goal", "one-sided"]) == 0
    assert main.run(["report", given, "--goal", "one-sided"]) == 1
    assert main.run(["report", given, "--goal", "delaunay"]) == 0
    assert main.run(["report", kept, "--goal", "delaunay", "--exact"]) == 0
    assert main.run(["report", kept, "--goal", "one-sided", "--exact"]) == 2


@pytest.fixture(scope="module")
def devices(tmp_path_factory):
    folder = tmp_path_factory.mktemp("devices")
    thin = layered_box(folder, 0.06, 0.2)
    return {
        "layer": layered_box(folder, 0.15, 0.2),
        "thin layer": thin,
        "turned layer": thin.altered(points=thin.points @ rotation(1).T),
        "ball in a box": ball_in_box(folder, 0.25),
    }


@pytest.mark.parametrize("goal", ["delaunay", "one-sided"])
@pytest.mark.parametrize("name", ["layer", "thin layer", "turned layer", "ball in a box"])
def test_each_region_has_couples_of_its_own_that_are_not_negative(devices, name, goal):
    before = devices[name]
    after, metrics = run(before, goal)
    assert metrics["bad"] == 0
    assert metrics["losses"] == []
    assert min(couples(before).values()) < 0
    areas = np.array(list(couples(after).values()))
    longest = max(np.linalg.norm(np.ptp(after.points[cell], axis=0)) for cell in after.tets)
    assert areas.min() > -1e-12 * longest**2
    if goal == "one-sided":
        assert areas.min() > 0
    assert np.allclose(region_volumes(after), region_volumes(before), rtol=1e-12 if "layer" in name else 5e-3)


def test_no_flat_tets_come_in(devices):
    for name in ("layer", "turned layer", "ball in a box"):
        least = [
            quality.measure(mesh).min_dihedral_angle.min()
            for mesh in (devices[name], run(devices[name], "delaunay")[0])
        ]
        assert least[1] >= 0.5 * least[0], name


def stack(seed: int) -> TetMesh:
    """Two blocks with a thin layer between, of prisms, the points of its sides nearly but not quite over each other."""
    rng = np.random.default_rng(seed)
    n = 9
    flat = np.stack(np.meshgrid(np.arange(n), np.arange(n), indexing="ij"), axis=-1).reshape(-1, 2) / (n - 1.0)
    free = ((flat > 0) & (flat < 1)).all(axis=1)
    flat[free] += rng.uniform(-0.2, 0.2, (int(free.sum()), 2)) / (n - 1)
    triangles = np.sort(Delaunay(flat).simplices, axis=1)
    levels = np.array([0.0, 0.12, 0.24, 0.28, 0.4, 0.52])
    points = np.concatenate([np.column_stack([flat, np.full(len(flat), z)]) for z in levels])
    points[:, :2][np.tile(free, len(levels))] += rng.normal(0.0, 1e-4, (int(free.sum()) * len(levels), 2))
    a, b, c = triangles.T
    up = len(flat)
    prism = np.concatenate([np.stack(t, axis=1) for t in ((a, b, c, c + up), (a, b, b + up, c + up))])
    prism = np.concatenate([prism, np.stack((a, a + up, b + up, c + up), axis=1)])
    tets = np.concatenate([prism + level * up for level in range(len(levels) - 1)])
    turned = np.linalg.det(points[tets[:, 1:]] - points[tets[:, :1]]) < 0
    tets[turned] = tets[turned][:, [1, 0, 2, 3]]
    return TetMesh(points, tets, regions=np.repeat([1, 1, 2, 1, 1], len(prism)))


@pytest.mark.parametrize("turn", [False, True])
@pytest.mark.parametrize("seed", [0, 5, 6, 7])
def test_a_layer_meshed_alike_on_both_sides_gets_no_flat_tets(seed, turn):
    before = stack(seed)
    if turn:
        before = before.altered(points=before.points @ rotation(seed).T)
    after, metrics = run(before, "delaunay")
    assert metrics["bad"] == 0
    assert metrics["losses"] == []
    least = [quality.measure(mesh).min_dihedral_angle.min() for mesh in (before, after)]
    assert least[1] >= 0.5 * least[0]
    assert min(couples(after).values()) > -1e-12
    assert np.allclose(region_volumes(after), region_volumes(before), rtol=1e-12)


@pytest.mark.parametrize("boundary", ["keep", {"lower": "keep"}])
def test_vertices_that_are_to_stay_do_so_in_thin_layers(boundary):
    before = stack(0)
    lower = before.topology.interfaces[(before.points[before.topology.interfaces][..., 2] == 0.24).all(axis=1)]
    before = before.altered(facets=Cells(lower, np.full(len(lower), 7)), names={"lower": (7, 2)})
    after, metrics = run(before, "delaunay", boundary=boundary)
    assert metrics["bad"] == 0
    surface = np.concatenate([before.topology.boundary, before.topology.interfaces])
    stays = np.unique(surface if boundary == "keep" else lower)[:, None]
    assert places(before.points, stays) <= places(after.points, np.arange(len(after.points))[:, None])
