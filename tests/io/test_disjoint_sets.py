"""Sets that have each member once are found among others, or it is said that there are none."""

import numpy as np
import pytest

from wct_plugin.io.disjoint_sets import disjoint_cover

COUNT = 12


def sets(**members: list[int] | range) -> dict[str, np.ndarray]:
    return {name: np.array(list(rows), dtype=np.int64) for name, rows in members.items()}


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        (sets(a=range(5), b=range(5, 12)), ["a", "b"]),
        (sets(whole=range(12), b=range(5, 12), a=range(5)), ["b", "a"]),
        (sets(a=range(5), b=range(5, 12), probe=[3, 4, 5]), ["a", "b"]),
        (
            sets(left=range(6), right=range(6, 12), p=range(3), q=range(3, 6), r=range(6, 8), s=range(8, 12)),
            list("pqrs"),
        ),
        (sets(a=range(5), b=range(4, 12)), []),  # they overlap
        (sets(a=range(5), b=range(6, 12)), []),  # one is left over
        (sets(a=[0] * 5, b=range(5, 12)), []),  # as many, but not all
        (sets(whole=range(12)), []),
        (sets(a=range(5), b=range(5, 12), nothing=[]), ["a", "b"]),
        ({}, []),
    ],
)
def test_which_are_taken(given: dict[str, np.ndarray], wanted: list[str]) -> None:
    assert sorted(disjoint_cover(given, COUNT)) == sorted(wanted)


def test_many_that_overlap_end_soon() -> None:
    random = np.random.default_rng(0)
    given = {str(k): np.flatnonzero(random.random(300) < 0.2) for k in range(200)}
    assert disjoint_cover(given, 300) == []


def test_many_blocks() -> None:
    ids = np.arange(100_000) % 500
    given = {str(k): np.flatnonzero(ids == k) for k in range(500)}
    assert len(disjoint_cover(given, len(ids))) == 500
    given["first"] = np.array([0])
    assert len(disjoint_cover(given, len(ids))) == 500
