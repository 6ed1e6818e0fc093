"""A mesh that is made anew in places: what is kept, and what else was there."""

import numpy as np
import pytest
from support.boxes import box, cube_surface

from wct_plugin.core import _core
from wct_plugin.measure.quality import measure
from wct_plugin.mesh import TetMesh
from wct_plugin.meshing.restart import PartialRestart


def arguments(found, at, radius):
    region = np.zeros(len(found["points"]), dtype=np.int64)
    keep = found["stratum"] < 3
    return {
        "kept_points": found["points"][keep],
        "kept_stratum": found["stratum"][keep].astype(np.int64),
        "kept_label": np.where(found["stratum"] > 0, found["label"], region)[keep],
        "anew_at": np.array([at]),
        "anew_radius": np.array([radius]),
    }


@pytest.fixture(scope="module")
def right():
    """A cube's domain and tets there that are all well-centered."""
    points, tets = box(5)
    given = {**cube_surface(), "points": points, "tets": tets, "region": np.zeros(len(tets), dtype=np.int64)}
    start = _core.resample(**given, tolerance=1e-3)
    surface = cube_surface()
    found = _core.search_well_centered(
        **{name: start[name] for name in ("points", "tets", "stratum", "label", "size", "facets", "facet_patch")},
        **{name: start[name] for name in ("creases", "crease_curve")},
        regions=start["region"],
        surface_points=surface["surface_points"],
        surface_triangles=surface["triangles"],
        surface_patch=surface["patch"],
        surface_segments=surface["segments"],
        surface_curve=surface["curve"],
        tolerance=1e-3,
        acute=True,
        margin=0.02,
        flip_surface=True,
        split_surface=True,
        passes=12,
        kicks=4000,
        seed=0,
    )
    assert found["bad"] == 0
    return given, found


def rows(points, tets):
    """The tets as sets of places."""
    corners = points[tets]
    order = np.lexsort((corners[..., 2], corners[..., 1], corners[..., 0]), axis=1)
    return {tet.tobytes() for tet in np.take_along_axis(corners, order[..., None], axis=1)}


def test_well_centered_tets_come_back_where_their_points_stay(right):
    given, found = right
    again = _core.resample(**given, tolerance=1e-3, **arguments(found, [9.0, 9.0, 9.0], 0.1))
    assert again["intact"]
    assert rows(again["points"], again["tets"]) == rows(found["points"], found["tets"])


def test_only_what_is_near_the_places_changes(right):
    given, found = right
    radius = 0.15
    again = _core.resample(
        **given,
        tolerance=1e-3,
        seed=5,
        finer_at=np.array([[0.5, 0.5, 1.0]]),
        finer_size=np.array([0.08]),
        **arguments(found, [0.5, 0.5, 1.0], radius),
    )
    assert again["intact"]
    old, new = rows(found["points"], found["tets"]), rows(again["points"], again["tets"])
    assert new - old
    changed = np.array([np.frombuffer(tet).reshape(4, 3) for tet in new ^ old])
    nearest = np.linalg.norm(changed - [0.5, 0.5, 1.0], axis=2).min(axis=1)
    assert nearest.max() < 3.0 * radius + 0.25  # what may move, and an edge
    assert len(new & old) > 0.4 * len(old)
    assert measure(TetMesh(again["points"], again["tets"])).volume.sum() == pytest.approx(1.0, rel=1e-12)


def test_what_belongs_together_is_asked_for(right):
    given, found = right
    whole = arguments(found, [0.5, 0.5, 0.5], 0.1)
    for name in whole:
        part = {key: value for key, value in whole.items() if key != name}
        with pytest.raises(ValueError, match="anew_at and anew_radius go together"):
            _core.resample(**given, tolerance=1e-3, **part)
    wrong = np.full_like(whole["kept_stratum"], 4)
    with pytest.raises(ValueError, match="kept_stratum holds 4; allowed are"):
        _core.resample(**given, tolerance=1e-3, **{**whole, "kept_stratum": wrong})


def test_corners_that_were_moved_stay_so(right):
    given, found = right
    corner = np.flatnonzero((found["stratum"] == 3) & (found["points"] == 1.0).all(axis=1))
    moved = {**found, "points": found["points"].copy()}
    moved["points"][corner] -= 1e-4
    asked = arguments(moved, [9.0, 9.0, 9.0], 0.1)
    back = _core.resample(**given, tolerance=1e-3, **asked)
    assert (back["points"] == 1.0).all(axis=1).any()  # left out: where the surface has it
    for name, values in (
        ("points", moved["points"][corner]),
        ("stratum", np.array([3])),
        ("label", moved["label"][corner]),
    ):
        asked[f"kept_{name}"] = np.concatenate([asked[f"kept_{name}"], values])
    kept = _core.resample(**given, tolerance=1e-3, **asked)
    assert not (kept["points"] == 1.0).all(axis=1).any()
    at = np.flatnonzero((kept["points"] == 1.0 - 1e-4).all(axis=1))
    assert kept["stratum"][at].tolist() == [3]


def test_a_result_with_few_stuck_tets_is_kept_but_for_its_pinned_corners(right):
    _, found = right
    corners = np.flatnonzero(found["stratum"] == 3)
    found = {**found, "label": found["label"].copy()}
    found["label"][corners[0]] = -1
    stuck = {**found, "stuck": np.array([7])}
    renewal = PartialRestart.of(stuck, 0)
    assert renewal is not None
    assert len(renewal.points) == len(found["points"]) - 1
    assert (renewal.stratum == 3).sum() == len(corners) - 1
    assert renewal.at == pytest.approx(found["points"][found["tets"][7]].mean(axis=0)[None])
    assert (renewal.label[renewal.stratum == 0] == 0).all()  # the region
    wider = PartialRestart.of(stuck, 2)
    assert wider is not None
    assert wider.radius > renewal.radius
    assert PartialRestart.of({**found, "stuck": np.arange(len(found["tets"]) // 50)}, 0) is None
