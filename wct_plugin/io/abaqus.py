"""Abaqus input files, also CalculiX's: flat ones, and parts placed in an assembly as Abaqus CAE writes them.

Numbers may have gaps, keywords and types any case; files are included from beside or below. Sets of nodes and elements
are named sets. Elements that are no cells, as masses and springs, are counted and left out.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io import abaqus_names, read_limit
from wct_plugin.io.abaqus_blocks import Block, blocks
from wct_plugin.io.abaqus_scope import Elements, Scope
from wct_plugin.io.abaqus_sets import Numbered, Sets
from wct_plugin.io.id_rows import IdRows
from wct_plugin.io.included_files import Included
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.types import Floats, Ints

#: What makes nodes or elements that stand nowhere in the file, or places them otherwise than they stand there.
_MAKERS = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SYMMETRIC MODEL GENERATION")


#: Bytes that a node takes: place, number, row, and the elements at it.
_PER_NODE = 200


@dataclass
class _Placed:
    """A part where an instance puts it, or what is numbered without parts."""

    name: str  #: of the instance; empty for what is in none
    scopes: list[Scope]  #: the part, and what the instance itself adds
    matrix: Floats = field(default_factory=lambda: np.eye(3))
    offset: Floats = field(default_factory=lambda: np.zeros(3))

    def nodes(self, lost: list[str]) -> tuple[Ints, Floats]:
        """Numbers and places; of nodes that are given several times the last."""
        ids = np.concatenate([np.empty(0, dtype=np.int64), *(part for scope in self.scopes for part in scope.ids)])
        points = np.concatenate([np.empty((0, 3)), *(part for scope in self.scopes for part in scope.points)])
        last = len(ids) - 1 - np.unique(ids[::-1], return_index=True)[1]
        if len(last) < len(ids):
            lost.append(f"earlier places of {len(ids) - len(last)} nodes that are given again")
            last.sort()
            ids, points = ids[last], points[last]
        moved = bool((self.matrix != np.eye(3)).any() or self.offset.any())
        return ids, points @ self.matrix.T + self.offset if moved else points

    def elements(self) -> list[Elements]:
        """All elements, in the order of the file."""
        return [elements for scope in self.scopes for elements in scope.elements]


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the file holds, and the names of what of it is not read, with those that it includes.

    Raises :class:`InputError`, without the file's name, for what is no good file.
    """
    lost: list[str] = []
    included = Included(path)
    text = path.read_bytes()
    placed = _placed(blocks(text, included), lost)
    if not any(scope.ids for one in placed for scope in one.scopes):
        raise InputError("has no *NODE")
    raw = _Assembled(placed, lost).raw()
    abaqus_names.put_tags(raw, text)
    return raw, lost


def _placed(found: Iterable[Block], lost: list[str]) -> list[_Placed]:
    """What the blocks say, with what is in no part or instance last."""
    scope = model = Scope()
    parts: dict[str, Scope] = {}
    instances: list[_Placed] = []
    others: dict[str, int] = {}
    for block in found:
        match block.keyword:
            case "PART":
                scope = parts.setdefault(block.name("NAME").lower(), Scope(block.name("NAME")))
            case "INSTANCE":
                instances.append(_instance(block, parts))
                scope = instances[-1].scopes[-1]
            case "END PART" | "END INSTANCE":
                scope = model
            case "SURFACE":
                lost.append(f"surface {block.parameters.get('NAME', '')!r}")
            case keyword if keyword in _MAKERS:
                raise InputError(f"has *{keyword}; allowed are files that list all nodes and elements")
            case _:
                scope.take(block, others)
    lost += [f"{count} element{'s' * (count != 1)} of type {type_}" for type_, count in others.items()]
    if not instances:  # parts by themselves
        instances = [_Placed(part.name, [part]) for part in parts.values()]
    return [*instances, _Placed("", [model])]


def _instance(block: Block, parts: dict[str, Scope]) -> _Placed:
    """An instance: its first data line shifts it, its second turns it round an axis, by an angle in degrees."""
    name, part = block.name("NAME"), block.parameters.get("PART", "")
    if part.lower() not in parts:
        raise InputError(f"has instance {name!r} of part {part!r}, which is not there")
    placed = _Placed(name, [parts[part.lower()], Scope(name)])
    rows = [block.numbers(row) for row in block.rows()]
    if rows:
        placed.offset = np.array([*rows[0], 0.0, 0.0, 0.0][:3])
    if len(rows) > 1:
        if len(rows[1]) != 7 or rows[1][:3] == rows[1][3:6]:
            raise InputError(f"turns instance {name!r} by {rows[1]}; expected two different points and an angle")
        start, end, angle = np.array(rows[1][:3]), np.array(rows[1][3:6]), np.radians(rows[1][6])
        cross = np.cross(np.eye(3), (end - start) / np.linalg.norm(end - start))
        placed.matrix = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)
        placed.offset = placed.matrix @ (placed.offset - start) + start
    return placed


class _Assembled:
    """All that is placed, numbered together."""

    def __init__(self, placed: list[_Placed], lost: list[str]) -> None:
        self._placed, self._lost = placed, lost
        self._points: list[Floats] = []
        self._cells: dict[str, list[Ints]] = {}
        self._types: dict[str, str] = {}
        self._other_types: dict[tuple[str, str], list[Ints]] = {}  #: rows of elements of a kind that are of another
        self._nodes: list[Numbered] = []
        self._elements: list[Numbered] = []
        count, offset = 0, 0
        places: list[tuple[Ints, Ints]] = []
        for one in placed:
            ids, points = one.nodes(lost)
            if one.name:  # a part may be placed any number of times
                read_limit.claim(len(points) * _PER_NODE, f"instance {one.name!r}")
            self._points.append(points)
            self._nodes.append(Numbered.of(ids, offset + np.arange(len(ids))))
            rows = IdRows(ids, "node")
            numbers: list[Ints] = [np.empty(0, dtype=np.int64)]
            first = count
            for elements in one.elements():
                kind = elements.element.kind
                made = rows.of(elements.nodes, f"an element of type {elements.type}") + offset
                row = sum(len(part) for part in self._cells.get(kind, ()))
                if self._types.setdefault(kind, elements.type) != elements.type:
                    other = self._other_types.setdefault((kind, elements.type), [])
                    other.append(row + np.arange(len(made)))
                self._cells.setdefault(kind, []).append(made)
                which = list(self._cells).index(kind)
                places.append((np.full(len(made), which), row + np.arange(len(made))))
                numbers.append(elements.ids)
                count += len(made)
            others = np.array([number for scope in one.scopes for number in scope.others], dtype=np.int64)
            self._elements.append(Numbered.of(np.concatenate(numbers), np.arange(first, count), others))
            offset += len(points)
        none = np.empty(0, dtype=np.int64)
        self._which = np.concatenate([none, *(which for which, _ in places)])  #: block of each element
        self._row = np.concatenate([none, *(row for _, row in places)])  #: and its row there

    def raw(self) -> RawMesh:
        """All of it as one mesh."""
        raw = RawMesh(
            np.concatenate(self._points),
            [RawBlock(kind, np.concatenate(parts)) for kind, parts in self._cells.items()],
            element_types=self._types,
        )
        for (kind, type_), parts in self._other_types.items():
            rows: list[Ints | None] = [None] * len(self._cells)
            rows[list(self._cells).index(kind)] = np.concatenate(parts)
            raw.cell_sets[abaqus_names.TYPE_SET + type_] = rows
        names, scopes = [one.name for one in self._placed], [one.scopes for one in self._placed]
        elsets = Sets(names, scopes, self._elements, lambda scope: scope.elsets, self._lost)
        found = {name: elsets.members(*where) for name, where in elsets.every().items()}
        others = any(scope.others for of_one in scopes for scope in of_one)
        for name, members in found.items():
            if len(members) or not others:
                raw.cell_sets[name] = self._by_block(members)
            else:
                self._lost.append(f"set {name!r} of elements that are not read")
        nsets = Sets(names, scopes, self._nodes, lambda scope: scope.nsets, self._lost)
        for name, (place, key) in nsets.every().items():
            parts = [nsets.members(place, key)]
            for elset in (elset for scope in scopes[place] if key in scope.nsets for elset in scope.nsets[key].elsets):
                parts.append(self._nodes_of(elsets.members(place, elset)))
            raw.point_sets[name] = np.unique(np.concatenate(parts))
        return raw

    def _by_block(self, members: Ints) -> list[Ints | None]:
        which = self._which[members]
        return [self._row[members[which == k]] for k in range(len(self._cells))]

    def _nodes_of(self, members: Ints) -> Ints:
        parts = [np.concatenate(parts)[rows].ravel() for parts, rows in
                 zip(self._cells.values(), self._by_block(members), strict=True)]  # fmt: skip
        return np.concatenate([np.empty(0, dtype=np.int64), *parts])
