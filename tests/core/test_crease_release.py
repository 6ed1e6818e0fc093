"""Creases that leave tets no well-centered place are given up where nothing else helps, and only those."""

import numpy as np
import pytest
from support.builders import ball, jittered_cube
from support.core_meshes import NO_SEGMENTS
from support.searching import arguments, bad, check_valid, rows, search

from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import SurfaceMesh, TetMesh

TOLERANCE = 0.05
TIGHT = 0.03  # at TOLERANCE the search sometimes manages with the creases


@pytest.fixture(scope="module")
def mesh():
    return ball(3)


def creased(mesh, *nets):
    """The search's arguments if these sets of edges of the ball's surface were creases, each set a curve."""
    given, _ = arguments(mesh, crease_angle=180.0)
    stratum, label = given.stratum.copy(), given.label.copy()
    chosen, curve = np.concatenate(nets), np.repeat(np.arange(len(nets)), [len(net) for net in nets])
    corners = np.unique(chosen)
    stratum[corners], label[corners] = 3, corners
    surface = {"surface_segments": chosen, "surface_curve": curve}
    return {"stratum": stratum, "label": label, "creases": chosen, "crease_curve": curve, **surface}


def surface_edges(mesh):
    triangles = mesh.topology.boundary
    return np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)


def half(mesh, edges, side):
    return edges[(side * mesh.points[edges][:, :, 2] > 0.25).all(axis=1)]


def run(mesh, change, kicks=100, tolerance=TOLERANCE, **options):
    return search(mesh, change=change, passes=3, kicks=kicks, tolerance=tolerance, **options)


def test_creases_that_hold_tets_back_are_released(mesh):
    north = half(mesh, surface_edges(mesh), 1)
    kept = run(mesh, creased(mesh, north), tolerance=TIGHT)
    assert kept.bad > 0
    assert len(kept.released) == 0
    assert len(kept.mesh.creases) >= len(north)
    freed = run(mesh, creased(mesh, north), tolerance=TIGHT, loose=np.array([0]))
    assert freed.bad == 0
    assert freed.released.tolist() == [0]
    assert len(freed.mesh.creases) == 0
    assert (freed.mesh.stratum < 2).all()  # corners left without creases are none
    assert bad(freed.mesh.points, freed.mesh.tets) == 0
    check_valid(freed)
    before = mesh.boundary_surface()
    assert measure_deviation(SurfaceMesh(freed.mesh.points, freed.mesh.facets), before).max <= TIGHT


def test_creases_that_are_not_loose_stay(mesh):
    edges = surface_edges(mesh)
    north, south = half(mesh, edges, 1), half(mesh, edges, -1)
    found = run(mesh, creased(mesh, north, south), loose=np.array([0]))
    check_valid(found)
    assert found.released.tolist() == [0]
    assert set(found.mesh.crease_curve.tolist()) == {1}
    assert np.array_equal(np.sort(found.mesh.label[found.mesh.stratum == 3]), np.unique(south))


def test_those_away_from_bad_tets_stay(mesh):
    edges = surface_edges(mesh)
    away = TetMesh(0.5 * mesh.points + [10.0, 0.0, 0.0], mesh.tets)
    good = run(away, creased(away, edges[[0, -1]]), kicks=1000)
    assert good.bad == 0
    both = TetMesh(
        np.vstack([mesh.points, good.mesh.points]),
        np.vstack([mesh.tets, len(mesh.points) + good.mesh.tets]).astype(np.int64),
    )
    change = creased(both, half(mesh, edges, 1), len(mesh.points) + good.mesh.creases)
    found = run(both, change, tolerance=TIGHT, loose=np.array([0, 1]))
    check_valid(found)
    assert found.released.tolist() == [0]
    assert set(found.mesh.crease_curve.tolist()) == {1}


def test_patches_on_either_side_become_one(mesh):
    (_, on), north = arguments(mesh), half(mesh, surface_edges(mesh), 1)
    sides = np.sort(on.triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2) @ [len(mesh.points), 1]
    patch = np.isin(sides, north @ [len(mesh.points), 1]).all(axis=1).astype(np.int64)  # 1 within the net
    change = creased(mesh, north) | {"surface_patch": patch, "facet_patch": patch, "surface_sides": NO_SEGMENTS}
    kept = run(mesh, change)
    assert set(kept.mesh.facet_patch.tolist()) == {0, 1}
    found = run(mesh, change, loose=np.array([0]))
    assert found.released.tolist() == [0]
    check_valid(found)
    assert not found.mesh.facet_patch.any()
    assert not found.mesh.label[found.mesh.stratum == 1].any()


def test_straight_creases_and_those_of_planes_are_never_released():
    mesh = jittered_cube(3, 1)
    curves = arguments(mesh)[1].curve
    plain = search(mesh, passes=1, kicks=100)
    loose = search(mesh, passes=1, kicks=100, loose=np.unique(curves))
    assert len(loose.released) == 0
    assert np.array_equal(plain.mesh.points, loose.mesh.points)
    assert np.array_equal(plain.mesh.tets, loose.mesh.tets)


def test_the_same_again(mesh):
    north = half(mesh, surface_edges(mesh), 1)
    first, second = (run(mesh, creased(mesh, north), loose=np.array([0])) for _ in range(2))
    assert np.array_equal(first.mesh.points, second.mesh.points)
    assert rows(first.mesh.tets) == rows(second.mesh.tets)


@pytest.mark.parametrize("loose", [[-1], [12]])
def test_curves_that_are_not_there_are_refused(loose):
    with pytest.raises(ValueError, match=rf"loose holds {loose[0]}; allowed are 0..11"):
        search(jittered_cube(2, 0), loose=np.array(loose))
