"""Exact signs in NumPy: a floating-point filter for the many, rational arithmetic for the few it cannot decide."""

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

#: Shewchuk 1997, "Adaptive precision floating-point arithmetic", error bound A of orient3d: (7 + 56 eps) eps.
_ORIENT_BOUND = (7.0 + 56.0 * 2.0**-53) * 2.0**-53


def orientation(points: NDArray[np.float64], tets: NDArray[np.int64]) -> NDArray[np.int64]:
    """Exact sign of det(x1-x0, x2-x0, x3-x0) per tet: 1, -1, or 0 for four coplanar points.

    ``points`` (n, 3) finite, ``tets`` (m, 4); returns (m,).
    """
    # Rounded differences carry an error the filter's bound accounts for; overflow leaves NaN, which it never accepts.
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        a, b, c = ((points[tets[:, i]] - points[tets[:, 0]]).T for i in (1, 2, 3))
        terms = [(b[1], c[2], a[0]), (b[2], c[0], a[1]), (b[0], c[1], a[2])]
        minus = [(b[2], c[1], a[0]), (b[0], c[2], a[1]), (b[1], c[0], a[2])]
        det = sum((p * q - r * s) * t for (p, q, t), (r, s, _) in zip(terms, minus, strict=True))
        size = sum(
            (np.abs(p * q) + np.abs(r * s)) * np.abs(t) for (p, q, t), (r, s, _) in zip(terms, minus, strict=True)
        )
        lost = 1e-300 * (1.0 + np.abs(a).sum(axis=0))  # what underflow may lose in the products, magnified by an edge
        sure = np.abs(det) > _ORIENT_BOUND * size + lost
    signs = np.sign(np.where(sure, det, 0.0)).astype(np.int64)
    for index in np.flatnonzero(~sure):
        signs[index] = _orientation_exact(points[tets[index]])
    return signs


def turned(points: NDArray[np.float64], tets: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The tets (m, 4) with the negative ones turned round, and the exact sign (m,) that each had before."""
    signs = orientation(points, tets)
    negative = signs < 0
    if negative.any():
        tets = tets.copy()
        tets[negative] = tets[negative][:, [0, 1, 3, 2]]
    return tets, signs


def _orientation_exact(corners: NDArray[np.float64]) -> int:
    x0, x1, x2, x3 = ([Fraction(float(value)) for value in corner] for corner in corners)
    a, b, c = ([p - q for p, q in zip(x, x0, strict=True)] for x in (x1, x2, x3))
    det = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    return (det > 0) - (det < 0)
