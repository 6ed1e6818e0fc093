"""From numbers that a file gives its nodes or elements, which may have gaps, to rows."""

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.types import Ints

#: A table from numbers to rows may have so many entries for each row; beyond, numbers are searched for.
_SPARSE = 8


class IdRows:
    """Which row has a number."""

    def __init__(self, ids: Ints, what: str) -> None:
        """``what``: one of those that have the numbers, for messages. Each number must be there once."""
        self._what, self._count = what, len(ids)
        self._first = int(ids.min(initial=0))
        span = int(ids.max(initial=0)) - self._first + 1
        self._table: Ints | None = None
        if span <= _SPARSE * self._count + 1000:
            self._table = np.full(span, -1, dtype=np.int64)
            self._table[ids - self._first] = np.arange(len(ids))
            distinct = int((self._table >= 0).sum())
        else:
            self._order = np.argsort(ids, kind="stable")
            self._sorted = ids[self._order]
            distinct = len(ids) - int((self._sorted[1:] == self._sorted[:-1]).sum())
        if distinct != len(ids):
            raise InputError(f"has {len(ids)} {what}s with only {distinct} different numbers")

    def find(self, wanted: Ints) -> Ints:
        """The row of each number, -1 where there is none."""
        if not self._count:
            return np.full(wanted.shape, -1, dtype=np.int64)
        if self._table is not None:
            at = wanted - self._first
            inside = (at >= 0) & (at < len(self._table))
            if inside.all():
                return self._table[at]
            return np.where(inside, self._table[np.where(inside, at, 0)], -1)
        at = np.minimum(np.searchsorted(self._sorted, wanted), self._count - 1)
        return np.where(self._sorted[at] == wanted, self._order[at], -1)

    def of(self, wanted: Ints, who: str) -> Ints:
        """The row of each number; :class:`InputError` where there is none, which ``who`` names."""
        found = self.find(wanted)
        bad = wanted[found < 0]
        if len(bad):
            raise InputError(f"has no {self._what} {bad[0]}, which {who} names")
        return found
