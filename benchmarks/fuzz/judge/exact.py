"""Signs of a tet's numbers without rounding: floats are fractions, and fractions do not round."""

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Vector = tuple[Fraction, Fraction, Fraction]


def as_fractions(rows: NDArray[np.float64]) -> list[Vector]:
    """The points (k, 3) as they are, exactly."""
    return [(Fraction(x), Fraction(y), Fraction(z)) for x, y, z in rows.tolist()]


def minus(a: Vector, b: Vector) -> Vector:
    """The vector from b to a."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Their vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> Fraction:
    """Their scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def volume6(corners: Sequence[Vector]) -> Fraction:
    """Six times the signed volume of a tet."""
    a, b, c = (minus(corner, corners[0]) for corner in corners[1:])
    return dot(a, cross(b, c))


def not_positive(points: NDArray[np.float64], tets: NDArray[np.int64]) -> list[int]:
    """The tets whose volume is not above zero; those that rounding cannot decide are decided by fractions."""
    corners = points[tets]
    with np.errstate(all="ignore"):
        sides = corners[:, 1:] - corners[:, :1]
        volumes = np.linalg.det(sides)
        sizes = np.prod(np.abs(sides).max(axis=2), axis=1)
        scale = np.abs(corners).max(axis=(1, 2)) + np.abs(sides).max(axis=(1, 2))
        clear = (volumes > 1e-9 * sizes) & (sizes > 1e-250) & (scale < 1e90)
        clear &= np.abs(sides).max(axis=2).min(axis=1) > 1e-5 * scale  # else the differences have rounded
    doubtful = np.flatnonzero(~clear)
    return [tet for tet in doubtful.tolist() if volume6(as_fractions(corners[tet])) <= 0]


#: Below this share of what it is compared with, a sign may be left open by who computes it in floats.
TIE = Fraction(1, 10**7)


def is_well_centered(corners: Sequence[Vector], tie: Fraction = Fraction(0)) -> bool:
    """Whether a tet contains its circumcenter: whether all four barycentric coordinates of it are above 0.

    The circumcenter c solves 2 (xi - x0) . (c - x0) = |xi - x0|^2. By Cramer's rule c - x0 = n / (2 D), where D is six
    times the volume; it lies inside where its coordinates with respect to the three edges are above 0 and their sum is
    below 1. With ``tie`` they must be so by that much.
    """
    a, b, c = (minus(corner, corners[0]) for corner in corners[1:])
    bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
    squares = dot(a, a), dot(b, b), dot(c, c)
    n = tuple(squares[0] * bc[k] + squares[1] * ca[k] + squares[2] * ab[k] for k in range(3))
    center: Vector = (n[0], n[1], n[2])
    double = 2 * dot(a, bc) ** 2  # 2 D^2: the coordinates are n . bc / (2 D^2) and so on, whatever the sign of D
    shares = [dot(center, normal) for normal in (bc, ca, ab)]
    return all(share > tie * double for share in shares) and sum(shares) < (1 - tie) * double


def has_acute_triangles(corners: Sequence[Vector], tie: Fraction = Fraction(0)) -> bool:
    """Whether the cosines of all angles of the four triangles of a tet are above 0, or above ``tie``."""
    for at in range(4):
        others = [minus(corners[k], corners[at]) for k in range(4) if k != at]
        for i, k in ((0, 1), (0, 2), (1, 2)):
            product = dot(others[i], others[k])
            if product <= 0 or product**2 <= tie**2 * dot(others[i], others[i]) * dot(others[k], others[k]):
                return False
    return True


def count_flags(points: NDArray[np.float64], tets: NDArray[np.int64], tie: Fraction = Fraction(0)) -> dict[str, int]:
    """How many tets are well-centered, have acute triangles only, and both; with ``tie`` those of which it is clear."""
    found: dict[str, int] = {"3wc": 0, "2wc": 0, "cwc": 0}
    for rows in points[tets]:
        corners = as_fractions(rows)
        center, triangles = is_well_centered(corners, tie), has_acute_triangles(corners, tie)
        found["3wc"] += center
        found["2wc"] += triangles
        found["cwc"] += center and triangles
    return found
