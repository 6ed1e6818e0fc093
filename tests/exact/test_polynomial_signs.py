"""Exact signs: the filter never lies, integers decide the rest; against fractions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.builders import rotation
from support.certifying import circumcenter, cosines, power

from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import exact_signs, exact_values

LATTICE = st.lists(st.tuples(*[st.integers(-3, 3)] * 3), min_size=5, max_size=5)
TET = np.arange(4)[None]


def _signs(polynomial, points, cells):
    return exact_signs(polynomial, points, np.atleast_2d(cells)).values.tolist()[0]


def _sign(value):
    return (value > 0) - (value < 0)


def _perturbed(corners, seed, ulps, scale):
    """Lattice points in a rotated frame, some coordinates a few units in the last place off."""
    rng = np.random.default_rng(seed)
    points = np.array(corners, dtype=float) @ rotation(seed % 5).T if seed % 2 else np.array(corners, dtype=float)
    return (points + rng.integers(-ulps, ulps + 1, points.shape) * np.spacing(points)) * scale


@given(LATTICE, st.integers(0, 9), st.integers(0, 2), st.sampled_from([1.0, 0.1, 2.0**-400, 1e-310, 1e200]))
def test_agree_with_fractions(corners, seed, ulps, scale):
    points = _perturbed(corners, seed, ulps, scale)
    assert _signs(predicates.corners, points, [0, 1, 2]) == [_sign(value) for value in cosines(points[:3])]
    turned = _signs(predicates.volume, points, [0, 1, 2, 3])[0]
    if turned == 0:
        return
    if turned < 0:
        points = points[[1, 0, 2, 3, 4]]
    _, inside = circumcenter(points[:4])
    assert _signs(predicates.circumcenter, points, [0, 1, 2, 3]) == [_sign(value) for value in inside]
    assert _signs(predicates.circumsphere, points, [0, 1, 2, 3, 4]) == [_sign(power(points[:4], points[4]))]
    scaled = exact_values(predicates.circumcenter, points[:4])
    assert [value / sum(scaled) for value in scaled] == inside


@pytest.mark.parametrize("polynomial", [predicates.volume, predicates.circumcenter])
@pytest.mark.parametrize("flatness", [1.0, 1e-8, 1e-15])
def test_the_bound_holds(polynomial, flatness):
    """The error of what the filter computes is below its bound for random and nearly flat tets."""
    from wct_plugin.exact.polynomial_signs import _rounded

    points = np.random.default_rng(0).uniform(-0.5, 0.5, (50, 4, 3)) * [1.0, 1.0, flatness] @ rotation(1).T
    edges = (points[:, 1:] - points[:, :1]).transpose(1, 2, 0)
    for column, found in enumerate(polynomial(*map(_rounded, edges))):
        for k, corners in enumerate(points):
            exact = exact_values(polynomial, corners)[column]
            assert abs(float(exact - type(exact)(found.value[k]))) <= found.bound()[k] + 1e-300


def test_a_grid_takes_integers_once_per_shape():
    sizes = []

    def counting(*edges):
        if isinstance(edges[0][0], np.ndarray):  # of integers; the filter's are of another kind
            sizes.append(len(edges[0][0]))
        return predicates.circumcenter(*edges)

    points = np.stack(np.meshgrid(*[np.arange(8.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    corner = np.flatnonzero((points < 7).all(axis=1))[:, None]
    shapes = np.array([[0, 64, 8, 1], [0, 64, 72, 73], [0, 8, 72, 73]])
    found = exact_signs(counting, points, (corner + shapes[:, None]).reshape(-1, 4))
    k = len(corner)
    assert np.array_equal(found.values, np.repeat([[-1, 1, 1, 1], [1, 0, 0, 1], [1, 0, 0, 1]], k, axis=0))
    assert found.exactly == 2 * k  # the corner of a cube is clear to the filter
    assert sizes == [2]


def test_equal_rounded_edges_are_not_taken_for_equal_shapes():
    """The edges from a point 2^-60 above the origin round to those from the origin."""
    points = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0**-60], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 2.0**-61]])
    cells = np.array([[0, 2, 4], [1, 2, 4], [0, 2, 3], [1, 2, 3]])
    for dots in (predicates.corners, lambda u, v: (predicates.corners(u, v)[0],)):
        found = exact_signs(dots, points, cells)
        assert found.values[:, 0].tolist() == [_sign(cosines(points[cell])[0]) for cell in cells]
    assert found.values[2:, 0].tolist() == [0, 1]


def test_exact_zeros_of_flat_faces_need_no_integers():
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(size=(40, 2)), np.full(40, 0.3)])
    found = exact_signs(predicates.volume, points, rng.permuted(np.tile(np.arange(40), (30, 1)), axis=1)[:, :4])
    assert not found.values.any()
    assert found.exactly == 0


def test_no_cells():
    found = exact_signs(predicates.circumcenter, np.zeros((4, 3)), np.empty((0, 4), dtype=np.int64))
    assert found.values.shape == (0, 4)
    assert found.exactly == 0
