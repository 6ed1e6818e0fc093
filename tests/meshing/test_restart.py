"""Where the next start has shorter edges, and when only part of a mesh is made anew."""

import numpy as np
import pytest
from support.builders import regular_tet

from wct_plugin.core.domain import StratifiedMesh
from wct_plugin.core.results import SearchResult
from wct_plugin.meshing.restart import PartialRestart, ShorterEdges


def test_places_are_kept_and_others_come_with_what_was_wanted_there():
    once = ShorterEdges.nowhere().about(np.array([[0.0, 0.0, 0.0]]), np.array([2.0]))
    twice = once.about(np.array([[5.0, 5.0, 5.0], [1.0, 0.0, 0.0]]), np.array([1.0, 3.0]))
    assert np.array_equal(twice.at, [[0.0, 0.0, 0.0], [5.0, 5.0, 5.0], [1.0, 0.0, 0.0]])
    assert np.array_equal(twice.size, [2.0, 1.0, 3.0])


def stuck_in(share: float, count: int = 1000) -> SearchResult:
    """What a search of one tet, repeated, would give, that share of it stuck."""
    tet = regular_tet(2.0)
    none = np.empty(0, dtype=np.int64)
    mesh = StratifiedMesh(
        points=tet.points,
        tets=np.repeat(tet.tets, count, axis=0),
        regions=np.zeros(count, dtype=np.int64),
        stratum=np.zeros(4, dtype=np.int8),
        label=np.full(4, -1),
        size=np.ones(4),
        facets=none.reshape(0, 3),
        facet_patch=none,
        creases=none.reshape(0, 2),
        crease_curve=none,
    )
    stuck = np.arange(round(share * count))
    return SearchResult(mesh, len(stuck), stuck, 0.0, 0, 0, 0, 0, 0, stopped=False, released=none)


def test_only_a_part_is_made_anew_where_little_of_it_is_stuck():
    few = PartialRestart.of(stuck_in(0.01), 0)
    again = PartialRestart.of(stuck_in(0.01), 1)
    assert few is not None
    assert again is not None
    assert few.at == pytest.approx(np.tile(regular_tet(2.0).points.mean(axis=0), (10, 1)))
    assert few.radius == pytest.approx(np.full(10, 1.4 * 2.0))
    assert again.radius == pytest.approx(1.4 * few.radius)
    assert PartialRestart.of(stuck_in(0.02), 0) is None
