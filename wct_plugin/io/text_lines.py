"""Lines of text and the numbers in them, found in bulk: NumPy and the core go over all bytes, Python over none."""

import re
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from wct_plugin.core import _core
from wct_plugin.errors import InputError
from wct_plugin.types import Bools, Floats, Ints

Number = TypeVar("Number", np.int64, np.float64)

_WHOLE = re.compile(r"\s*[+-]?[0-9]{1,30}\s*", re.ASCII)  # int() takes no other blanks
_BLANK = 32  #: bytes up to this one, which is that of the space, are blank


@dataclass(frozen=True, eq=False)
class Lines:
    """A text, and where its lines are, whichever of the usual bytes they end with."""

    text: bytes
    starts: Ints  #: (k,) where each begins
    ends: Ints  #: (k,) where its line feed is, or the end of the text
    words: Ints  #: (k,) where its first byte that is no blank is; its end where there is none

    @classmethod
    def of(cls, text: bytes) -> "Lines":
        """The lines of a text; blank ones are lines too."""
        if b"\n" not in text:
            text = text.replace(b"\r", b"\n")
        bytes_ = np.frombuffer(text, dtype=np.uint8)
        ends = np.flatnonzero(bytes_ == 10)
        if len(text) and not text.endswith(b"\n"):
            ends = np.append(ends, len(text))
        starts = np.concatenate([[0], ends[:-1] + 1])[: len(ends)]
        return cls(text, starts, ends, _first_words(bytes_, starts, ends))

    def __len__(self) -> int:
        return len(self.starts)

    @property
    def first(self) -> NDArray[np.uint8]:
        """(k,) the first byte of each line that is no blank; 0 in blank lines."""
        if not self.text:
            return np.empty(0, dtype=np.uint8)
        bytes_ = np.frombuffer(self.text, dtype=np.uint8)
        found = bytes_[np.minimum(self.words, len(bytes_) - 1)]
        found[self.words >= self.ends] = 0
        return found

    def line(self, row: int) -> bytes:
        """One line, without the blanks around it."""
        return self.text[self.starts[row] : self.ends[row]].strip()

    def block(self, first: int, last: int) -> bytes:
        """The text of the lines from ``first`` up to, but not with, ``last``."""
        return self.text[self.starts[first] : self.ends[last - 1]] if last > first else b""

    def pick(self, chosen: Bools) -> bytes:
        """The text of the lines of a mask (k,)."""
        rows = np.flatnonzero(chosen)
        if not len(rows):
            return b""
        if rows[-1] - rows[0] + 1 == len(rows):
            return self.block(int(rows[0]), int(rows[-1]) + 1)
        lengths = np.minimum(self.ends + 1, len(self.text)) - self.starts
        return np.frombuffer(self.text, dtype=np.uint8)[np.repeat(chosen, lengths)].tobytes()


def _first_words(bytes_: NDArray[np.uint8], starts: Ints, ends: Ints) -> Ints:
    """(k,) where the first word of each line begins, a step to the right at a time for all that are indented."""
    words = starts.copy()
    pending = np.flatnonzero(words < ends)
    while len(pending):
        pending = pending[bytes_[words[pending]] <= _BLANK]
        words[pending] += 1
        pending = pending[words[pending] < ends[pending]]
    return words


def numbers(text: bytes, kind: type[Number]) -> NDArray[Number]:
    """All numbers of a text, which blanks part; exponents may be Fortran's D.

    Raises :class:`InputError` naming the first word that is none, or no whole number where these are wanted.
    """
    return number_rows(text, kind)[0]


def numbers_of_type(text: bytes, dtype: np.dtype[Any]) -> NDArray[Any]:
    """All numbers of a text in a type; whole ones where the type is of whole numbers."""
    return (numbers(text, np.float64) if dtype.kind == "f" else numbers(text, np.int64)).astype(dtype)


def number_rows(text: bytes, kind: type[Number], head: bytes = b"", stop: bytes = b"") -> tuple[NDArray[Number], Ints]:
    """The numbers of a text, and how many each line has that is read: that has any word, or begins with ``head``.

    What of a word is behind the letter ``stop`` is left out.
    """
    values, widths, _ = _read(text, kind, head, stop, 0, None)
    return values, widths


def next_rows(text: bytes, kind: type[Number], start: int, count: int) -> tuple[NDArray[Number], Ints, int]:
    """The numbers of so many lines that have any, from a place on, how many each has, and the place behind them."""
    return _read(text, kind, b"", b"", start, count)


def _read(
    text: bytes, kind: type[Number], head: bytes, stop: bytes, start: int, lines: int | None
) -> tuple[NDArray[Number], Ints, int]:
    reader: Any = _core.read_reals if kind is np.float64 else _core.read_integers
    values, widths, end, good = reader(text, head, stop, start, lines)
    if not good:
        word = text[end : end + 200].split(None, 1)[0]
        raise InputError(f"has {shown(word)} where a {'' if kind is np.float64 else 'whole '}number should be")
    return values, widths, end


def whole_numbers(values: Floats | Ints) -> Ints:
    """Numbers that must be whole; :class:`InputError` names the first that is not, or has more than 64 bits."""
    if values.dtype.kind == "f":
        bad = np.flatnonzero(~((values == np.rint(values)) & (np.abs(values) < 2.0**63)))
        if len(bad):
            raise InputError(f"has {float(values.flat[bad[0]])!r} where a whole number should be")
    return values.astype(np.int64)


def whole_number(word: str | bytes, what: str) -> int:
    """The whole number that a word is; :class:`InputError` says what should be one."""
    text = decoded(word) if isinstance(word, bytes) else word
    if not _WHOLE.fullmatch(text) or not -(2**63) <= int(text) < 2**63:
        raise InputError(f"has {what} {shown(text.encode('utf-8', 'replace'))}; allowed is a whole number")
    return int(text)


def decoded(name: bytes) -> str:
    """A name as text: UTF-8, or what Windows programs write where it is none."""
    try:
        return name.decode("utf-8")
    except UnicodeDecodeError:
        return name.decode("latin-1")


def shown(word: bytes, most: int = 40) -> str:
    """A piece of a file as it may stand in a message."""
    text = word.decode("utf-8", "replace")
    return repr(text if len(text) <= most else text[:most] + "...")


def columns_of_rows(values: NDArray[Number], widths: Ints, first: int, count: int) -> NDArray[Number]:
    """(k, count) of rows of any ``widths`` (k,), one after the other, so many numbers from the ``first`` on."""
    if _alike(widths):
        table: NDArray[Number] = values.reshape(len(widths), -1)[:, first : first + count]
        return table
    starts = np.cumsum(widths) - widths
    found: NDArray[Number] = values[(starts + first)[:, None] + np.arange(count)]
    return found


def lists_of_rows(values: NDArray[Number], widths: Ints, first: Ints, counts: Ints) -> NDArray[Number]:
    """Of each row so many numbers from its ``first`` (k,) on, all one after the other."""
    if _alike(widths) and _alike(first) and _alike(counts):
        table: NDArray[Number] = values.reshape(len(widths), -1)[:, first[0] : first[0] + counts[0]]
        return table.ravel()
    starts = np.cumsum(widths) - widths + first
    ends = np.cumsum(counts)
    at = np.arange(int(counts.sum())) + np.repeat(starts - (ends - counts), counts)
    found: NDArray[Number] = values[at]
    return found


def _alike(numbers: Ints) -> bool:
    return bool(len(numbers) and (numbers == numbers[0]).all())
