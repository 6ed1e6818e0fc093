"""The polynomials whose signs say what a mesh is like, for :mod:`.polynomial_signs`; and the orientation of tets.

Each takes the edges from the first point of a cell to its other points and gives a tuple of values.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.exact.polynomial_signs import Vector, exact_signs


def orientation(points: NDArray[np.float64], tets: NDArray[np.int64]) -> NDArray[np.int64]:
    """Exact sign of det(x1-x0, x2-x0, x3-x0) per tet: 1, -1, or 0 for four coplanar points.

    ``points`` (n, 3) finite, ``tets`` (m, 4); returns (m,).
    """
    return exact_signs(volume, points, tets).values[:, 0].astype(np.int64)


def turned(points: NDArray[np.float64], tets: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The tets (m, 4) with the negative ones turned round, and the exact sign (m,) that each had before."""
    before = orientation(points, tets)
    negative = before < 0
    if negative.any():
        tets = tets.copy()
        tets[negative] = tets[negative][:, [0, 1, 3, 2]]
    return tets, before


def volume(u: Vector, v: Vector, w: Vector) -> tuple[Any]:
    """Six times the signed volume of a tet."""
    return (_dot(u, _cross(v, w)),)


def circumcenter(u: Vector, v: Vector, w: Vector) -> tuple[Any, Any, Any, Any]:
    """Barycentric coordinates of a tet's circumcenter, times 72 times the square of its volume, which is their sum.

    With N1 = v x w, N2 = w x u, N3 = u x v the inward normals, det = u . N1 and Q = |u|^2 N1 + |v|^2 N2 + |w|^2 N3, the
    circumcenter is x0 + Q / (2 det) and its coordinates are N_i . Q / (2 det^2).
    """
    normals = _cross(v, w), _cross(w, u), _cross(u, v)
    q = _add(_add(_scale(_dot(u, u), normals[0]), _scale(_dot(v, v), normals[1])), _scale(_dot(w, w), normals[2]))
    det = _dot(u, normals[0])
    square = det * det
    p1, p2, p3 = (_dot(normal, q) for normal in normals)
    return (square + square) - (p1 + p2 + p3), p1, p2, p3


def pulls(u: Vector, v: Vector, w: Vector) -> tuple[Any, ...]:
    """By how much :func:`circumcenter`'s value f falls, as an orthocenter's, per weight of vertex i, at 4 f + i.

    With weights |v|^2 in Q becomes |v|^2 minus the difference of the two weights, so these are the dot products
    N_f . N_i of the inward normals, N0 = -N1 - N2 - N3.
    """
    n1, n2, n3 = _cross(v, w), _cross(w, u), _cross(u, v)
    total = _add(_add(n1, n2), n3)
    normals = (tuple(x - x - x for x in total), n1, n2, n3)
    return tuple(_dot(n, m) for n in normals for m in normals)


def circumsphere(u: Vector, v: Vector, w: Vector, t: Vector) -> tuple[Any]:
    """Power of a fifth point with respect to a positive tet's circumsphere, times det: positive outside."""
    normals = _cross(v, w), _cross(w, u), _cross(u, v)
    q = _add(_add(_scale(_dot(u, u), normals[0]), _scale(_dot(v, v), normals[1])), _scale(_dot(w, w), normals[2]))
    return (_dot(t, t) * _dot(u, normals[0]) - _dot(t, q),)


def corners(u: Vector, v: Vector) -> tuple[Any, Any, Any]:
    """For each corner of a triangle the dot product of its two edges there: positive where the angle is acute."""
    uv = _dot(u, v)
    return uv, _dot(u, u) - uv, _dot(v, v) - uv


def normal(u: Vector, v: Vector) -> Vector:
    """Normal of a triangle, twice as long as its area is large."""
    return _cross(u, v)


def fold(u: Vector, v: Vector, w: Vector) -> tuple[Any]:
    """Dot product of the normals of triangles (0, 1, 2) and (0, 1, 3): negative where 2 and 3 lie to either side."""
    return (_dot(_cross(u, v), _cross(u, w)),)


def beyond_edge(u: Vector, v: Vector, t: Vector) -> tuple[Any]:
    """Positive where point 3 is beyond edge (0, 1) of triangle (0, 1, 2): past the plane that stands upright on it."""
    return (_dot(_cross(u, _cross(u, v)), t),)


def along_edges(u: Vector, v: Vector, w: Vector, t: Vector) -> tuple[Any]:
    """On which side of the plane through edge (0, 1) that is parallel to edge (2, 3) point 4 lies."""
    return (_dot(_cross(u, tuple(b - a for a, b in zip(v, w, strict=True))), t),)


def middle_above(v: Vector, w: Vector, a: Vector, b: Vector, c: Vector) -> tuple[Any]:
    """Volume of the tet with base (0, 1, 2) and the point (2 a + b + c) / 4 inside triangle (3, 4, 5), times 24."""
    return (_dot(_add(_add(a, a), _add(b, c)), _cross(v, w)),)


def _cross(v: Vector, w: Vector) -> Vector:
    return v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]


def _dot(v: Vector, w: Vector) -> Any:
    return v[0] * w[0] + v[1] * w[1] + v[2] * w[2]


def _add(v: Vector, w: Vector) -> Vector:
    return v[0] + w[0], v[1] + w[1], v[2] + w[2]


def _scale(factor: Any, v: Vector) -> Vector:
    return factor * v[0], factor * v[1], factor * v[2]
