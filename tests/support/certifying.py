"""What the exact checks are held against: fractions and brute force, sharing no code with them."""

from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray


def _rational(point: NDArray[np.float64]) -> list[Fraction]:
    return [Fraction(float(x)) for x in point]


def _minus(p: list[Fraction], q: list[Fraction]) -> list[Fraction]:
    return [x - y for x, y in zip(p, q, strict=True)]


def dot(p: list[Fraction], q: list[Fraction]) -> Fraction:
    """Scalar product."""
    return sum((x * y for x, y in zip(p, q, strict=True)), Fraction())


def solve(rows: list[list[Fraction]], right: list[Fraction]) -> list[Fraction]:
    """The solution of a regular linear system, by Gauss-Jordan elimination."""
    table = [[*row, value] for row, value in zip(rows, right, strict=True)]
    for k in range(len(table)):
        pivot = next(i for i in range(k, len(table)) if table[i][k])
        table[k], table[pivot] = table[pivot], table[k]
        table[k] = [x / table[k][k] for x in table[k]]
        for i, row in enumerate(table):
            if i != k:
                table[i] = [x - row[k] * y for x, y in zip(row, table[k], strict=True)]
    return [row[-1] for row in table]


def circumcenter(corners: NDArray[np.float64]) -> tuple[list[Fraction], list[Fraction]]:
    """Of a tet that is not flat: the point at the same distance from all four, and its barycentric coordinates."""
    x = [_rational(corner) for corner in corners]
    edges = [_minus(p, x[0]) for p in x[1:]]
    offset = solve(edges, [dot(e, e) / 2 for e in edges])
    others = solve([[e[k] for e in edges] for k in range(3)], offset)
    return [a + b for a, b in zip(x[0], offset, strict=True)], [1 - sum(others), *others]


def power(corners: NDArray[np.float64], point: NDArray[np.float64]) -> Fraction:
    """Of a point with respect to the circumsphere of a tet."""
    center, _ = circumcenter(corners)
    near, far = _minus(_rational(corners[0]), center), _minus(_rational(point), center)
    return dot(far, far) - dot(near, near)


def cosines(corners: NDArray[np.float64]) -> list[Fraction]:
    """Dot products of the two edges at each corner of a triangle."""
    x = [_rational(corner) for corner in corners]
    return [dot(_minus(x[k - 1], x[k]), _minus(x[k - 2], x[k])) for k in range(3)]


def share_more_than_a_face(points: NDArray[np.float64], one: Any, other: Any) -> bool:
    """Whether two positive tets have a point in common that lies in no common face.

    The intersection of two tets has a vertex that is no common vertex, or it is a common face. Such a vertex is the
    one point that three independent facet planes of the two have in common.
    """
    planes = []
    for tet in (one, other):
        x = [_rational(points[v]) for v in tet]
        for k in range(4):
            p, q, r = (x[i] for i in range(4) if i != k)
            u, v = _minus(q, p), _minus(r, p)
            normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
            sign = 1 if dot(normal, _minus(x[k], p)) > 0 else -1
            planes.append(([sign * n for n in normal], sign * dot(normal, p)))
    common = [_rational(points[v]) for v in set(map(int, one)) & set(map(int, other))]
    for three in combinations(planes, 3):
        rows = [list(normal) for normal, _ in three]
        if not _determinant(rows):
            continue
        point = solve(rows, [offset for _, offset in three])
        if point not in common and all(dot(normal, point) >= offset for normal, offset in planes):
            return True
    return False


def _determinant(rows: list[list[Fraction]]) -> Fraction:
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
