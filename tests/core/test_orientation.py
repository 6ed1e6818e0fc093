"""Exact signs against rational arithmetic, where floating point cannot tell."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from support.core_meshes import ball, volumes

from wct_plugin.core import _core

ONE_TET = np.array([[0, 1, 2, 3]])


def exact_sign(points):
    a, b, c, d = ([Fraction(float(v)) for v in p] for p in points)
    u, v, w = ([p - q for p, q in zip(x, a, strict=True)] for x in (b, c, d))
    det = u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])
    return (det > 0) - (det < 0)


def sign(points):
    return int(_core.orientation(np.ascontiguousarray(points, dtype=np.float64), ONE_TET)[0])


@settings(max_examples=200, deadline=None)
@given(arrays(np.float64, (4, 3), elements=st.floats(allow_nan=False, allow_infinity=False)))
def test_any_finite_points(points):
    """From the smallest numbers to the largest: products under- and overflow."""
    assert sign(points) == exact_sign(points)


@settings(max_examples=200, deadline=None)
@given(
    arrays(np.float64, (3, 3), elements=st.floats(-1, 1)),
    st.floats(-2, 2),
    st.floats(-2, 2),
    st.lists(st.integers(-2, 2), min_size=12, max_size=12),
)
def test_near_coplanar_points(base, s, t, ulps):
    """A fourth point on the plane of three up to rounding, and all of them shaken by units in the last place."""
    points = np.concatenate([base, [base[0] + s * (base[1] - base[0]) + t * (base[2] - base[0])]])
    points += np.reshape(ulps, (4, 3)) * np.spacing(points)
    assert sign(points) == exact_sign(points)


def test_a_grid_of_ulps_has_all_three_signs():
    """Floating point alone gets many of these wrong (Kettner et al. 2008, here in space)."""
    a, b, c = np.array([12.0, 12.0, 12.0]), np.array([24.0, 24.0, 24.0]), np.array([24.0, 24.0, 7.0])
    found, naive = [], []
    for i in range(24):
        for j in range(24):
            d = np.array([0.5 + i * 2.0**-53, 0.5 + j * 2.0**-53, 0.25])
            points = np.stack([a, b, c, d])
            found.append(sign(points))
            naive.append(int(np.sign(volumes(points, ONE_TET)[0])))
            assert found[-1] == exact_sign(points)
    assert set(found) == {-1, 0, 1}
    assert found != naive


def test_a_mesh():
    mesh = ball(100)
    signs = _core.orientation(mesh.points, mesh.tets)
    assert signs.dtype == np.int8
    assert (signs == 1).all()
    assert (_core.orientation(mesh.points, np.ascontiguousarray(mesh.tets[:, [0, 1, 3, 2]])) == -1).all()
    assert (_core.orientation(mesh.points, np.ascontiguousarray(mesh.tets[:, [0, 1, 2, 2]])) == 0).all()


def test_bad_arguments_are_refused():
    with pytest.raises(ValueError, match="tets names point 4"):
        _core.orientation(np.zeros((4, 3)), np.array([[0, 1, 2, 4]]))
    with pytest.raises(ValueError, match="not finite"):
        _core.orientation(np.full((4, 3), np.inf), ONE_TET)
