"""Sections of arrays per node and per element in gmsh's files, the same in versions 2 and 4."""

import re

from wct_plugin.errors import InputError
from wct_plugin.io.gmsh_file import Format, GmshFile, Section
from wct_plugin.io.number_streams import NumberStream, TextNumbers
from wct_plugin.io.text_lines import decoded, shown, whole_number

#: So many texts, numbers or columns may be announced; gmsh has 9 at most.
_MOST = 1000
_LINE = re.compile(rb"[^\n]*\n")


def take(section: Section, form: Format, file: GmshFile) -> None:
    """Keep an array; of several steps of one name the last."""
    data = section.numbers.data if form.binary else section.text
    head = _Head(data, section.numbers.at if form.binary else 0)
    strings = [head.line() for _ in range(head.count())]
    for _ in range(head.count()):  # the time, among other real numbers
        head.line()
    whole = [whole_number(head.line(), "the number") for _ in range(head.count())]
    if not strings or len(whole) < 3 or not 0 < whole[1] <= _MOST:
        raise InputError("has no name, or no numbers of columns and rows")
    name = decoded(strings[0].strip().strip(b'"'))
    columns, count = whole[1:3]
    stream: NumberStream
    if form.binary:
        section.numbers.at = head.at
        stream = section.numbers
    else:
        stream = TextNumbers(data[head.at :], real=True)
    ids, values = stream.records(count, ("i4", 1), ("f8", columns))
    stream.check_end()
    into = file.point_data if section.name == "NodeData" else file.cell_data
    before = [one for one in into if one[0] == name]
    if before:
        into.remove(before[0])
        file.lost.append(f"earlier steps of the data {name!r}")
    into.append((name, ids[:, 0], values[:, 0] if columns == 1 else values))


class _Head:
    """The lines that such a section begins with, which are text in binary files too."""

    def __init__(self, data: bytes, at: int) -> None:
        self._data, self.at = data, at

    def line(self) -> bytes:
        found = _LINE.match(self._data, self.at)
        if not found:
            raise InputError("ends within its head")
        self.at = found.end()
        return found[0].strip()

    def count(self) -> int:
        line = self.line()
        if not line.isdigit() or int(line) > _MOST:
            raise InputError(f"has {shown(line)} where a small number should be")
        return int(line)
