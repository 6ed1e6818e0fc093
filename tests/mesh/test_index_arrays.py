"""Components against SciPy's, and half-facets against their definition."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from support.builders import ball, kuhn_cube

from wct_plugin.core import _core
from wct_plugin.mesh.index_arrays import components
from wct_plugin.mesh.topology import FACETS


@pytest.mark.parametrize("links", [0, 1, 30, 90, 300])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_components_are_those_of_scipy(links, seed):
    count = 100
    rows, columns = np.random.default_rng(seed).integers(0, count, (2, links))
    graph = coo_array((np.ones(links), (rows, columns)), shape=(count, count))
    np.testing.assert_array_equal(components(rows, columns, count), connected_components(graph, directed=False)[1])


def test_components_are_numbered_by_their_first_nodes():
    assert components(np.array([3, 1]), np.array([0, 2]), 5).tolist() == [0, 1, 1, 0, 2]
    assert components(np.array([], dtype=np.int64), np.array([], dtype=np.int64), 0).tolist() == []
    table = np.array([[4, 0], [0, 2]])
    assert components(table[:, 0], table[:, 1], 5).tolist() == [0, 1, 0, 2, 0]  # columns of a table are no copies


def test_links_to_nodes_that_are_not_there_are_refused():
    with pytest.raises(ValueError, match="a link ends at 5; there are 5 nodes"):
        components(np.array([0]), np.array([5]), 5)
    with pytest.raises(ValueError, match="columns has length 1; it must be 2"):
        _core.components(np.array([0, 1]), np.array([0]), 5)


@pytest.mark.parametrize("mesh", [kuhn_cube(3), ball(4)], ids=["cube", "ball"])
def test_half_facets_that_face_each_other_have_the_same_corners(mesh):
    pairs, single, crowded = _core.facet_pairs(mesh.tets, len(mesh.points))
    assert not crowded
    corners = np.sort(mesh.tets[:, FACETS].reshape(-1, 3), axis=1)
    np.testing.assert_array_equal(corners[pairs[:, 0]], corners[pairs[:, 1]])
    assert (pairs[:, 0] < pairs[:, 1]).all()
    assert (np.diff(pairs[:, 0]) > 0).all()
    assert (np.diff(single) > 0).all()
    assert sorted([*pairs.ravel(), *single]) == list(range(len(corners)))
    assert len(np.unique(corners[single], axis=0)) == len(single)
    assert len(np.unique(corners, axis=0)) == len(pairs) + len(single)


def test_a_facet_of_three_tets_is_told():
    tets = np.array([[0, 1, 2, 3], [0, 2, 1, 4], [0, 1, 2, 5]])
    pairs, single, crowded = _core.facet_pairs(tets, 6)
    assert crowded
    assert len(pairs) == 0
    assert len(single) == 12
