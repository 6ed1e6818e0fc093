"""All tets become well-centered and the domain stays what it was; the counts come from quality.py."""

import json
from dataclasses import replace

import meshio
import numpy as np
import pytest
from support.builders import (
    ball,
    cylinder,
    fin,
    jittered_cube,
    kuhn_cube,
    l_shape,
    rotation,
    sphere_surface,
    two_region_cube,
)
from support.domains import check_domain

from wct_plugin import apply_filter
from wct_plugin.core import _core
from wct_plugin.errors import InputError, OptionError, WctWarning
from wct_plugin.measure import quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh
from wct_plugin.mesh.strata import find_strata

SPHERE = sphere_surface(2000)


def run(mesh, **options):
    return apply_filter("meshing_well_centered", mesh, **options)


def stop_after(calls):
    heard = []
    return lambda state: not heard.append(state) and len(heard) < calls


def area(points, triangles):
    corners = points[triangles]
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2


def region_volumes(mesh):
    volumes = quality.volumes(mesh.points, mesh.tets)
    return {int(tag): volumes[mesh.regions == tag].sum() for tag in np.unique(mesh.regions)}


def places(points, cells):
    return {tuple(sorted(map(tuple, points[cell].tolist()))) for cell in cells}


@pytest.mark.parametrize(
    "mesh",
    [kuhn_cube(5), TetMesh(kuhn_cube(5).points @ rotation(3).T, kuhn_cube(5).tets), l_shape(4)],
    ids=["cube", "turned cube", "L"],
)
def test_flat_domains_become_well_centered_and_keep_their_volume(mesh):
    better, metrics = run(mesh, goal="3wc")
    assert metrics["bad"] == 0
    assert metrics["tets"] == len(better.tets)
    assert quality.measure(better).well_centered_3.all()
    check_domain(mesh, better)
    assert region_volumes(better)[0] == pytest.approx(region_volumes(mesh)[0], rel=1e-12)
    assert measure_deviation(better.boundary_surface(), mesh.boundary_surface()).max < 1e-12


def test_a_ball_becomes_completely_well_centered_within_the_tolerance_of_a_surface():
    mesh = ball(5)
    before = mesh.points.copy(), mesh.tets.copy()
    better, metrics = run(mesh, reference=SPHERE, tolerance=5e-3)
    assert metrics["bad"] == 0
    assert metrics["tolerance"] == pytest.approx(5e-3)
    assert quality.measure(better).completely_well_centered.all()
    check_domain(mesh, better)
    assert measure_deviation(better.boundary_surface(), SPHERE).max <= 5e-3 * SPHERE.diagonal
    assert better.reference is SPHERE
    assert np.array_equal(mesh.points, before[0])
    assert np.array_equal(mesh.tets, before[1])


def test_a_cylinder_stays_within_the_tolerance():
    mesh = cylinder(32, 10)
    better, _ = run(mesh, goal="3wc", tolerance=1e-2)
    assert quality.measure(better).well_centered_3.all()
    check_domain(mesh, better)
    surface = mesh.boundary_surface()
    assert measure_deviation(better.boundary_surface(), surface).max <= 1e-2 * surface.diagonal


def test_regions_and_their_interface_are_kept():
    mesh = two_region_cube(4)
    better, _ = run(mesh, progress=stop_after(12))
    check_domain(mesh, better)
    assert region_volumes(better) == pytest.approx(region_volumes(mesh), rel=1e-12)
    assert area(better.points, better.topology.interfaces) == pytest.approx(1.0, rel=1e-12)
    assert (np.abs(better.points[better.topology.interfaces][:, :, 2] - 0.5) < 1e-12).all()


def test_tags_and_data_are_carried():
    mesh = kuhn_cube(5)
    triangles = mesh.topology.boundary
    middle = mesh.points[triangles].mean(axis=1)
    tags = np.select([middle[:, 0] < 1e-9, middle[:, 0] > 1 - 1e-9], [1, 2], 3)
    right = mesh.points[mesh.tets].mean(axis=1)[:, 0] > 0.5
    mesh = replace(
        mesh,
        facets=Cells(triangles, tags),
        point_data={"u": mesh.points @ [1.0, 2.0, -1.0], "id": np.arange(len(mesh.points))},
        cell_data={"right": right},
        tet_sets={"right": np.flatnonzero(right)},
        point_sets={"probe": [0]},
        names={"in": (1, 2)},
    )
    with pytest.warns(WctWarning, match="point set 'probe', point data 'id'"):
        better, _ = run(mesh, goal="3wc")
    check_domain(mesh, better)
    for tag, wanted in ((1, 1.0), (2, 1.0), (3, 4.0)):
        found = better.facets.vertices[better.facets.tags == tag]
        assert area(better.points, found) == pytest.approx(wanted, rel=1e-12)
    assert np.allclose(better.point_data["u"], better.points @ [1.0, 2.0, -1.0], atol=1e-12)
    centers = better.points[better.tets].mean(axis=1)[:, 0]
    far = np.abs(centers - 0.5) > 0.2
    assert np.array_equal(better.cell_data["right"][far], (centers > 0.5)[far])
    assert np.array_equal(better.tet_sets["right"], np.flatnonzero(better.cell_data["right"]))
    assert dict(better.names) == {"in": (1, 2)}


@pytest.mark.filterwarnings("ignore:the size of 3")  # a curved side is rough within the tolerance
def test_tags_survive_on_a_finer_reference():
    mesh, surface = cylinder(24, 8), cylinder(96, 24).boundary_surface()
    triangles = mesh.topology.boundary
    height = mesh.points[triangles].mean(axis=1)[:, 2]
    mesh = replace(mesh, facets=Cells(triangles, np.select([height < 1e-9, height > 2 - 1e-9], [1, 2], 3)))
    better, _ = run(mesh, reference=surface, tolerance=5e-3, goal="3wc")
    check_domain(mesh, better)
    apart = 5e-3 * surface.diagonal  # what the rim of a disk, of radius 1, may be off everywhere
    for tag, wanted, off in ((1, np.pi, 2 * np.pi * apart), (2, np.pi, 2 * np.pi * apart), (3, 4 * np.pi, 0.2)):
        found = better.facets.vertices[better.facets.tags == tag]
        assert area(better.points, found) == pytest.approx(wanted, abs=off)
    assert len(better.facets) == len(better.topology.boundary)
    assert measure_deviation(better.boundary_surface(), surface).max <= 5e-3 * surface.diagonal


def test_a_reference_that_cannot_be_followed_is_said():
    mesh = two_region_cube(2)
    with pytest.warns(WctWarning, match="not on the reference: the mesh has several regions"):
        run(mesh, reference=mesh.boundary_surface(), progress=lambda state: False)


def test_a_reference_with_a_hole_is_closed_and_followed():
    """The mesh is rougher than the tolerance, so that what is within it followed the reference."""
    mesh = ball(3)
    opened = SurfaceMesh(SPHERE.points, SPHERE.triangles[1:])
    with pytest.warns(WctWarning, match="the reference has holes, which were closed"):
        better, metrics = run(mesh, reference=opened, tolerance=7e-3)
    assert metrics["bad"] == 0
    assert measure_deviation(mesh.boundary_surface(), SPHERE).max > 7e-3 * SPHERE.diagonal
    assert measure_deviation(better.boundary_surface(), SPHERE).max <= 7e-3 * SPHERE.diagonal


def test_the_same_bits_twice():
    first, second = (run(ball(4), reference=SPHERE, tolerance=1e-2, seed=3)[0] for _ in range(2))
    assert np.array_equal(first.points, second.points)
    assert np.array_equal(first.tets, second.tets)


def test_a_fixed_boundary_keeps_its_facets_bit_for_bit():
    mesh = jittered_cube(3, 1)
    better, metrics = run(mesh, goal="3wc", boundary="fixed", progress=stop_after(5))
    assert metrics["stopped"]
    check_domain(mesh, better)
    assert places(better.points, better.topology.boundary) == places(mesh.points, mesh.topology.boundary)
    assert quality.measure(better).well_centered_3.mean() > quality.measure(mesh).well_centered_3.mean()


@pytest.mark.parametrize("turned", [False, True])
def test_between_fixed_facets_nearly_all_that_can_be_becomes_well_centered(turned):
    """Most tets that still miss the goal are on facets that rule it out, however the mesh is turned."""
    mesh = ball(4)
    if turned:
        mesh = TetMesh(mesh.points @ rotation(5).T, mesh.tets)
    better, metrics = run(mesh, boundary="fixed")
    check_domain(mesh, better)
    assert places(better.points, better.topology.boundary) == places(mesh.points, mesh.topology.boundary)
    assert quality.measure(mesh).completely_well_centered.mean() < 0.4
    assert quality.measure(better).completely_well_centered.mean() > 0.97
    assert 0 < metrics["remaining"]["proven"] < 0.02 * len(better.tets)
    assert len(better.tets) <= 2.2 * len(mesh.tets)


def test_regions_tagged_sheets_and_edges_stay_between_fixed_facets():
    mesh = ball(4)
    upper = mesh.points[mesh.tets].mean(axis=1)[:, 2] > 0
    sheet = TetMesh(mesh.points, mesh.tets, regions=upper.astype(np.int64)).topology.interfaces
    deep = mesh.topology.edges[~np.isin(mesh.topology.edges, mesh.topology.boundary_points).any(axis=1)][:2]
    right = mesh.points[mesh.tets].mean(axis=1)[:, 0] > 0
    mesh = TetMesh(
        mesh.points,
        mesh.tets,
        regions=np.where(right, 5, 3),
        facets=Cells(sheet, np.full(len(sheet), 9)),
        edges=Cells(deep, np.array([1, 2])),
    )
    better, _ = run(mesh, boundary="fixed")
    assert len(better.tets) > 1.2 * len(mesh.tets)  # filled anew
    for old, new in (
        (mesh.topology.boundary, better.topology.boundary),
        (mesh.topology.interfaces, better.topology.interfaces),
        (mesh.facets.vertices, better.facets.vertices),
        (mesh.edges.vertices, better.edges.vertices),
    ):
        assert places(better.points, new) == places(mesh.points, old)
    assert region_volumes(better) == pytest.approx(region_volumes(mesh), rel=1e-12)
    assert sorted(better.edges.tags.tolist()) == [1, 2]


def test_tagged_edges_inside_stay_where_they_are():
    mesh = kuhn_cube(4)
    axis = np.flatnonzero((mesh.points[:, :2] == 0.5).all(axis=1))
    axis = axis[np.argsort(mesh.points[axis, 2])]
    mesh = replace(mesh, edges=Cells(np.column_stack([axis[:-1], axis[1:]]), np.full(4, 7)))
    better, metrics = run(mesh)
    assert metrics["bad"] == 0
    ends = better.points[better.edges.vertices]
    assert (ends[:, :, :2] == 0.5).all()
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(1.0)
    assert (better.edges.tags == 7).all()


def test_hopeless_tets_cost_no_kicks():
    """All facets of Kuhn's cube are right triangles: the tets on them are all that is left bad."""
    mesh = kuhn_cube(4)
    better, metrics = run(mesh, boundary="fixed")
    assert metrics["kicks"] < 10  # thousands, if those tets were tried
    assert metrics["remaining"]["proven"] == metrics["bad"] == len(mesh.topology.boundary)
    assert places(better.points, better.topology.boundary) == places(mesh.points, mesh.topology.boundary)
    assert quality.measure(better).completely_well_centered.mean() > 0.7


def test_a_kept_boundary_keeps_its_points():
    mesh = jittered_cube(3, 2)
    better, _ = run(mesh, goal="3wc", boundary="keep", progress=stop_after(5))
    check_domain(mesh, better)
    kept = set(map(tuple, better.points.tolist()))
    assert set(map(tuple, mesh.points[mesh.topology.boundary_points].tolist())) <= kept
    assert region_volumes(better)[0] == pytest.approx(1.0, rel=1e-12)


def test_the_reference_may_be_a_file(tmp_path):
    name = str(tmp_path / "sphere.obj")
    meshio.write_points_cells(name, SPHERE.points, [("triangle", SPHERE.triangles)])
    better, _ = run(ball(4), reference=name, tolerance=1e-2, goal="3wc")
    assert isinstance(better.reference, SurfaceMesh)
    assert measure_deviation(better.boundary_surface(), SPHERE).max <= 1e-2 * SPHERE.diagonal


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"tolerence": 1e-3}, "unknown option 'tolerence'; did you mean 'tolerance'"),
        ({"tolerance": 0.5}, "option 'tolerance' is 0.5; input should be less than or equal to 0.1"),
        ({"goal": "2wc"}, "option 'goal' is '2wc'"),
        ({"boundary": "slide"}, "option 'boundary' is 'slide'"),
        ({"edge_length": 0}, "option 'edge_length' is 0; input should be greater than 0"),
        ({"effort": 0}, "option 'effort' is 0"),
        ({"reference": 3}, "option 'reference' is 3; must be a surface or the name of a surface file"),
    ],
)
def test_bad_options_are_refused(options, message):
    with pytest.raises(OptionError, match=message):
        run(kuhn_cube(2), **options)


def test_creases_by_their_angle_alone_may_be_released_where_the_boundary_moves(monkeypatch):
    mesh = two_region_cube(2)
    asked = {}

    def search(start, surface, options, progress):
        asked[len(asked)] = options.loose
        raise KeyboardInterrupt

    monkeypatch.setattr(_core, "search_well_centered", search)
    for boundary in ("move", "keep", "fixed"):
        with pytest.raises(KeyboardInterrupt):
            run(mesh, boundary=boundary)
    assert np.array_equal(asked[0], find_strata(mesh).soft_curves)
    assert 0 < len(asked[0]) < find_strata(mesh).curve.max() + 1  # those round the interface are no matter of angles
    assert asked[1] is None
    assert asked[2] is None


# --- progress, stopping and what is said afterwards ------------------------------------------------------------------


def test_progress_names_every_phase_and_counts_the_bad_tets():
    mesh = ball(8)
    heard = []
    better, _ = run(mesh, reference=SPHERE, tolerance=5e-3, goal="3wc", progress=heard.append)
    stages = [state.stage.partition(",")[0] for state in heard]
    assert sorted(set(stages), key=stages.index)[:2] == ["resampling", "local search: passes"]
    assert stages[-1] == "measuring"
    assert all(0.0 <= state.done <= 1.0 for state in heard)
    assert heard[0].bad == (~quality.measure(mesh).well_centered_3).sum()
    assert heard[-1].bad == (~quality.measure(better).well_centered_3).sum() == 0
    for stage in set(stages):
        done = [state.done for state, name in zip(heard, stages, strict=True) if name == stage]
        assert done == sorted(done)


def test_stopped_while_resampling_the_input_is_the_best_so_far():
    mesh = ball(4)
    better, metrics = run(mesh, reference=SPHERE, tolerance=1e-2, progress=lambda state: False)
    assert metrics["stopped"]
    assert np.array_equal(better.points, mesh.points)
    assert np.array_equal(better.tets, mesh.tets)
    assert better.reference is SPHERE
    assert metrics["bad"] == (~quality.measure(mesh).completely_well_centered).sum()
    assert {tet["option"].partition(",")[0] for tet in metrics["remaining"]["tets"]} == {"more time: it was stopped"}


def test_the_output_is_never_worse_than_the_input(monkeypatch):
    """A search that gives back a mesh of fewer good tets is not taken."""
    mesh, search = jittered_cube(3, 0), _core.search_well_centered
    bad = kuhn_cube(3)  # not one of its tets contains its circumcenter beyond doubt

    def worse(start, surface, options, progress):
        found = search(start, surface, replace(options, passes=0, kicks=0), progress)
        regions = np.zeros(len(bad.tets), dtype=np.int64)
        none = bad.topology.boundary[:0]
        made = replace(found.mesh, points=bad.points, tets=bad.tets, regions=regions, facets=none)
        return replace(found, mesh=made, stuck=none[:, 0])

    monkeypatch.setattr(_core, "search_well_centered", worse)
    with pytest.warns(WctWarning, match="nothing better was found"):
        same, metrics = run(mesh, goal="3wc")
    assert np.array_equal(same.points, mesh.points)
    assert np.array_equal(same.tets, mesh.tets)
    assert metrics["bad"] == (~quality.measure(mesh).well_centered_3).sum()


def test_what_is_left_and_how_well_the_domain_is_kept():
    mesh = two_region_cube(4)
    better, metrics = run(mesh, boundary="fixed", progress=stop_after(4))
    left = metrics["remaining"]
    assert left["count"] == metrics["bad"] == (~quality.measure(better).completely_well_centered).sum()
    assert 0 < left["proven"] <= left["by_place"]["patch"] + left["by_place"]["crease"] + left["by_place"]["corner"]
    assert metrics["deviation"]["max"] < 1e-12
    assert metrics["interfaces"]["1|2"]["max"] < 1e-12
    assert metrics["volumes"]["1"]["after"] == pytest.approx(0.5)
    assert metrics["shape"]["min_dihedral_angle"] == quality.measure(better).min_dihedral_angle.min()
    json.dumps(metrics)


def test_a_surface_that_is_not_kept_is_named():
    far = SurfaceMesh(SPHERE.points * 1.1, SPHERE.triangles)
    with pytest.warns(
        WctWarning, match=r"^the boundary is \S+ of the diagonal from the reference; the tolerance is 1.00e-03"
    ):
        run(ball(3), reference=far, tolerance=1e-3, boundary="fixed", progress=lambda state: False)


@pytest.mark.parametrize(
    "surface", [SurfaceMesh(SPHERE.points * 1e-3, SPHERE.triangles), SurfaceMesh(SPHERE.points + 2.0, SPHERE.triangles)]
)
def test_a_reference_of_another_body_or_unit_is_refused(surface):
    with pytest.raises(
        InputError, match=r"of its diagonal from the boundary of .*; allowed is 0.1: it is another body"
    ):
        run(ball(3), reference=surface)


def test_an_exception_in_progress_comes_through():
    def fail(state):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(kuhn_cube(2), progress=fail)


def test_a_coarse_notch_keeps_its_planes():
    """Three tets per edge: a lattice this coarse can cut across the notch without a topological trace."""
    mesh = l_shape(3)
    better, _ = run(mesh)
    check_domain(mesh, better)
    assert region_volumes(better)[0] == pytest.approx(region_volumes(mesh)[0], rel=1e-12)
    assert quality.measure(better).completely_well_centered.all()


def test_a_fin_as_thick_as_its_edges_are_long_gets_shorter_ones():
    """Its corners and foot leave those no place: the search is stuck, and starts again."""
    mesh = fin()
    better, metrics = run(mesh)
    check_domain(mesh, better)
    assert measure_deviation(better.boundary_surface(), mesh.boundary_surface()).max < 1e-12
    assert quality.volumes(better.points, better.tets).sum() == pytest.approx(32.0, rel=1e-12)
    assert metrics["bad"] == 0
    assert quality.measure(better).completely_well_centered.all()
