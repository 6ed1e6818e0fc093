"""What was read of a gmsh file, section by section, and what it means together."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import read_limit
from wct_plugin.io.gmsh_kinds import kind_of
from wct_plugin.io.id_rows import IdRows
from wct_plugin.io.node_orders import from_gmsh
from wct_plugin.io.number_streams import BinaryNumbers
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.types import Floats, Ints

GROUPS, ENTITIES = "gmsh:physical", "gmsh:geometrical"


@dataclass(frozen=True)
class Format:
    """What ``$MeshFormat`` says."""

    version: str
    major: int
    binary: bool
    order: str  #: of bytes, ``<`` or ``>``
    size: str  #: type of counts and, in version 4.1, of numbers of nodes and elements


class Section(NamedTuple):
    """A section: its text, or in binary files the numbers from its place on."""

    name: str
    text: bytes
    numbers: BinaryNumbers


@dataclass
class Elements:
    """Some elements of one type."""

    type: int
    ids: Ints  #: (k,)
    nodes: Ints  #: (k, d) numbers of nodes
    groups: Ints  #: (k,)
    entities: Ints  #: (k,)


@dataclass
class GmshFile:
    """What was read so far."""

    names: dict[str, NDArray[np.int64]] = field(default_factory=dict)  #: number and dimension of a group
    ids: Ints | None = None  #: (n,) numbers of the nodes
    points: Floats | None = None  #: (n, 3)
    elements: list[Elements] | None = None
    groups: dict[tuple[int, int], list[int]] = field(default_factory=dict)  #: of entities, by dimension and number
    parents: dict[tuple[int, int], tuple[int, int]] = field(default_factory=dict)  #: of parts of entities
    members: dict[tuple[int, int], list[Ints]] = field(default_factory=dict)  #: elements by dimension and group
    shared: set[tuple[int, int]] = field(default_factory=set)  #: groups that are not the first of all their elements
    periodic: list[tuple[int, Any, Floats | None, Ints]] = field(default_factory=list)
    point_data: list[tuple[str, Ints, NDArray[Any]]] = field(default_factory=list)
    cell_data: list[tuple[str, Ints, NDArray[Any]]] = field(default_factory=list)
    lost: list[str] = field(default_factory=list)

    def put_nodes(self, ids: Ints, points: Floats) -> None:
        """Keep the nodes; they come once."""
        if self.ids is not None:
            raise InputError("is there twice")
        self.ids, self.points = ids, points

    def put_elements(self, elements: list[Elements]) -> None:
        """Keep the elements; they come once."""
        if self.elements is not None:
            raise InputError("is there twice")
        self.elements = elements

    def raw(self) -> RawMesh:
        """All of it together."""
        if self.ids is None or self.points is None:
            raise InputError("has no section $Nodes")
        if self.elements is None:
            raise InputError("has no section $Elements")
        rows = IdRows(self.ids, "node")
        raw = RawMesh(self.points, [], field_data=dict(self.names))
        columns: dict[str, list[NDArray[Any] | None]] = {GROUPS: [], ENTITIES: []}
        ids = []
        for number in dict.fromkeys(one.type for one in self.elements):
            parts = [one for one in self.elements if one.type == number]
            kind = kind_of(number)
            nodes = np.concatenate([one.nodes for one in parts])
            ids.append(np.concatenate([one.ids for one in parts]))
            raw.cells.append(RawBlock(kind.name, from_gmsh(kind.name, rows.of(nodes, "an element"))))
            columns[GROUPS].append(np.concatenate([one.groups for one in parts]))
            columns[ENTITIES].append(np.concatenate([one.entities for one in parts]))
        raw.cell_data.update(columns)
        self._put_data(raw, rows, ids)
        self._put_sets(raw, ids)
        for dimension, tags, affine, nodes in self.periodic:
            raw.periodic.append([dimension, tags, affine, rows.of(nodes, "a periodic side")])
        return raw

    def _put_data(self, raw: RawMesh, rows: IdRows, ids: list[Ints]) -> None:
        for name, at, values in self.point_data:
            raw.point_data[name] = _spread(len(raw.points), rows.of(at, f"the data {name!r}"), values)
        places = [IdRows(numbers, "element") for numbers in ids]
        for name, at, values in self.cell_data:
            found = [place.find(at) for place in places]
            if len(at) and not np.any([there >= 0 for there in found], axis=0).all():
                raise InputError(f"the data {name!r} are of an element that is not in $Elements")
            raw.cell_data[name] = [
                _spread(len(numbers), there[there >= 0], values[there >= 0]) if (there >= 0).any() else None
                for numbers, there in zip(ids, found, strict=True)
            ]

    def _put_sets(self, raw: RawMesh, ids: list[Ints]) -> None:
        """The groups that have cells with another first group."""
        names = {(int(dimension), int(tag)): name for name, (tag, dimension) in self.names.items()}
        for dimension, tag in sorted(self.shared):
            members = np.concatenate(self.members[dimension, tag])
            name = names.get((dimension, tag), str(tag))
            columns = raw.cell_sets.setdefault(name, [None] * len(ids))
            for k, numbers in enumerate(ids):
                inside = np.flatnonzero(np.isin(numbers, members))
                if len(inside):
                    read_limit.claim(inside.nbytes, f"group {name!r}")
                    columns[k] = inside


def _spread(count: int, rows: Ints, values: NDArray[Any]) -> NDArray[Any]:
    """(count, ...) the values in their rows, NaN in all others."""
    if len(rows) == count and np.array_equal(rows, np.arange(count)):
        return values
    width = int(np.prod(values.shape[1:]))
    read_limit.claim(8 * count * width, f"an array of {count} rows of {width} numbers")
    out = np.full((count, *values.shape[1:]), np.nan)
    out[rows] = values
    return out
