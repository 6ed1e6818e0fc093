"""Sections of gmsh's files of versions 1 and 2.0 to 2.2: elements of all kinds one after the other."""

import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.gmsh_file import Elements, Format, GmshFile, Section
from wct_plugin.io.gmsh_kinds import kind_of
from wct_plugin.io.number_streams import BinaryNumbers, TextNumbers
from wct_plugin.io.text_lines import numbers
from wct_plugin.types import Floats, Ints

#: So many rows are looked at first to see how far all are alike, then twice as many again and again.
_FIRST = 64


def _nodes(section: Section, form: Format, file: GmshFile) -> None:
    count, stream = _counted(section, form, real=True)
    ids, points = stream.records(count, ("i4", 1), ("f8", 3))
    _check_end(stream)
    file.put_nodes(ids[:, 0], points)


def _parametric_nodes(section: Section, form: Format, file: GmshFile) -> None:
    """Nodes with dimension and number of their entity, and then one or two parameters where it has that dimension."""
    count, stream = _counted(section, form, real=True)
    if isinstance(stream, TextNumbers):
        rows = [part[:, :4] for part in _runs(stream.rest, [4], lambda row: 6 + _parameters(int(row[4])))]
    else:
        rows = []
        for _ in range(count):
            ids, place, entity = stream.records(1, ("i4", 1), ("f8", 3), ("i4", 2))
            stream.take("f8", _parameters(int(entity[0, 0])))
            rows.append(np.hstack([ids, place]))
    table = np.concatenate([np.empty((0, 4)), *rows])
    if len(table) != count:
        raise InputError(f"announces {count} nodes and has {len(table)}")
    file.put_nodes(table[:, 0].astype(np.int64), table[:, 1:])


def _parameters(dimension: int) -> int:
    return dimension if dimension in (1, 2) else 0


def _elements(section: Section, form: Format, file: GmshFile) -> None:
    count, stream = _counted(section, form, real=False)
    found = []
    if isinstance(stream, TextNumbers):
        parts = _runs(stream.rest, [1, 2], lambda row: 3 + _tags(int(row[2])) + kind_of(int(row[1])).nodes)
        found = [_of_rows(int(rows[0, 1]), rows[:, 0], rows[:, 3:], int(rows[0, 2]), file) for rows in parts]
    else:
        while sum(len(one.ids) for one in found) < count:
            number, many, tags = stream.whole("i4", 3)
            (rows,) = stream.records(many, ("i4", 1 + _tags(tags) + kind_of(number).nodes))
            if not many:
                raise InputError("has a block of no elements")
            found.append(_of_rows(number, rows[:, 0], rows[:, 1:], tags, file))
    _put(found, count, file)


def _of_rows(number: int, ids: Ints, rest: Ints, tags: int, file: GmshFile) -> Elements:
    """Elements of a type from rows of tags, the group first and then the entity, and nodes."""
    none = np.zeros(len(ids), dtype=np.int64)
    if tags > 3 or (tags == 3 and rest[:, 2].any()):
        file.lost += ["partitions"] * ("partitions" not in file.lost)
    return Elements(number, ids, rest[:, tags:], rest[:, 0] if tags > 0 else none, rest[:, 1] if tags > 1 else none)


def _tags(count: int) -> int:
    if not 0 <= count <= 10_000:
        raise InputError(f"has an element of {count} tags")
    return count


def _elements_1(section: Section, form: Format, file: GmshFile) -> None:
    """As in version 1: number, type, group, entity, how many nodes, nodes."""
    count, stream = _counted(section, form, real=False)
    assert isinstance(stream, TextNumbers)
    parts = _runs(stream.rest, [1, 4], lambda row: 5 + kind_of(int(row[1])).nodes)
    found = [Elements(int(rows[0, 1]), rows[:, 0], rows[:, 5:], rows[:, 2], rows[:, 3]) for rows in parts]
    _put(found, count, file)


def _put(found: list[Elements], count: int, file: GmshFile) -> None:
    read = sum(len(one.ids) for one in found)
    if read != count:
        raise InputError(f"announces {count} elements and has {read}")
    file.put_elements(found)


def _runs(flat: Any, keys: list[int], width_of: Callable[[Any], int]) -> Iterator[Any]:
    """Rows one after the other, of a width that some of their columns tell, as tables of rows alike in these."""
    at = 0
    while at < len(flat):
        if at + max(keys) >= len(flat):
            raise InputError("ends within an element")
        width = width_of(flat[at:])
        there = (len(flat) - at) // width
        if not there:
            raise InputError("ends within an element")
        alike, looked = 0, _FIRST
        while alike < there:
            rows = flat[at + alike * width : at + min(alike + looked, there) * width].reshape(-1, width)
            other = np.flatnonzero((rows[:, keys] != flat[at:][keys]).any(axis=1))
            alike += int(other[0]) if len(other) else len(rows)
            if len(other):
                break
            looked *= 2
        yield flat[at : at + alike * width].reshape(alike, width)
        at += alike * width


def _periodic(section: Section, form: Format, file: GmshFile) -> None:
    """Text in binary files too: dimension and two entities, perhaps a map, how many pairs of nodes, the pairs."""
    lines = [line for line in section.text.splitlines() if line.strip()]
    count, at = (int(lines[0]) if lines else 0), 1
    for _ in range(count):
        dimension, *tags = (int(word) for word in lines[at].split())
        at += 1
        affine: Floats | None = None
        if lines[at].startswith(b"Affine"):
            affine = numbers(lines[at].removeprefix(b"Affine"), np.float64)
            at += 1
        many = int(lines[at])
        pairs = numbers(b"\n".join(lines[at + 1 : at + 1 + many]), np.int64).reshape(many, 2)
        file.periodic.append((dimension, tuple(tags), affine, pairs))
        at += 1 + many


def _counted(section: Section, form: Format, *, real: bool) -> tuple[int, TextNumbers | BinaryNumbers]:
    """The count that a section begins with, which is text in binary files too, and the numbers behind it."""
    if not form.binary:
        found = re.match(rb"\s*(\d+)\s", section.text)
        if not found:
            raise InputError("does not begin with a count")
        return int(found[1]), TextNumbers(section.text[found.end() :], real=real)
    line = section.numbers.data[section.numbers.at : section.numbers.at + 40].split(b"\n", 1)[0]
    if not line.strip().isdigit():
        raise InputError("does not begin with a count")
    section.numbers.at += len(line) + 1
    return int(line), section.numbers


def _check_end(stream: TextNumbers | BinaryNumbers) -> None:
    if isinstance(stream, TextNumbers) and len(left := stream.rest):
        raise InputError(f"has {len(left)} numbers more than it announces")


READERS: dict[str, Callable[[Section, Format, GmshFile], Any]] = {
    "Nodes": _nodes,
    "ParametricNodes": _parametric_nodes,
    "Elements": _elements,
    "Periodic": _periodic,
    "NOD": _nodes,
    "ELM": _elements_1,
}
#: Sections that have numbers in binary files.
BINARY = ("Nodes", "ParametricNodes", "Elements", "NodeData", "ElementData")
