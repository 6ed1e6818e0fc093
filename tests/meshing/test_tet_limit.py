"""At most so many tets, and how many are expected before there are any."""

import re
from dataclasses import replace

import pytest
from support.builders import ball, cylinder, jittered_cube, kuhn_cube, l_shape
from support.searching import arguments

import wct_plugin as wct
from wct_plugin.core import _core
from wct_plugin.core.requests import SearchOptions
from wct_plugin.errors import WctWarning
from wct_plugin.meshing.phase_progress import Listener
from wct_plugin.meshing.tet_limit import TetLimit


def run(mesh, **options):
    return wct.apply_filter("meshing_well_centered", mesh, **options)


@pytest.mark.parametrize(
    ("mesh", "options"),
    [
        (kuhn_cube(4), {"edge_length": 0.12}),
        (l_shape(3), {"edge_length": 0.2}),
        (ball(4), {"edge_length": 0.2}),
        (cylinder(16, 6), {"edge_length": 0.2}),
    ],
    ids=["cube", "l", "ball", "cylinder"],
)
def test_as_many_tets_as_expected(mesh, options):
    heard = []
    better, metrics = run(mesh, goal="3wc", progress=lambda state: heard.append(state.expected), **options)
    assert len(better.tets) == pytest.approx(metrics["estimate"], rel=0.15)
    assert heard[0] is None  # nothing is known yet
    assert set(heard[2:]) == {metrics["estimate"]}


@pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")
@pytest.mark.parametrize("share", [0.6, 0.97, 1.0, 1.05])
@pytest.mark.parametrize("mesh", [jittered_cube(4), ball(4)], ids=["cube", "ball"])
def test_there_are_never_more_than_allowed(mesh, share):
    most = int(share * len(mesh.tets))
    better, metrics = run(mesh, goal="3wc", max_tets=most)
    if share >= 1.0:
        assert len(better.tets) <= most
    assert len(better.tets) <= most or better is mesh  # which is nobody's to thin out
    result = wct.Filter.meshing_well_centered(goal="3wc", max_tets=most)
    goal = (wct.Pipeline() | result).apply(mesh).goals[0]
    assert goal.met == (metrics["bad"] == 0 and len(better.tets) <= most)
    assert ("are allowed" in str(goal)) == (len(better.tets) > most)


@pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")
def test_starts_made_anew_where_it_is_stuck_keep_to_the_limit(monkeypatch):
    search, given = _core.search_well_centered, []

    def stuck(start, surface, options, progress):
        given.append(len(start.tets))
        found = search(start, surface, replace(options, passes=0, kicks=0), progress)
        assert len(found.mesh.tets) <= most
        return found

    mesh = kuhn_cube(4)
    most = 10**6
    monkeypatch.setattr(_core, "search_well_centered", stuck)
    run(mesh, edge_length=0.2)
    free, most = given[:], given[0] + 1
    given.clear()
    better, _ = run(mesh, edge_length=0.2, max_tets=most)
    assert max(free) > most
    assert len(given) > 1
    assert max(given) <= most
    assert len(better.tets) <= most


def test_the_search_adds_no_tets_beyond_the_limit():
    mesh = jittered_cube(4)
    for most in (len(mesh.tets), len(mesh.tets) + 7):
        asked = SearchOptions(1e-3, passes=3, kicks=50, most_tets=most)
        found = _core.search_well_centered(*arguments(mesh), asked)
        assert len(found.mesh.tets) <= most


def test_a_start_that_is_far_too_large_is_not_even_begun():
    mesh = jittered_cube(3)
    with pytest.warns(WctWarning, match="a start of about 1[0-9] 000 000 000 000 tets was not taken, as option"):
        better, metrics = run(mesh, edge_length=1e-4, max_tets=5000)
    assert len(better.tets) <= 5000
    assert metrics["estimate"] == pytest.approx(12 * 1.1**3 / 1e-12, rel=0.3)


def test_without_a_limit_absurd_sizes_are_refused_with_the_number_that_allows_them():
    mesh = jittered_cube(3)
    with pytest.warns(
        WctWarning, match="about 1[0-9] 000 000 tets was not begun, 1?[0-9]+ 000 times those that came: max_tets="
    ) as said:
        result = (wct.Pipeline() | wct.Filter.meshing_well_centered(edge_length=1e-2)).apply(mesh)
    allowed = int(re.search(r"max_tets=(\d+) allows", str(said[0].message))[1])
    assert 1.1 < allowed / result.stages[-1].metrics["estimate"] < 1.4
    if not (goal := result.goals[0]).met:
        assert f"max_tets={allowed} allows it" in str(goal)
    begun = []

    def stop_at_once(state):
        begun.append(state.expected)
        return state.expected is None

    run(mesh, edge_length=1e-2, max_tets=allowed, progress=stop_at_once)
    assert begun[-1] == result.stages[-1].metrics["estimate"]


def test_other_starts_are_not_much_larger_than_the_first():
    limit = TetLimit(None, 10_000, Listener(lambda _: True, 0))
    assert limit.expect(20_000)
    assert limit.expect(50_000)  # which does not count: else each could be three times the one before
    assert limit.expect(3 * 20_000)
    assert not limit.expect(3 * 20_000 + 1)


def test_starts_with_more_rows_through_layers_may_be_larger():
    limit = TetLimit(None, 100, Listener(lambda _: True, 0))
    assert limit.expect(20_000)
    assert limit.expect_more_rows(10 * 20_000)
    assert not limit.expect_more_rows(10 * 20_000 + 1)


def test_of_few_tets_there_may_be_many_times_more():
    limit = TetLimit(None, 100, Listener(lambda _: True, 0))
    assert limit.expect(200)
    assert limit.expect(25_000)
    assert not limit.expect(25_001)
