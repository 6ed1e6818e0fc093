"""What bounds rounding, counted by running the code itself on numbers that count.

A number here is exact, and beside it stand the sum of the same products with every term replaced by its absolute
value, and through how many roundings a term has gone at most. NumPy's arrays of objects take it through code that is
written for floating point.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Half a unit in the last place of 1.
EPS = Fraction(1, 2**53)


@dataclass(frozen=True)
class Counted:
    """A value that was computed as a sum of products."""

    value: Fraction
    size: Fraction
    roundings: int

    def __add__(self, other: Any) -> "Counted":
        if not isinstance(other, Counted):  # the 0 that sum() begins with
            assert other == 0
            return self
        return Counted(self.value + other.value, self.size + other.size, max(self.roundings, other.roundings) + 1)

    __radd__ = __add__

    def __sub__(self, other: "Counted") -> "Counted":
        if self.roundings == other.roundings == 0:  # coordinates are exact, so their difference is rounded once
            difference = self.value - other.value
            return Counted(difference, abs(difference), 1)
        return self + -other

    def __neg__(self) -> "Counted":
        return Counted(-self.value, self.size, self.roundings)

    def __mul__(self, other: Any) -> "Counted":
        if isinstance(other, Counted):
            return Counted(self.value * other.value, self.size * other.size, self.roundings + other.roundings + 1)
        assert float(np.frexp(abs(other))[0]) == 0.5  # powers of two round nothing
        return Counted(self.value * Fraction(other), self.size * abs(Fraction(other)), self.roundings)

    __rmul__ = __mul__

    def __float__(self) -> float:
        return float(self.value)

    def sqrt(self) -> float:
        """What roots are taken of are lengths, which no sign depends on."""
        return float(self.value) ** 0.5


def counted(array: NDArray[np.float64]) -> NDArray[np.object_]:
    """The numbers of an array as exact ones."""
    out = np.empty(array.shape, dtype=object)
    out.ravel()[:] = [Counted(Fraction(x), abs(Fraction(x)), 0) for x in array.ravel().tolist()]
    return out
