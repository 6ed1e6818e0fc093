"""How long the rest of a stage takes: in proportion where it says how much is done, by its phases in the remesher."""

import math

import pytest

from wct_plugin.progress import Progress
from wct_plugin.waiting.remaining import PER_TET, Remaining


def heard(*said):
    """What is left, after each (seconds, Progress)."""
    one = Remaining(0.0)
    left = []
    for now, state in said:
        one.hear(state, now)
        left.append(one.seconds(now))
    return left


def test_nothing_is_known_before_anything_is_said():
    assert Remaining(0.0).seconds(10.0) is None
    assert heard((0.1, Progress("fTetWild", 0.0))) == [None]


def test_the_rest_takes_as_long_in_proportion():
    assert heard((2.0, Progress("moving vertices", 0.25)), (6.0, Progress("moving vertices", 0.75))) == [6.0, 2.0]


def test_a_start_takes_time_by_its_tets():
    first, later = heard(
        (0.1, Progress("resampling", 0.0, 900)), (1.0, Progress("resampling", 0.0, 900, expected=50_000))
    )
    assert first is None
    assert later == pytest.approx(PER_TET * 50_000 - 1.0)


def test_what_is_done_of_a_start_tells_more_than_its_tets():
    """A mesh that takes a tenth of what its tets say."""
    end = PER_TET * 100_000 / 10.0
    start = 0.6 * end
    said = [(done * start, Progress("resampling", done, 900, 100_000)) for done in (0.2, 0.45, 0.9)]
    times = [now for now, _ in said]
    for now, left in zip(times, heard(*said), strict=True):
        assert now + left == pytest.approx(end)


@pytest.mark.parametrize("per_second", [0.1, 0.5, 2.0])
def test_kicks_that_leave_fewer_and_fewer_tets_end_within_twice_what_is_said(per_second):
    """From 100 bad tets, fewer by the same factor every second, until none is left."""
    end = 10.0 + (math.log(100) + 1.0) / per_second
    said = [(9.0, Progress("resampling", 0.0, 100, 60_000)), (10.0, Progress("local search: kicks", 0.0, 100, 60_000))]
    times = [10.0 + share * (end - 10.0) for share in (0.3, 0.5, 0.7)]
    for now in times:
        bad = max(round(100 * math.exp(-per_second * (now - 10.0))), 1)
        said.append((now, Progress("local search: kicks", 0.1, bad, 60_000)))
    for now, left in zip(times, heard(*said)[2:], strict=True):
        assert 0.5 < (now + left) / end < 2.0


def test_kicks_in_vain_take_longer_and_longer():
    said = [(10.0 + k, Progress("local search: kicks", 0.0, 8 - min(k, 4), 1000)) for k in range(40)]
    left = heard(*said)
    assert left[39] > left[20] > left[8] > 0


def test_what_comes_after_the_search_is_short():
    (left,) = heard((100.0, Progress("measuring", 1.0, 0)))
    assert 0 < left < 20
