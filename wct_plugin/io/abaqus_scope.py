"""Nodes, elements and sets as an Abaqus part numbers them; a part may stand in the assembly several times."""

from dataclasses import dataclass, field

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.abaqus_blocks import Block
from wct_plugin.io.abaqus_elements import Element, element_of
from wct_plugin.io.text_lines import whole_number, whole_numbers
from wct_plugin.types import Floats, Ints


@dataclass
class Elements:
    """Elements of one type."""

    type: str
    element: Element
    ids: Ints  #: (k,)
    nodes: Ints  #: (k, d) numbers of nodes


@dataclass
class Members:
    """A piece of a set, as one block has it."""

    instance: str = ""  #: whose numbers these are, in small letters; empty for the scope's own
    ids: Ints = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    ranges: Ints = field(default_factory=lambda: np.empty((0, 3), dtype=np.int64))  #: first, last, step
    names: list[str] = field(default_factory=list)  #: of other sets


@dataclass
class NamedSet:
    """A set with its name as it was first spelled."""

    name: str
    pieces: list[Members] = field(default_factory=list)
    elsets: list[str] = field(default_factory=list)  #: sets of elements whose nodes are in it, in small letters


@dataclass
class Scope:
    """What is numbered together."""

    name: str = ""
    ids: list[Ints] = field(default_factory=list)
    points: list[Floats] = field(default_factory=list)
    elements: list[Elements] = field(default_factory=list)
    others: list[int] = field(default_factory=list)  #: numbers of elements that are no cells
    nsets: dict[str, NamedSet] = field(default_factory=dict)  #: by name in small letters
    elsets: dict[str, NamedSet] = field(default_factory=dict)

    def take(self, block: Block, others: dict[str, int]) -> None:
        """Keep what a block says of nodes, elements and sets; count elements that are no cells, by type."""
        match block.keyword:
            case "NODE":
                self._nodes(block)
            case "ELEMENT":
                self._elements(block, others)
            case "NSET":
                self._set(self.nsets, block, block.name("NSET"))
            case "ELSET":
                self._set(self.elsets, block, block.name("ELSET"))

    def _nodes(self, block: Block) -> None:
        system = block.parameters.get("SYSTEM", "R").upper()
        if system != "R":
            raise InputError(f"has *NODE with SYSTEM={system}; allowed are nodes in rectangular coordinates")
        table = block.table()
        if table is None:
            rows = [block.numbers(row[:4]) for row in block.rows()]
            table = np.array([row + [0.0] * (4 - len(row)) for row in rows]).reshape(-1, 4)
        if not len(table):
            return
        if table.shape[1] < 2:
            raise InputError("has *NODE with a line of one number; expected a number and coordinates")
        ids = whole_numbers(table[:, 0])
        points = np.zeros((len(table), 3))
        points[:, : min(table.shape[1], 4) - 1] = table[:, 1:4]  # normals may follow
        self.ids.append(ids)
        self.points.append(points)
        if "NSET" in block.parameters:
            _named(self.nsets, block.name("NSET")).pieces.append(Members(ids=ids))

    def _elements(self, block: Block, others: dict[str, int]) -> None:
        type_ = block.name("TYPE").upper()
        element = element_of(type_)
        if element is None:
            ids = _first_numbers(block)
            self.others += ids
            others[type_] = others.get(type_, 0) + len(ids)
            if "ELSET" in block.parameters:
                _named(self.elsets, block.name("ELSET")).pieces.append(Members(ids=np.array(ids, dtype=np.int64)))
            return
        width = 1 + element.nodes
        table = block.table() if element.kind.startswith("line") else None
        if table is not None and table.shape[1] > width:  # a node for the direction of a beam is behind the others
            flat = whole_numbers(table[:, :width]).ravel()
        else:
            flat = block.integers()
        if len(flat) % width:
            raise InputError(f"has {len(flat)} numbers for elements of type {type_}; expected {width} for each")
        rows = flat.reshape(-1, width)
        self.elements.append(Elements(type_, element, rows[:, 0], rows[:, 1:]))
        if "ELSET" in block.parameters:
            _named(self.elsets, block.name("ELSET")).pieces.append(Members(ids=rows[:, 0]))

    def _set(self, into: dict[str, NamedSet], block: Block, name: str) -> None:
        found = _named(into, name)
        instance = block.parameters.get("INSTANCE", "").lower()
        if into is self.nsets and block.parameters.get("ELSET"):
            found.elsets.append(block.parameters["ELSET"].lower())
            return
        if "GENERATE" in block.parameters:
            ranges = [whole_numbers(np.array(block.numbers(row))).tolist() for row in block.rows()]
            bad = next((row for row in ranges if len(row) not in (2, 3) or (len(row) == 3 and row[2] < 1)), None)
            if bad:
                raise InputError(f"has the line {bad} in set {name!r}; expected first, last and step")
            table = np.array([[*row, 1][:3] for row in ranges], dtype=np.int64).reshape(-1, 3)
            found.pieces.append(Members(instance, ranges=table))
            return
        try:
            found.pieces.append(Members(instance, ids=block.integers()))
        except InputError:  # there are names among them
            words = [word.strip('"') for row in block.rows() for word in row if word]
            ids = [whole_number(word, "member") for word in words if word.isdigit()]
            names = [word for word in words if not word.isdigit()]
            found.pieces.append(Members(instance, ids=np.array(ids, dtype=np.int64), names=names))


def _named(into: dict[str, NamedSet], name: str) -> NamedSet:
    return into.setdefault(name.lower(), NamedSet(name))


def _first_numbers(block: Block) -> list[int]:
    """The number of each element, whose data may go on in lines behind one that ends with a comma."""
    found, goes_on = [], False
    for line in block.data.split(b"\n"):
        line = line.strip()
        if line and not goes_on:
            word = line.split(b",")[0].strip()
            if word.isdigit():
                found.append(whole_number(word, "element"))
        goes_on = line.endswith(b",") if line else goes_on
    return found
