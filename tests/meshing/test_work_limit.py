"""How long a search may go on: what is left, what counts, and what is said in the end."""

import numpy as np
import pytest
from support.builders import jittered_cube

import wct_plugin as wct
from wct_plugin.meshing import work_limit
from wct_plugin.meshing.work_limit import WorkLimit


def test_the_larger_of_input_and_result_counts():
    limit = WorkLimit(100, effort=1)
    before = limit.left
    limit.lead_to(50)
    assert limit.left == before
    limit.lead_to(300)
    assert limit.left == before + 200 * work_limit._PER_TET
    limit.lead_to(150)
    assert limit.left == before + 50 * work_limit._PER_TET


def test_starts_and_searches_count_as_they_say():
    limit = WorkLimit(100, effort=1)
    before = limit.left
    limit.add_start(7_000)
    limit.add_search(500, stuck=1)
    assert before - limit.left == 7_500
    assert not limit.reached


def test_effort_multiplies_all():
    assert WorkLimit(100, effort=7).left == 7 * WorkLimit(100, effort=1).left


def test_it_is_reached_only_where_tets_are_stuck():
    limit = WorkLimit(100, effort=1)
    limit.add_search(limit.left, stuck=0)
    assert (limit.left, limit.reached) == (0, False)
    limit.add_search(1, stuck=3)
    assert limit.reached


def test_what_begins_anew_has_all_of_it_again():
    limit = WorkLimit(100, effort=1)
    left = limit.left
    limit.lead_to(300)
    limit.add_search(left, stuck=3)
    limit.begin()
    assert limit.left == left


def test_where_it_ends_a_search_the_goal_says_so(monkeypatch):
    monkeypatch.setattr(work_limit, "_BASE", 1_000)
    monkeypatch.setattr(work_limit, "_PER_TET", 0)
    result = (wct.Reader(jittered_cube(2)) | wct.Filter.meshing_well_centered()).execute()
    (goal,) = result.goals
    assert goal.exhausted
    assert str(goal).endswith("the search ended at its limit of work; a larger effort goes on")
    assert result.metrics["meshing_well_centered"]["exhausted"]


@pytest.mark.parametrize("seed", [0, 1])
def test_the_same_work_gives_the_same_mesh(seed, monkeypatch):
    monkeypatch.setattr(work_limit, "_BASE", 5_000_000)
    one, other = (wct.apply_filter("meshing_well_centered", jittered_cube(2), seed=seed)[0] for _ in range(2))
    assert np.array_equal(one.points, other.points)
    assert np.array_equal(one.tets, other.tets)
