"""Points that are given several times become one, in the order they come first in."""

import numpy as np

from wct_plugin.mesh import coincident_points as module
from wct_plugin.mesh.coincident_points import distinct_points, places


def test_points_come_once_in_their_first_order() -> None:
    given = np.array([[2.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, -0.0], [0, 0, 0], [1, 0, 0]])
    points, place = distinct_points(given)
    assert points.tolist() == [[2, 0, 0], [1, 0, 0], [0, 0, 0]]
    assert place.tolist() == [0, 1, 0, 2, 2, 1]
    assert distinct_points(np.empty((0, 3)))[1].tolist() == []


def test_many_points_and_numbers_that_collide() -> None:
    random = np.random.default_rng(0)
    own = np.unique(random.normal(size=(5000, 3)).astype(np.float32).astype(float), axis=0)
    rows = random.integers(len(own), size=20_000)
    wanted = own[rows]
    before = module._MIX.copy()
    for mix in (before, np.zeros(3, dtype=np.uint64)):  # all points have the same number
        module._MIX[:] = mix
        try:
            points, place = distinct_points(wanted)
        finally:
            module._MIX[:] = before
        assert np.array_equal(points[place], wanted)
        assert len(points) == len(np.unique(rows))
        first = np.unique(place, return_index=True)[1]
        assert (np.diff(first) > 0).all()


def test_places_are_numbered_by_their_first_points() -> None:
    assert places(np.array([[2.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, -0.0], [0, 0, 0]])).tolist() == [0, 1, 0, 2, 2]
