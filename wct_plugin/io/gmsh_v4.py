"""Sections of gmsh's files of versions 4.0 and 4.1. What text and binary differ in is in the stream of numbers."""

from collections.abc import Callable
from typing import Any

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.gmsh_file import Elements, Format, GmshFile
from wct_plugin.io.gmsh_kinds import kind_of
from wct_plugin.io.number_streams import NumberStream

INT, REAL = "i4", "f8"


def _entities(stream: NumberStream, form: Format, file: GmshFile) -> None:
    for dimension, count in enumerate(stream.whole(form.size, 4)):
        for _ in range(count):
            (tag,) = stream.whole(INT, 1)
            file.groups[dimension, tag] = _rest_of_entity(stream, form, dimension)
    stream.check_end()


def _partitioned(stream: NumberStream, form: Format, file: GmshFile) -> None:
    _, ghosts = stream.whole(form.size, 2)
    stream.take(INT, 2 * ghosts)
    for dimension, count in enumerate(stream.whole(form.size, 4)):
        for _ in range(count):
            tag, *parent = stream.whole(INT, 3)
            (partitions,) = stream.whole(form.size, 1)
            stream.take(INT, partitions)
            _rest_of_entity(stream, form, dimension)
            file.parents[dimension, tag] = (parent[0], parent[1])
    stream.check_end()
    file.lost.append("partitions")


def _rest_of_entity(stream: NumberStream, form: Format, dimension: int) -> list[int]:
    """Its groups, from among its box and what bounds it; a minus is one for groups that turn it round."""
    stream.take(REAL, 3 if dimension == 0 and form.version == "4.1" else 6)
    groups = stream.whole(INT, stream.whole(form.size, 1)[0])
    if dimension:
        stream.take(INT, stream.whole(form.size, 1)[0])
    return [abs(tag) for tag in groups]


def _nodes(stream: NumberStream, form: Format, file: GmshFile) -> None:
    newer = form.version == "4.1"
    blocks, total, *_ = stream.whole(form.size, 4 if newer else 2)
    ids, points = [np.empty(0, dtype=np.int64)], [np.empty((0, 3))]
    for _ in range(blocks):
        one, other, parametric = stream.whole(INT, 3)
        (count,) = stream.whole(form.size, 1)
        dimension = one if newer else other
        if dimension not in (0, 1, 2, 3):
            raise InputError(f"has nodes of an entity of dimension {dimension}; allowed are 0 to 3")
        width = 3 + (dimension if parametric else 0)  # a number for each dimension of the entity
        if newer:
            ids.append(stream.take(form.size, count))
            points.append(stream.records(count, (REAL, width))[0][:, :3])
        else:
            tags, places = stream.records(count, (INT, 1), (REAL, width))
            ids.append(tags[:, 0])
            points.append(places[:, :3])
    stream.check_end()
    found = np.concatenate(ids)
    if len(found) != total:
        raise InputError(f"announces {total} nodes and has {len(found)}")
    file.put_nodes(found, np.concatenate(points))


def _elements(stream: NumberStream, form: Format, file: GmshFile) -> None:
    newer = form.version == "4.1"
    blocks, total, *_ = stream.whole(form.size, 4 if newer else 2)
    found: list[Elements] = []
    read = 0
    for _ in range(blocks):
        one, other, number = stream.whole(INT, 3)
        dimension, tag = (one, other) if newer else (other, one)
        (count,) = stream.whole(form.size, 1)
        kind = form.size if newer else INT
        (rows,) = stream.records(count, (kind, 1 + kind_of(number).nodes))
        read += count
        parent = file.parents.get((dimension, tag), (dimension, tag))
        if parent[0] != dimension:  # made by who cut the mesh, between two parts
            continue
        groups = file.groups.get(parent, [])
        first = np.full(count, groups[0] if groups else 0)
        found.append(Elements(number, rows[:, 0], rows[:, 1:], first, np.full(count, parent[1])))
        for group in groups:
            file.members.setdefault((dimension, group), []).append(rows[:, 0])
        file.shared.update((dimension, group) for group in groups[1:])
    stream.check_end()
    if read != total:
        raise InputError(f"announces {total} elements and has {read}")
    file.put_elements(found)


def _periodic(stream: NumberStream, form: Format, file: GmshFile) -> None:
    (count,) = stream.whole(form.size if form.version == "4.1" else INT, 1)
    for _ in range(count):
        dimension, *tags = stream.whole(INT, 3)
        if form.version == "4.1":
            affine = stream.take(REAL, stream.whole(form.size, 1)[0])
            pairs = stream.records(stream.whole(form.size, 1)[0], (form.size, 2))[0]
        else:  # in binary; a negative number says that a map comes before the number of pairs
            (many,) = stream.whole(form.size, 1)
            affine = stream.take(REAL, 16 if many < 0 else 0)
            pairs = stream.records(stream.whole(form.size, 1)[0] if many < 0 else many, (INT, 2))[0]
        file.periodic.append((dimension, tuple(tags), affine if len(affine) else None, pairs))
    stream.check_end()


READERS: dict[str, Callable[[NumberStream, Format, GmshFile], Any]] = {
    "Entities": _entities,
    "PartitionedEntities": _partitioned,
    "Nodes": _nodes,
    "Elements": _elements,
    "Periodic": _periodic,
}
#: Sections that have numbers in binary files.
BINARY = (*READERS, "NodeData", "ElementData")
