"""Exact signs: the filter never lies, integers decide the rest; against fractions."""

from fractions import Fraction
from inspect import signature

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.builders import rotation
from support.certifying import circumcenter, cosines, power
from support.rounding import EPS, counted

from wct_plugin.exact import polynomial_signs, predicates
from wct_plugin.exact.polynomial_signs import _rounded, exact_signs, exact_values

LATTICE = st.lists(st.tuples(*[st.integers(-3, 3)] * 3), min_size=5, max_size=5)
TET = np.arange(4)[None]
POLYNOMIALS = (
    predicates.volume,
    predicates.circumcenter,
    predicates.pulls,
    predicates.circumsphere,
    predicates.corners,
    predicates.normal,
    predicates.fold,
    predicates.beyond_edge,
    predicates.along_edges,
    predicates.middle_above,
)


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
    """The edges from a point 2^-60 beside the origin round to those from the origin; one angle is right."""
    points = np.array([[0.0, 0.0, 0.0], [2.0**-60, 0.0, 0.0], [1.0, 1.0, 1.0], [1.0, -2.0, 1.0]])
    for cells in ([[0, 2, 3], [1, 2, 3]], [[1, 2, 3], [0, 2, 3]]):
        found = exact_signs(predicates.corners, points, np.array(cells))
        assert found.values[:, 0].tolist() == [_sign(cosines(points[cell])[0]) for cell in cells]
        assert set(found.values[:, 0].tolist()) == {0, -1}


def _edge_count(polynomial):
    return len(signature(polynomial).parameters)


@pytest.mark.parametrize("polynomial", POLYNOMIALS)
@pytest.mark.parametrize("flatness", [1.0, 1e-9])
def test_the_filter_counts_the_roundings_that_are_done(polynomial, flatness):
    """Its bound is one more than there are, times the exact sum of absolute values, to what that itself is rounded."""
    shape = (20, 1 + _edge_count(polynomial), 3)
    points = np.random.default_rng(0).uniform(-0.5, 0.5, shape) * [1.0, 1.0, flatness] @ rotation(1).T
    edges = (points[:, 1:] - points[:, :1]).transpose(1, 2, 0)
    exact = counted(points)
    numbers = polynomial(*(exact[:, 1:] - exact[:, :1]).transpose(1, 2, 0))
    for found, rows in zip(polynomial(*map(_rounded, edges)), numbers, strict=True):
        for value, bound, one in zip(found.value.tolist(), found.bound().tolist(), rows, strict=True):
            assert found.roundings == one.roundings < 40
            assert abs(Fraction(value) - one.value) <= one.roundings * EPS * one.size
            assert bound == pytest.approx(float((one.roundings + 1) * EPS * one.size), rel=1e-13, abs=0)


@pytest.mark.parametrize(("smallest", "exactly"), [(2.0**-167, 0), (2.0**-168, 1), (2.0**-400, 1)])
def test_zeros_are_believed_where_nothing_underflows(smallest, exactly):
    """Four points of a plane, in a box of size 1, which is scaled by a quarter: products of six of 2^-170 underflow."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, smallest, 0.0], [1.0, smallest, 0.0]])
    found = exact_signs(predicates.volume, points, TET)
    assert found.values.tolist() == [[0]]
    assert found.exactly == exactly


def test_a_value_within_its_bound_is_left_to_integers():
    """Both sides of a right angle, from where floating point may not tell to where it must."""
    exactly = []
    for off in 2.0 ** np.arange(-54, -44):
        points = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0 + off, 0.0], [-1.0, 1.0 - off, 0.0]])
        found = exact_signs(lambda u, v: (predicates.corners(u, v)[0],), points, np.array([[0, 1, 2], [0, 1, 3]]))
        assert found.values[:, 0].tolist() == [_sign(y - 1.0) for y in points[2:, 1].tolist()]
        exactly.append(found.exactly)
    bound = 6 * 2 * 2.0**-53  # five roundings, and one for the bound's own; the terms' absolute values add up to 2
    assert exactly == [2 * (off <= bound) for off in 2.0 ** np.arange(-54, -44)]


def test_the_pieces_that_cells_are_taken_in_do_not_matter(monkeypatch):
    points = np.stack(np.meshgrid(*[np.arange(3.0)] * 3), axis=-1).reshape(-1, 3)
    cells = np.random.default_rng(1).permuted(np.tile(np.arange(27), (50, 1)), axis=1)[:, :4]
    whole = exact_signs(predicates.circumcenter, points, cells)
    monkeypatch.setattr(polynomial_signs, "_CHUNK", 7)
    pieces = exact_signs(predicates.circumcenter, points, cells)
    assert np.array_equal(whole.values, pieces.values)
    assert whole.exactly == pieces.exactly > 0


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
