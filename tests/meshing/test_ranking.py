"""Which of several results is taken."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import two_region_cube

from wct_plugin.core.results import SearchResult
from wct_plugin.meshing import search_mesh
from wct_plugin.meshing.kept_volumes import volume_missed
from wct_plugin.meshing.local_search import best, ranked
from wct_plugin.meshing.reference import own_boundary

NONE = np.empty(0, dtype=np.int64)
MESH = two_region_cube(2)
OWN = own_boundary(MESH, 40.0)
START = search_mesh.from_mesh(MESH, OWN, pinned=False)


def found(bad=0, beyond=0.0, points=START.points):
    mesh = replace(START, points=points)
    return SearchResult(mesh, bad, np.arange(bad), beyond, 0, 0, 0, 0, 0, stopped=False, released=NONE)


def test_few_bad_tets_come_first_and_of_equals_the_last():
    one, two, three = found(2), found(1), found(1)
    assert ranked([one, two, three]) == [three, two, one]
    assert best([one, two, three]) is three


def test_a_surface_that_moved_is_worse_than_some_bad_tets():
    moved, kept = found(2, beyond=1.6), found(3, beyond=0.2)
    assert ranked([kept, moved]) == [kept, moved]
    assert ranked([moved, found(30)])[0] is moved


def test_equals_are_told_apart_by_the_volumes_of_their_regions():
    grown, same, worse = found(points=1.01 * START.points), found(), found(1)
    assert volume_missed(same, OWN) == 0.0
    assert volume_missed(grown, OWN) == pytest.approx(1.01**3 - 1.0 - 0.005, rel=1e-9)
    assert volume_missed(found(points=1.001 * START.points), OWN) == 0.0
    assert ranked([same, grown, worse], lambda one: volume_missed(one, OWN)) == [same, grown, worse]
    assert ranked([same, grown])[0] is grown
