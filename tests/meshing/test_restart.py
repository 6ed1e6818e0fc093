"""Where the next start has shorter edges."""

import numpy as np
import pytest
from support.builders import regular_tet

from wct_plugin.meshing.restart import ShorterEdges


def test_places_are_the_middles_of_stuck_tets_with_a_share_of_their_edges():
    first, second = regular_tet(2.0).points, regular_tet(1.0).points + 5.0
    once = ShorterEdges.nowhere().about(first[None])
    twice = once.about(second[None])
    assert twice.at == pytest.approx(np.array([first.mean(axis=0), second.mean(axis=0)]))
    assert once.size < 2.0
    assert twice.size == pytest.approx([once.size[0], once.size[0] / 2.0])
