"""An Abaqus input file as blocks: a keyword with its parameters, and the data lines behind it."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.included_files import Included
from wct_plugin.io.text_lines import Lines, decoded, number_rows, numbers, shown
from wct_plugin.types import Floats, Ints

_STAR = ord("*")
_PARAMETER = re.compile(r'\s*([^,="]+?)\s*(?:=\s*("[^"]*"|[^,]*?)\s*)?(?:,|$)')


@dataclass(frozen=True)
class Block:
    """A keyword, in capitals and without its star; parameters by name, in capitals, and the data lines."""

    keyword: str
    parameters: dict[str, str]
    data: bytes

    def name(self, parameter: str) -> str:
        """What a parameter says; :class:`InputError` where it is not there."""
        if not self.parameters.get(parameter):
            raise InputError(f"has *{self.keyword} without {parameter}=")
        return self.parameters[parameter]

    def rows(self) -> list[list[str]]:
        """The data line by line, as words; empty fields are empty words."""
        lines = (decoded(line).strip() for line in self.data.splitlines())
        return [[word.strip() for word in line.rstrip(",").split(",")] for line in lines if line]

    def numbers(self, words: list[str]) -> list[float]:
        """The numbers of a line; an empty field is 0."""
        try:
            return [float(word.lower().replace("d", "e")) if word else 0.0 for word in words]
        except ValueError:
            raise InputError(f"has *{self.keyword} with {words}; expected numbers") from None

    def table(self) -> Floats | None:
        """The data as (k, d) numbers; None where the lines do not have equally many, or one of them no number."""
        if re.search(rb",[ \t]*,|[A-Za-z](?<![eEdD])|\"", self.data):
            return None
        text = self.data.replace(b",", b" ")
        values, widths = number_rows(text, np.float64)
        if not len(widths):
            return np.empty((0, 0))
        return values.reshape(len(widths), -1) if (widths == widths[0]).all() else None

    def integers(self) -> Ints:
        """All whole numbers of the data, whatever lines they are in."""
        return numbers(self.data.replace(b",", b" "), np.int64)


def blocks(text: bytes, included: Included, within: tuple[Path, ...] = ()) -> Iterator[Block]:
    """The blocks of a text, and in their places those of the files it includes."""
    lines = Lines.of(text)
    first = lines.first
    bytes_ = np.frombuffer(lines.text + b"\0\0", dtype=np.uint8)
    starred = first == _STAR
    comment = starred & (bytes_[lines.words + 1] == _STAR)
    keywords = np.flatnonzero(starred & ~comment).tolist()
    before = np.flatnonzero((first > 0) & ~comment)
    if len(before) and (not keywords or before[0] < keywords[0]):
        raise InputError(f"begins with {shown(lines.line(int(before[0])))}; expected a keyword such as *HEADING")
    for row, following in pairwise([*keywords, len(lines)]):
        line, start = lines.line(row), row + 1
        while line.endswith(b",") and start < following:  # goes on in the next line
            line += b"" if comment[start] else lines.line(start)
            start += 1
        if comment[start:following].any():
            chosen = ~comment
            chosen[:start] = chosen[following:] = False
            data = lines.pick(chosen)
        else:
            data = lines.block(start, following)
        block = Block(*_parsed(line), data)
        elsewhere = block.parameters.get("INPUT")
        if block.keyword == "INCLUDE":
            path, content = included.read(block.name("INPUT"), within)
            yield from blocks(content, included, (*within, path))
        elif elsewhere and block.keyword in ("NODE", "ELEMENT", "NSET", "ELSET"):
            _, content = included.read(elsewhere, within)
            yield Block(block.keyword, block.parameters, content)
        else:
            yield block


def _parsed(line: bytes) -> tuple[str, dict[str, str]]:
    keyword, _, rest = decoded(line).partition(",")
    found = {}
    for name, value in _PARAMETER.findall(rest):
        found[" ".join(name.upper().split())] = value.strip().strip('"').strip()
    return " ".join(keyword.lstrip("*").upper().split()), found
