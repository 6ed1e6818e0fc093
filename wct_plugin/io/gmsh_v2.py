"""Sections of gmsh's files of versions 1 and 2.0 to 2.2: elements of all kinds one after the other."""

import re
from collections.abc import Callable, Iterator
from itertools import islice
from typing import Any

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.gmsh_file import Elements, Format, GmshFile, Section
from wct_plugin.io.gmsh_kinds import kind_of
from wct_plugin.io.number_streams import BinaryNumbers, TextNumbers
from wct_plugin.io.record_runs import runs
from wct_plugin.io.text_lines import numbers, whole_number
from wct_plugin.types import Ints


def _nodes(section: Section, form: Format, file: GmshFile) -> None:
    count, stream = _counted(section, form, real=True)
    ids, points = stream.records(count, ("i4", 1), ("f8", 3))
    stream.check_end()
    file.put_nodes(ids[:, 0], points)


def _parametric_nodes(section: Section, form: Format, file: GmshFile) -> None:
    """Nodes with dimension and number of their entity, and then one or two parameters where it has that dimension."""
    count, stream = _counted(section, form, real=True)
    if isinstance(stream, TextNumbers):
        parts = runs(stream.rest, 6, lambda row: (6 + _parameters(int(row[4])), [4]))
        rows = [part[:, :4] for _, part in parts]
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
        parts = runs(stream.rest, 3, lambda row: (3 + _tags(int(row[2])) + kind_of(int(row[1])).nodes, [1, 2]))
        found = [_of_rows(int(rows[0, 1]), rows[:, 0], rows[:, 3:], int(rows[0, 2]), file) for _, rows in parts]
    else:
        found = list(_blocks(stream, count, file))
    _put(found, count, file)


def _blocks(stream: BinaryNumbers, count: int, file: GmshFile) -> Iterator[Elements]:
    """Blocks of elements of a type, of which gmsh makes one for each element: such are read in bulk."""
    while count > 0:
        at = stream.at
        number, many, tags = stream.whole("i4", 3)
        width = 1 + _tags(tags) + kind_of(number).nodes
        if not many:
            raise InputError("has a block of no elements")
        if many == 1:
            stream.at = at
            rows = stream.alike("i4", 3, 3 + width, count)[:, 3:]
        else:
            (rows,) = stream.records(many, ("i4", width))
        count -= len(rows)
        yield _of_rows(number, rows[:, 0], rows[:, 1:], tags, file)


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
    parts = runs(stream.rest, 5, lambda row: (5 + kind_of(int(row[1])).nodes, [1, 4]))
    found = [Elements(int(rows[0, 1]), rows[:, 0], rows[:, 5:], rows[:, 2], rows[:, 3]) for _, rows in parts]
    _put(found, count, file)


def _put(found: list[Elements], count: int, file: GmshFile) -> None:
    read = sum(len(one.ids) for one in found)
    if read != count:
        raise InputError(f"announces {count} elements and has {read}")
    file.put_elements(found)


def text_periodic(section: Section, form: Format, file: GmshFile) -> None:
    """Text in binary files too: dimension and two entities, perhaps a map, how many pairs of nodes, the pairs."""
    lines = [line.strip() for line in section.text.splitlines() if line.strip()]
    rest = iter(lines)
    try:
        for _ in range(whole_number(next(rest, b"0"), "the count")):
            dimension, *tags = numbers(next(rest), np.int64).tolist()
            line, affine = next(rest), None
            if line.startswith(b"Affine"):
                affine, line = numbers(line.removeprefix(b"Affine"), np.float64), next(rest)
            many = whole_number(line, "the count of pairs")
            pairs = numbers(b"\n".join(islice(rest, max(many, 0))), np.int64)
            if many < 0 or len(pairs) != 2 * many:
                raise InputError(f"announces {many} pairs of nodes and has {len(pairs)} numbers for them")
            file.periodic.append((dimension, tuple(tags), affine, pairs.reshape(many, 2)))
    except StopIteration:
        raise InputError("ends within a pair of sides") from None


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


READERS: dict[str, Callable[[Section, Format, GmshFile], Any]] = {
    "Nodes": _nodes,
    "ParametricNodes": _parametric_nodes,
    "Elements": _elements,
    "Periodic": text_periodic,
    "NOD": _nodes,
    "ELM": _elements_1,
}
#: Sections that have numbers in binary files.
BINARY = ("Nodes", "ParametricNodes", "Elements", "NodeData", "ElementData")
