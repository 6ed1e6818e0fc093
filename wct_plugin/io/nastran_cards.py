"""The cards of Nastran's bulk data, cut into fields: small, large and free ones, with the lines that go on.

All cards of one name and layout are cut at once.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import read_limit
from wct_plugin.io.text_lines import Lines, numbers
from wct_plugin.types import Bools, Floats, Ints

_SMALL, _LARGE, _FREE = range(3)
#: Columns of the fields of a fixed line; the tenth field only names the line that it goes on in.
_FIELDS = {_SMALL: range(8, 72, 8), _LARGE: range(8, 72, 16)}
_LAST = 72
#: So many lines are cut together: the places of all their characters take memory.
_CHUNK = 1 << 16
#: Longest field of a free line that is cut.
_LONGEST = 32
#: Fields that a free line has at most as programs write it.
_USUAL = 16


@dataclass(frozen=True, eq=False)
class Cards:
    """Cards of one name; ``text`` (k, fields, characters) is what stands behind it."""

    name: str
    lines: Ints  #: (k,) where in the file each begins
    text: NDArray[np.uint8]

    def __len__(self) -> int:
        return len(self.lines)

    @property
    def filled(self) -> Bools:
        """(k, fields) whether there is anything in each."""
        return np.asarray((self.text > 32).any(axis=2))

    def select(self, chosen: Bools) -> "Cards":
        """Those of a mask (k,)."""
        return Cards(self.name, self.lines[chosen], self.text[chosen])

    def whole(self, first: int, last: int) -> Ints:
        """(k, last - first) whole numbers of some fields; 0 for empty ones."""
        return self._numbers(first, last, np.int64)

    def real(self, first: int, last: int) -> Floats:
        """(k, last - first) numbers of some fields; 0 for empty ones."""
        return self._numbers(first, last, np.float64)

    def _numbers(self, first: int, last: int, kind: type[Any]) -> NDArray[Any]:
        table = np.zeros((len(self), last - first), dtype=kind)
        there = min(last, self.text.shape[1])
        if there <= first or not len(self):
            return table
        part = np.full((len(self), there - first, self.text.shape[2] + 1), 32, dtype=np.uint8)
        part[:, :, :-1] = self.text[:, first:there]
        part[:, :, 0][(part <= 32).all(axis=2)] = ord("0")
        text = part.tobytes()
        if kind is np.float64:  # 1.5-3 is short for 1.5E-3
            text = re.sub(rb"(?<=[0-9.])(?=[+-])", b"e", text.replace(b"D", b"e").replace(b"d", b"e"))
        try:
            found = numbers(text, kind)
        except InputError as error:
            raise InputError(f"has a card {self.name} that {error}") from None
        if len(found) != part.shape[0] * part.shape[1]:
            raise InputError(f"has a card {self.name} with a blank within a number")
        table[:, : there - first] = found.reshape(part.shape[:2])
        return table


def cards(lines: Lines, rows: Ints, wanted: re.Pattern[str]) -> Iterator[Cards]:
    """The cards whose names, in capitals, are wanted, from those lines that are no comments."""
    if not len(rows):
        return
    bytes_ = np.frombuffer(lines.text + bytes(_LAST), dtype=np.uint8)
    starts, words = lines.starts[rows], lines.words[rows]
    ends = _ends(bytes_, starts, lines.ends[rows])
    layout = _layouts(bytes_, starts, ends)
    first = bytes_[words]
    goes_on = np.isin(first, np.frombuffer(b"+*,", dtype=np.uint8)) | ((layout != _FREE) & (words - starts >= 8))
    goes_on |= words >= ends
    heads = np.flatnonzero(~goes_on)
    if not len(heads):
        return
    more = np.diff(np.append(heads, len(rows))) - 1
    names = _names(bytes_, words[heads], ends[heads])
    second = np.where(more > 0, layout[np.minimum(heads + 1, len(rows) - 1)], -1)
    every, which = np.unique(names, return_inverse=True)
    for number, name in enumerate(every.tolist()):
        if not wanted.fullmatch(name.decode("latin-1")):
            continue
        own = np.flatnonzero(which == number)
        keys, group = np.unique(
            np.column_stack([layout[heads[own]], second[own], more[own]]), axis=0, return_inverse=True
        )
        for k in range(len(keys)):
            at = heads[own[group.ravel() == k]]
            parts = [_cut(bytes_, starts[at + j], ends[at + j], int(layout[at[0] + j])) for j in range(keys[k, 2] + 1)]
            width = max(part.shape[2] for part in parts)
            padded = [np.pad(part, ((0, 0), (0, 0), (0, width - part.shape[2])), constant_values=32) for part in parts]
            yield Cards(name.decode("latin-1"), rows[at], np.concatenate(padded, axis=1))


def _ends(bytes_: NDArray[np.uint8], starts: Ints, ends: Ints) -> Ints:
    """Where the lines end but for comments."""
    dollars = np.flatnonzero(bytes_ == ord("$"))
    if len(dollars):
        ends = ends.copy()
        line = np.searchsorted(starts, dollars, side="right") - 1
        inside = (line >= 0) & (dollars < ends[line])
        np.minimum.at(ends, line[inside], dollars[inside])
    return ends


def _layouts(bytes_: NDArray[np.uint8], starts: Ints, ends: Ints) -> Ints:
    """Whether each line has small or large fields, or fields between commas."""
    found = np.full(len(starts), _SMALL)
    for sign, meant in (("*", _LARGE), (",", _FREE)):
        at = np.flatnonzero(bytes_ == ord(sign))
        line = np.searchsorted(starts, at, side="right") - 1
        inside = (line >= 0) & (at < ends[line]) & ((meant == _FREE) | (at < starts[line] + 8))
        found[line[inside]] = meant
    return found


def _names(bytes_: NDArray[np.uint8], words: Ints, ends: Ints) -> NDArray[np.bytes_]:
    """(k,) the name each line begins with, in capitals, without the star of large fields."""
    window = words[:, None] + np.arange(8)
    chars = np.where(window < ends[:, None], bytes_[np.minimum(window, len(bytes_) - 1)], 32)
    stop = np.cumsum((chars <= 32) | (chars == ord("*")) | (chars == ord(",")), axis=1) > 0
    chars = np.where((chars >= ord("a")) & (chars <= ord("z")), chars - 32, chars)
    return np.where(stop, 0, chars).astype(np.uint8).view("S8").ravel()


def _cut(bytes_: NDArray[np.uint8], starts: Ints, ends: Ints, layout: int) -> NDArray[np.uint8]:
    """(k, fields, characters) the fields of lines of one layout, without the first of each."""
    if layout == _FREE:
        return _cut_free(bytes_, starts, ends)
    columns = _FIELDS[layout]
    out = np.empty((len(starts), _LAST - 8), dtype=np.uint8)
    for begin in range(0, len(starts), _CHUNK):
        part = slice(begin, begin + _CHUNK)
        window = starts[part, None] + np.arange(8, _LAST)
        out[part] = np.where(window < ends[part, None], bytes_[np.minimum(window, len(bytes_) - 1)], 32)
    return out.reshape(len(starts), len(columns), columns.step)


def _cut_free(bytes_: NDArray[np.uint8], starts: Ints, ends: Ints) -> NDArray[np.uint8]:
    commas = np.flatnonzero(bytes_ == ord(","))
    first = np.searchsorted(commas, starts)
    count = np.searchsorted(commas, ends) - first
    fields = int(count.max(initial=0))
    size = len(starts) * _LONGEST
    read_limit.claim_more(size * fields, size * _USUAL, f"lines of {fields} fields")
    out = np.full((len(starts), fields, _LONGEST), 32, dtype=np.uint8)
    for k in range(fields):
        has = np.flatnonzero((k < count) & ~((k == 8) & (count == 9)))  # the tenth only names the line it goes on in
        begin = commas[first[has] + k] + 1
        stop = np.where(k + 1 < count[has], commas[np.minimum(first[has] + k + 1, len(commas) - 1)], ends[has])
        window = begin[:, None] + np.arange(_LONGEST)
        out[has, k] = np.where(window < stop[:, None], bytes_[np.minimum(window, len(bytes_) - 1)], 32)
    # A plus alone, as the last of a line, only says that it goes on.
    out[(out == ord("+")).any(axis=2) & ((out > 32).sum(axis=2) == 1)] = 32
    small = out[:, :8] if fields in (8, 9) else out
    return np.pad(small, ((0, 0), (0, max(8 - small.shape[1], 0)), (0, 0)), constant_values=32)
