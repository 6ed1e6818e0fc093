"""Exact signs of polynomials of coordinates: floating point decides the many, integers the few it cannot.

A polynomial is a function of the edges from a cell's first point to its others, each three numbers, that uses ``+``,
``-`` and ``*`` alone. The same function is evaluated on floating-point arrays that carry a bound of their rounding
error, on arrays of Python's integers, and on fractions; nothing is written twice.

The bound
---------
The coordinates as stored count as exact. A value that is computed from them as a sum of products, every term of which
went through at most k roundings, is the sum of the exact terms, each times (1 + e)^+-k at most, e = 2^-53; so with S
the sum of the terms' absolute values it is off by at most k e / (1 - k e) S (Higham, *Accuracy and Stability of
Numerical Algorithms*, lemma 3.1). S computed alongside in the same order is short of its value by the same factor at
most, so (k + 1) e S as computed is a bound for all k <= 40, its own rounding included. :class:`_Rounded` keeps k and S:
a difference of coordinates has k = 1; sums and differences have max(k1, k2) + 1, products k1 + k2 + 1. This is the
semi-static filter of Shewchuk (*Adaptive precision floating-point arithmetic*, 1997) with the constants derived by the
program rather than by hand.

Points are first scaled by a power of two so that differences are at most 1. What underflow then takes in the scaling
and in each product is below 2^-1074; in polynomials of degree 6 of few hundred operations it grows to less than
2^-1040, and 1e-300 is added to the bound. Where the scaling lost nothing and no edge has a component in (0, 2^-170),
there is no underflow, nothing is added, and S = 0 says that the value is exactly zero.

Integers
--------
What the filter leaves open is evaluated on the coordinates times one power of two, which are integers. Among cells
whose differences floating point holds exactly, those that are translates of each other are evaluated once, so that a
grid takes no longer than its few shapes.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.types import Floats, Ints

Vector = tuple[Any, Any, Any]
#: Edges from the first point of a cell to the others in, values out.
Polynomial = Callable[..., tuple[Any, ...]]

_EPS = 2.0**-53
_FLOOR = 1e-300
#: Products of six numbers of this size, or larger, do not underflow.
_SMALLEST = 2.0**-170
#: Cells treated together: small enough that the temporaries stay in cache.
_CHUNK = 16384


@dataclass(frozen=True, eq=False)
class Signs:
    """Exact signs of the values of a polynomial."""

    values: NDArray[np.int8]  #: (m, q) per cell and value: 1, 0 or -1
    exactly: int  #: cells that took integers; the filter decided the others


def exact_signs(polynomial: Polynomial, points: Floats, cells: Ints) -> Signs:
    """Exact signs of ``polynomial`` for ``cells`` (m, p) of finite ``points`` (n, 3)."""
    largest = float(np.abs(points).max(initial=0.0))
    exponent = int(np.frexp(largest)[1]) + 1
    scaled = np.ldexp(points, -exponent)
    faithful = bool((np.ldexp(scaled, exponent) == points).all())
    out = []
    exactly = 0
    for start in range(0, max(len(cells), 1), _CHUNK):
        part = cells[start : start + _CHUNK]
        corners = scaled.T[:, part.T]  # (3, p, c): every operation runs along contiguous memory
        edges = corners[:, 1:] - corners[:, :1]
        sizes = np.abs(edges)
        floor = 0.0 if faithful and np.where(sizes > 0.0, sizes, 1.0).min(initial=1.0) > _SMALLEST else _FLOOR
        values = polynomial(*(_rounded(edge) for edge in edges.swapaxes(0, 1)))
        found = np.empty((len(part), len(values)), dtype=np.int8)
        unsure = np.zeros(len(part), dtype=bool)
        for column, value in enumerate(values):
            found[:, column] = np.sign(value.value)
            unsure |= ~(np.abs(value.value) > value.bound() + floor) & ~((value.size == 0.0) & (floor == 0.0))
        rows = np.flatnonzero(unsure)
        if len(rows):
            exactly += len(rows)
            found[rows] = _exact_signs(polynomial, points[part[rows]])
        out.append(found)
    return Signs(np.concatenate(out), exactly)


def exact_values(polynomial: Polynomial, corners: Floats) -> tuple[Fraction, ...]:
    """The values of ``polynomial`` for one cell with ``corners`` (p, 3), in the mesh's own unit."""
    first, *others = [[Fraction(float(x)) for x in corner] for corner in corners]
    return polynomial(*(tuple(x - y for x, y in zip(other, first, strict=True)) for other in others))


@dataclass(frozen=True, eq=False)
class _Rounded:
    """A floating-point array with what bounds its rounding error, see the module's text."""

    value: Floats
    size: Floats  #: the same sum of products with every term replaced by its absolute value
    roundings: int

    def __add__(self, other: "_Rounded") -> "_Rounded":
        roundings = max(self.roundings, other.roundings) + 1
        return _Rounded(self.value + other.value, self.size + other.size, roundings)

    def __sub__(self, other: "_Rounded") -> "_Rounded":
        roundings = max(self.roundings, other.roundings) + 1
        return _Rounded(self.value - other.value, self.size + other.size, roundings)

    def __mul__(self, other: "_Rounded") -> "_Rounded":
        return _Rounded(self.value * other.value, self.size * other.size, self.roundings + other.roundings + 1)

    def bound(self) -> Floats:
        return (self.roundings + 1) * _EPS * self.size


def _rounded(edge: Floats) -> Vector:
    x, y, z = (_Rounded(component, np.abs(component), 1) for component in edge)
    return x, y, z


def _exact_signs(polynomial: Polynomial, corners: Floats) -> NDArray[np.int8]:
    """Signs by integer arithmetic for cells given by their ``corners`` (r, p, 3); returns (r, q)."""
    first, of = _distinct(corners)
    whole = _integers(corners[first])
    edges = (whole[:, 1:] - whole[:, :1]).transpose(1, 2, 0)
    values = polynomial(*(tuple(edge) for edge in edges))
    found = np.column_stack([(value > 0).astype(np.int8) - (value < 0).astype(np.int8) for value in values])
    exact: NDArray[np.int8] = found[of]
    return exact


def _integers(coordinates: Floats) -> NDArray[np.object_]:
    """The coordinates times one power of two, as Python's integers."""
    mantissas, exponents = np.frexp(coordinates)
    whole = (mantissas * 2.0**53).astype(np.int64)
    shifts = np.where(whole != 0, exponents - exponents[whole != 0].min(initial=2000), 0)
    out = np.empty(whole.size, dtype=object)
    out[:] = [number << shift for number, shift in zip(whole.ravel().tolist(), shifts.ravel().tolist(), strict=True)]
    return out.reshape(whole.shape)


def _distinct(corners: Floats) -> tuple[Ints, Ints]:
    """Cells (r, p, 3) up to translation, as far as their edges are exact in floating point.

    Returns the rows to evaluate (d,) and for every row its place among them (r,).
    """
    tail, head = corners[:, :1], corners[:, 1:]
    with np.errstate(over="ignore", invalid="ignore"):
        edges = head - tail
        used = head - edges  # the rounding error of the difference, Knuth's two-sum
        lost = (head - (edges + used)) + (used - tail)
    edges = edges.reshape(len(corners), -1) + 0.0  # no negative zeros
    exact = (lost.reshape(len(corners), -1) == 0.0).all(axis=1)
    odd = np.random.default_rng(0).integers(1, 2**63, edges.shape[1], dtype=np.uint64) * 2 + 1
    bits = edges.view(np.uint64)
    keys = ((bits ^ (bits >> np.uint64(29))) * odd).sum(axis=1, dtype=np.uint64)
    _, first, of = np.unique(keys, return_index=True, return_inverse=True)
    row = first[of]
    alone = ~(exact & exact[row] & (edges == edges[row]).all(axis=1))  # also where two shapes share a key
    row[alone] = np.flatnonzero(alone)
    rows, places = np.unique(row, return_inverse=True)
    return rows, places.ravel()
