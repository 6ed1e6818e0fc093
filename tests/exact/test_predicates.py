"""The exact sign of a tet's volume."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.builders import rotation

from wct_plugin.exact.predicates import orientation, turned

TET = np.arange(4)[None]


def test_plain_signs():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]], dtype=float)
    tets = np.array([[0, 1, 2, 3], [0, 2, 1, 3], [0, 1, 2, 4]])
    assert orientation(points, tets).tolist() == [1, -1, 0]
    assert orientation(points, np.empty((0, 4), dtype=np.int64)).tolist() == []


@given(st.lists(st.integers(-(2**20), 2**20), min_size=12, max_size=12), st.integers(-40, 40))
def test_agrees_with_integer_arithmetic(values, exponent):
    x = [values[k : k + 3] for k in range(0, 12, 3)]
    a, b, c = ([p - q for p, q in zip(row, x[0], strict=True)] for row in x[1:])
    det = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    assert orientation(np.ldexp(np.array(x, dtype=float), exponent), TET)[0] == (det > 0) - (det < 0)


@pytest.mark.parametrize("seed", range(5))
def test_swapping_two_vertices_of_a_nearly_flat_tet_swaps_the_sign(seed):
    rng = np.random.default_rng(seed)
    for offset in (0.0, 1.0, 1e8):
        points = rng.normal(size=(4, 3)) * [1, 1, 0] @ rotation(seed).T + offset
        points[3] = points[:3].T @ rng.dirichlet(np.ones(3))  # on the plane, up to rounding
        sign = orientation(points, TET)[0]
        assert orientation(points, TET[:, [1, 0, 2, 3]])[0] == -sign
        assert orientation(points, TET[:, [1, 2, 0, 3]])[0] == sign


@pytest.mark.parametrize("size", [1e-320, 1e-200, 1e200, 1e308])
def test_extreme_units(size):
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * size
    assert orientation(points, TET)[0] == 1
    assert orientation(points, TET[:, [1, 0, 2, 3]])[0] == -1


def test_overflowing_differences():
    points = np.array([[-1, -1, -1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) * 1.7e308
    assert orientation(points, TET)[0] == 1


def test_underflow_magnified_by_a_huge_edge():
    points = np.array([[0.0, 9.79e93, 2.62e-303], [0.0, 0.0, 0.0], [3.89e-82, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert orientation(points, np.array([[0, 1, 2, 3]]))[0] == 0


def test_only_negative_tets_are_turned():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]], dtype=float)
    tets = np.array([[0, 1, 2, 3], [0, 2, 1, 3], [0, 1, 2, 4]])
    before = tets.copy()
    found, signs = turned(points, tets)
    assert found.tolist() == [[0, 1, 2, 3], [0, 2, 3, 1], [0, 1, 2, 4]]
    assert signs.tolist() == [1, -1, 0]
    assert (tets == before).all()
    assert orientation(points, found).tolist() == [1, 1, 0]
