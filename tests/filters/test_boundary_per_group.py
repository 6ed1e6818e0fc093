"""A boundary that stays in some groups of facets and moves in the others."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import cylinder, jittered_cube, kuhn_cube, two_region_cube

import wct_plugin as wct
from wct_plugin.errors import OptionError
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.meshing import per_group
from wct_plugin.meshing.held_surface import HeldSurface
from wct_plugin.meshing.local_search import LocalSearch
from wct_plugin.meshing.local_tolerance import Tolerance
from wct_plugin.meshing.phase_progress import Listener
from wct_plugin.meshing.reference import own_boundary
from wct_plugin.meshing.restart import PartialRestart, ShorterEdges
from wct_plugin.meshing.surface_edges import Lengths
from wct_plugin.meshing.tet_limit import TetLimit
from wct_plugin.meshing.work_limit import WorkLimit

FACES = ((0, 0.0), (0, 1.0), (1, 0.0), (1, 1.0), (2, 0.0), (2, 1.0))


def with_faces(mesh):
    """A unit cube whose six faces are tagged 1 to 6; the first is called bottom."""
    boundary = mesh.topology.boundary
    at = mesh.points[boundary]
    tags = sum(k * (at[:, :, axis] == value).all(axis=1) for k, (axis, value) in enumerate(FACES, start=1))
    names = {"bottom": (1, 2)}
    return TetMesh(mesh.points, mesh.tets, mesh.regions, Cells(boundary, tags), names=names)


def turned(mesh):
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    points = 3.7 * mesh.points @ (turn * np.linalg.det(turn)).T + [5.0, -2.0, 0.1]
    return TetMesh(points, mesh.tets, mesh.regions, mesh.facets, names=mesh.names)


def facets_of(mesh, tag):
    corners = mesh.points[mesh.facets.vertices[mesh.facets.tags == tag]]
    return {tuple(sorted(map(tuple, one))) for one in corners.tolist()}


def points_of(mesh, tag):
    return {point for facet in facets_of(mesh, tag) for point in facet}


def optimize(mesh, boundary, goal="3wc", **options):
    return wct.apply_filter("meshing_well_centered", mesh, boundary=boundary, goal=goal, **options)


@pytest.fixture(scope="module")
def acute():
    """A cube all of whose facets are acute."""
    return with_faces(wct.apply_filter("meshing_well_centered", jittered_cube(4), force=True)[0])


@pytest.mark.parametrize("change", [lambda mesh: mesh, turned])
def test_a_fixed_face_comes_back_to_the_bit_and_the_others_are_new(acute, change):
    mesh = change(acute)
    out, found = optimize(mesh, {"bottom": "fixed", "*": "move"}, goal="cwc", force=True, seed=3)
    assert found["bad"] == 0
    assert facets_of(out, 1) == facets_of(mesh, 1)
    for tag in range(2, 7):
        assert not facets_of(out, tag) & facets_of(mesh, tag)
    assert found["deviation"]["fraction_of_diagonal"] < 1e-12
    assert out.names == mesh.names


def test_opposite_and_adjacent_faces_may_be_fixed_together(acute):
    out, found = optimize(acute, "1=fixed,2=fixed,3=fixed", force=True)
    assert found["bad"] == 0
    assert [facets_of(out, tag) == facets_of(acute, tag) for tag in range(1, 7)] == [True] * 3 + [False] * 3


def test_the_rest_may_stay_and_a_face_move(acute):
    out, _ = optimize(acute, {"*": "fixed", "6": "move"}, force=True)
    assert [facets_of(out, tag) == facets_of(acute, tag) for tag in range(1, 7)] == [True] * 5 + [False]


def test_vertices_of_a_kept_face_stay_beside_a_fixed_one(acute):
    out, _ = optimize(acute, {"1": "keep", "2": "fixed", "*": "move"}, force=True)
    assert points_of(out, 1) >= points_of(acute, 1)
    assert facets_of(out, 2) == facets_of(acute, 2)
    inside, _ = optimize(acute, {"2": "fixed", "*": "keep"}, force=True)
    assert facets_of(inside, 2) == facets_of(acute, 2)
    for tag in range(1, 7):
        assert points_of(inside, tag) >= points_of(acute, tag)


def test_an_interface_may_be_fixed():
    mesh = two_region_cube(4)
    wall = mesh.topology.interfaces
    mesh = TetMesh(mesh.points, mesh.tets, mesh.regions, Cells(wall, np.full(len(wall), 8)))
    out, found = optimize(mesh, {"8": "fixed"})
    assert facets_of(out, 8) == facets_of(mesh, 8)
    assert len(facets_of(out, 8)) == len(wall)
    assert found["bad"] == found["remaining"]["proven"]  # right facets: some rule the goal out


def test_a_fixed_curved_patch_stays_between_ends_that_move():
    mesh = cylinder(12, 4)
    boundary = mesh.topology.boundary
    flat = np.ptp(mesh.points[boundary][:, :, 2], axis=1) < 1e-9
    mesh = TetMesh(mesh.points, mesh.tets, facets=Cells(boundary, np.where(flat, 1, 2)))
    out, _ = optimize(mesh, {"2": "fixed"})
    assert facets_of(out, 2) == facets_of(mesh, 2)
    assert facets_of(out, 1) != facets_of(mesh, 1)


def test_tets_on_facets_that_rule_the_goal_out_are_no_reason_to_start_again():
    mesh = with_faces(kuhn_cube(3))
    out, found = optimize(mesh, {"1": "fixed"}, surface_edges=3.0)
    assert found["bad"] == found["remaining"]["proven"] > 0
    assert {one["option"] for one in found["remaining"]["tets"]} == {"boundary=keep or move there"}
    assert len(out.tets) < 1.5 * len(mesh.tets)
    assert facets_of(out, 1) == facets_of(mesh, 1)


def test_a_partial_restart_keeps_the_fixed_face(acute, monkeypatch):
    monkeypatch.setattr("wct_plugin.meshing.restart._FEW", 1.0)
    own = own_boundary(acute, 40.0)
    stays = np.zeros(own.strata.patch.max() + 1, dtype=bool)
    stays[own.strata.patch[(acute.points[own.strata.triangles][:, :, 0] == 0).all(axis=1)]] = True
    held = HeldSurface.of(own, stays, stays, np.empty(0, dtype=np.int64))
    listen = Listener(lambda _: True, 0)
    fixed, within = np.flatnonzero(stays), Tolerance(1e-3)
    search = LocalSearch(
        acute,
        "move",
        True,
        0.02,
        1,
        0,
        listen,
        TetLimit(None, len(acute.tets), listen),
        WorkLimit(len(acute.tets), 1),
        held,
        fixed,
    )
    start = search.resampled(own, within, Lengths())
    found = search.run(start, own, within)
    mesh = found.mesh
    corner = mesh.points[mesh.tets].mean(axis=1).sum(axis=1).argmin()  # beside the face
    again = search.resampled(
        own,
        within,
        Lengths(),
        ShorterEdges.nowhere(),
        PartialRestart.of(replace(found, stuck=np.array([corner])), 0)._replace(radius=np.array([0.4])),
        1,
    )
    assert held.is_in(again, held.fixed)
    assert not {tuple(p) for p in again.points.tolist()} <= {tuple(p) for p in mesh.points.tolist()}


def test_the_cheap_goals_keep_the_facets_too():
    mesh = with_faces(jittered_cube(3))
    for goal in ("delaunay", "one-sided"):
        out, _ = optimize(mesh, {"1": "fixed", "*": "move"}, goal=goal)
        assert facets_of(out, 1) == facets_of(mesh, 1)


def test_a_given_surface_is_not_followed_where_facets_stay(acute):
    with pytest.warns(wct.WctWarning, match="not on the reference: facets of it stay"):
        out, _ = optimize(acute, {"1": "fixed"}, reference=acute.boundary_surface(), force=True)
    assert facets_of(out, 1) == facets_of(acute, 1)


@pytest.mark.parametrize(
    ("boundary", "message"),
    [
        ({"top": "fixed"}, "names 'top', which is no group of facets of the mesh .there: 'bottom', '1', '2'"),
        ("7=fixed", "names '7'"),
        ("bottom=fixd", "says 'fixd' of 'bottom'; input should be 'move', 'keep' or 'fixed'"),
        ("bottom=fixed,bottom=move", "says twice what 'bottom' is"),
        ("bottom=fixed,", "'' is no NAME=VALUE"),
        ("slide", "input should be 'move', 'keep' or 'fixed', or one of them per group"),
        (3, "input should be 'move'"),
    ],
)
def test_groups_that_are_not_there_and_choices_that_are_none_are_refused(boundary, message):
    with pytest.raises(OptionError, match=message):
        optimize(with_faces(jittered_cube(2)), boundary)


def test_names_and_values():
    assert per_group.parse("a=1, b c =x=y,*=0") == {"a": "1", "b c =x": "y", "*": "0"}
