"""A mesh that is made anew in places: what is kept, and what else was there."""

from dataclasses import replace

import numpy as np
import pytest
from support.boxes import box, cube_surface
from support.segments import farthest

from wct_plugin.core import _core
from wct_plugin.core.domain import RegionMesh
from wct_plugin.core.requests import KeptPoints, ResampleOptions, SearchOptions
from wct_plugin.measure.quality import measure
from wct_plugin.mesh import TetMesh
from wct_plugin.meshing.restart import PartialRestart


def kept(mesh, at, radius):
    """All points of a mesh of one region but its corners, which are new near a place."""
    keep = mesh.stratum < 3
    label = np.where(mesh.stratum > 0, mesh.label, 0)[keep]
    return KeptPoints(mesh.points[keep], mesh.stratum[keep].astype(np.int64), label, np.array([at]), np.array([radius]))


def sample(given, **options):
    kept = options.pop("kept", None)
    return _core.resample(cube_surface(), given, ResampleOptions(1e-3, **options), kept=kept)


@pytest.fixture(scope="module")
def right():
    """A cube's domain and tets there that are all well-centered."""
    points, tets = box(5)
    given = RegionMesh(points, tets, np.zeros(len(tets), dtype=np.int64))
    found = _core.search_well_centered(sample(given).mesh, cube_surface(), SearchOptions(1e-3))
    assert found.bad == 0
    return given, found


def rows(points, tets):
    """The tets as sets of places."""
    corners = points[tets]
    order = np.lexsort((corners[..., 2], corners[..., 1], corners[..., 0]), axis=1)
    return {tet.tobytes() for tet in np.take_along_axis(corners, order[..., None], axis=1)}


def test_well_centered_tets_come_back_where_their_points_stay(right):
    given, found = right
    again = sample(given, kept=kept(found.mesh, [9.0, 9.0, 9.0], 0.1))
    assert again.intact
    assert rows(again.mesh.points, again.mesh.tets) == rows(found.mesh.points, found.mesh.tets)


def test_only_what_is_near_the_places_changes(right):
    given, found = right
    radius = 0.15
    again = sample(
        given,
        seed=5,
        finer_at=np.array([[0.5, 0.5, 1.0]]),
        finer_size=np.array([0.08]),
        kept=kept(found.mesh, [0.5, 0.5, 1.0], radius),
    )
    assert again.intact
    old, new = rows(found.mesh.points, found.mesh.tets), rows(again.mesh.points, again.mesh.tets)
    assert new - old
    changed = np.array([np.frombuffer(tet).reshape(4, 3) for tet in new ^ old])
    nearest = np.linalg.norm(changed - [0.5, 0.5, 1.0], axis=2).min(axis=1)
    assert nearest.max() < 3.0 * radius + 0.25  # what may move, and an edge
    assert len(new & old) > 0.4 * len(old)
    assert measure(TetMesh(again.mesh.points, again.mesh.tets)).volume.sum() == pytest.approx(1.0, rel=1e-12)


def with_loop(corners):
    """The surface of the unit cube, and in it a regular polygon as a wire: its curve 12."""
    surface = cube_surface()
    turns = 2.0 * np.pi * np.arange(corners) / corners
    loop = np.column_stack([0.5 + 0.3 * np.cos(turns), 0.5 + 0.3 * np.sin(turns), np.full(corners, 0.5)])
    ring = len(surface.points) + np.column_stack([np.arange(corners), np.roll(np.arange(corners), -1)])
    return replace(
        surface,
        points=np.vstack([surface.points, loop]),
        segments=np.vstack([surface.segments, ring]),
        curve=np.concatenate([surface.curve, np.full(corners, 12)]),
    ), loop


@pytest.mark.parametrize("seed", range(4))
def test_a_wire_made_anew_in_places_stays_within_the_tolerance_of_its_own(right, seed):
    given, _ = right
    surface, loop = with_loop(11)
    tolerance = 3e-3
    start = _core.resample(surface, given, ResampleOptions(tolerance, seed=seed))
    found = _core.search_well_centered(start.mesh, surface, SearchOptions(tolerance, seed=seed))
    place = 0.5 * (loop[3] + loop[4])
    asked = kept(found.mesh, place, 0.25)
    again = _core.resample(surface, given, ResampleOptions(tolerance, seed=seed + 1), kept=asked).mesh
    assert set(map(tuple, again.points.tolist())) != set(map(tuple, found.mesh.points.tolist()))
    for mesh in (found.mesh, again):
        wire = mesh.points[mesh.creases[mesh.crease_curve == 12]]
        on = np.vstack([wire[:, 0] + share * (wire[:, 1] - wire[:, 0]) for share in np.linspace(0.0, 1.0, 21)])
        assert farthest(on, loop, np.roll(loop, -1, axis=0)) <= tolerance
        assert farthest(loop, wire[:, 0], wire[:, 1]) <= tolerance


def test_strata_that_there_are_not_are_refused(right):
    given, found = right
    whole = kept(found.mesh, [0.5, 0.5, 0.5], 0.1)
    wrong = replace(whole, stratum=np.full_like(whole.stratum, 4))
    with pytest.raises(ValueError, match="kept stratum holds 4; allowed are"):
        sample(given, kept=wrong)


def test_corners_that_were_moved_stay_so(right):
    given, found = right
    mesh = found.mesh
    corner = np.flatnonzero((mesh.stratum == 3) & (mesh.points == 1.0).all(axis=1))
    points = mesh.points.copy()
    points[corner] -= 1e-4
    asked = kept(replace(mesh, points=points), [9.0, 9.0, 9.0], 0.1)
    back = sample(given, kept=asked).mesh
    assert (back.points == 1.0).all(axis=1).any()  # left out: where the surface has it
    asked = replace(
        asked,
        points=np.concatenate([asked.points, points[corner]]),
        stratum=np.concatenate([asked.stratum, [3]]),
        label=np.concatenate([asked.label, mesh.label[corner]]),
    )
    there = sample(given, kept=asked).mesh
    assert not (there.points == 1.0).all(axis=1).any()
    at = np.flatnonzero((there.points == 1.0 - 1e-4).all(axis=1))
    assert there.stratum[at].tolist() == [3]


def test_a_result_with_few_stuck_tets_is_kept_but_for_its_pinned_corners(right):
    _, found = right
    mesh = found.mesh
    corners = np.flatnonzero(mesh.stratum == 3)
    label = mesh.label.copy()
    label[corners[0]] = -1
    stuck = replace(found, mesh=replace(mesh, label=label), stuck=np.array([7]))
    renewal = PartialRestart.of(stuck, 0)
    assert renewal is not None
    assert len(renewal.points) == len(mesh.points) - 1
    assert (renewal.stratum == 3).sum() == len(corners) - 1
    assert renewal.at == pytest.approx(mesh.points[mesh.tets[7]].mean(axis=0)[None])
    assert (renewal.label[renewal.stratum == 0] == 0).all()  # the region
    wider = PartialRestart.of(stuck, 2)
    assert wider is not None
    assert wider.radius > renewal.radius
    assert PartialRestart.of(replace(found, stuck=np.arange(len(mesh.tets) // 50)), 0) is None
