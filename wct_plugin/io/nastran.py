"""Nastran's bulk data: with executive and case control before them or without, as punch files are."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.id_rows import IdRows
from wct_plugin.io.included_files import Included
from wct_plugin.io.nastran_cards import Cards, cards
from wct_plugin.io.node_orders import from_sides_first
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.io.text_lines import Lines, decoded
from wct_plugin.types import Ints

PROPERTIES = "nastran:ref"

#: Where in the file some elements of a kind are, their cells and their properties.
_Cells = tuple[Ints, Ints, Ints]


@dataclass(frozen=True)
class _Element:
    """What the elements of a card are: with corners alone and with nodes on the edges."""

    kind: str
    corners: int
    higher: str = ""
    nodes: int = 0
    property: bool = True  #: whether the number of a property stands before the nodes


_TETS = _Element("tetra", 4, "tetra10", 10)
_PYRAMIDS = _Element("pyramid", 5, "pyramid13", 13)
_BARS, _RODS = _Element("line", 2), _Element("line", 2, property=False)
_TRIANGLES, _QUADS = _Element("triangle", 3), _Element("quad", 4)
_ELEMENTS = {
    "CTETRA": _TETS, "CPYRAM": _PYRAMIDS, "CPYRA": _PYRAMIDS,
    "CPENTA": _Element("wedge", 6, "wedge15", 15),
    "CHEXA": _Element("hexahedron", 8, "hexahedron20", 20),
    "CTRIA3": _TRIANGLES, "CTRIAR": _TRIANGLES, "CQUAD4": _QUADS, "CQUADR": _QUADS, "CSHEAR": _QUADS,
    "CTRIA6": _Element("triangle", 3, "triangle6", 6), "CQUAD8": _Element("quad", 4, "quad8", 8),
    "CBAR": _BARS, "CBEAM": _BARS, "CROD": _BARS, "CTUBE": _BARS, "CONROD": _RODS, "PLOTEL": _RODS,
}  # fmt: skip
_ELEMENTS |= {f"{name}_": _ELEMENTS[name] for name in ("CTETRA", "CPYRA", "CPENTA", "CHEXA")}  # meshio's second order
_OTHERS = re.compile(r"C(?:ELAS|DAMP|MASS|BUSH|WELD|FAST|ONM)\w*|CGAP|CVISC|CBEND|RBE[123]|RBAR1?|RROD")
_WANTED = re.compile(rf"GRID|GRDSET|{'|'.join(_ELEMENTS)}|{_OTHERS.pattern}")


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the file holds, and the names of what of it is not read, with those that it includes.

    The property of each element is its tag. Raises :class:`InputError`, without the file's name, for what is no good
    file, and for points in other coordinate systems than the basic one.
    """
    text = _with_included(path.read_bytes(), Included(path), ())
    if b"\t" in text:
        text = text.expandtabs(8)
    lines = Lines.of(text)
    rows, closed = _bulk(lines)
    grids: list[Cards] = []
    elements: list[Cards] = []
    others: dict[str, int] = {}
    for group in cards(lines, rows, _WANTED):
        match group.name:
            case "GRID":
                grids.append(group)
            case "GRDSET":
                if group.whole(1, 2).any():
                    raise InputError("has GRDSET with a coordinate system; allowed are points in the basic one, 0")
            case name if name in _ELEMENTS:
                elements.append(group)
            case name:
                others[name] = others.get(name, 0) + len(group)
    raw, lost = _raw(grids, elements)
    if not closed:
        raw.notes.append("does not end with ENDDATA: whether all of it is there cannot be told")
    return raw, lost + [f"{count} element{'s' * (count != 1)} of type {name}" for name, count in others.items()]


def _with_included(text: bytes, included: Included, within: tuple[Path, ...]) -> bytes:
    """The text with what it includes in place of the lines that say so."""
    lines = Lines.of(text)
    parts, at = [], 0
    for row in np.flatnonzero((lines.first | 32) == ord("i")).tolist():
        line, last = lines.line(row), row
        if not re.match(rb"INCLUDE\b", line, re.IGNORECASE):
            continue
        while (line.count(b"'") + line.count(b'"')) % 2 and last + 1 < len(lines):  # a long name goes on
            last += 1
            line += lines.line(last)
        name = decoded(line[7:].strip().strip(b"='\"").strip())
        path, content = included.read(name, within)
        parts += [lines.block(at, row), _with_included(content, included, (*within, path))]
        at = last + 1
    return b"\n".join([*parts, lines.block(at, len(lines))]) if parts else text


def _bulk(lines: Lines) -> tuple[Ints, bool]:
    """The lines of the bulk data that are no comments, and whether their end is said."""
    first = lines.first
    begin, end, closed = 0, len(lines), False
    for row in np.flatnonzero((first | 32) == ord("b")).tolist():
        if re.match(rb"BEGIN\s+(BULK|SUPER)", lines.line(row), re.IGNORECASE):
            begin = row + 1
            break
    for row in np.flatnonzero((first | 32) == ord("e")).tolist():
        if row >= begin and re.match(rb"END\s*(DATA|BULK)", lines.line(row), re.IGNORECASE):
            end, closed = row, True
            break
    rows = np.arange(begin, end)
    return rows[(first[begin:end] != ord("$")) & (first[begin:end] != 0)], closed


def _raw(grids: list[Cards], elements: list[Cards]) -> tuple[RawMesh, list[str]]:
    if not grids:
        raise InputError("has no GRID")
    order = np.argsort(np.concatenate([group.lines for group in grids]), kind="stable")
    head = np.concatenate([group.whole(0, 2) for group in grids])[order]
    elsewhere = np.flatnonzero(head[:, 1])
    if len(elsewhere):
        number, system = head[elsewhere[0]]
        raise InputError(f"has GRID {number} in coordinate system {system}; allowed are points in the basic one, 0")
    raw = RawMesh(np.concatenate([group.real(2, 5) for group in grids])[order], [])
    nodes, tags, halves = IdRows(head[:, 0], "GRID"), [], 0
    found: dict[str, list[_Cells]] = {}
    for group in elements:
        halves += _put_cells(group, nodes, found)
    for kind, parts in found.items():
        lines, cells, properties = (np.concatenate(columns) for columns in zip(*parts, strict=True))
        order = np.argsort(lines, kind="stable")
        raw.cells.append(RawBlock(kind, cells[order]))
        tags.append(properties[order])
    raw.cell_data[PROPERTIES] = list(tags)
    return raw, [f"nodes on edges of {halves} elements that do not have all of them"] if halves else []


def _put_cells(group: Cards, nodes: IdRows, found: dict[str, list[_Cells]]) -> int:
    """Put elements by kind into ``found``; returns how many have some of the nodes on their edges, and not all."""
    element = _ELEMENTS[group.name]
    start = 2 if element.property else 1
    corners, last = start + element.corners, start + element.nodes
    filled = np.pad(group.filled, ((0, 0), (0, max(corners - group.text.shape[1], 0))))
    bare = group.select(np.asarray(~filled[:, start:corners].all(axis=1)))
    if len(bare):
        raise InputError(f"has {group.name} {bare.whole(0, 1)[0, 0]} with fewer than {element.corners} nodes")
    there = filled[:, corners:last].sum(axis=1)
    higher = (there == last - corners) & (last > corners)
    for part, kind, end in (
        (group.select(~higher), element.kind, corners),
        (group.select(higher), element.higher, last),
    ):
        if len(part):
            cells = from_sides_first(kind, nodes.of(part.whole(start, end), f"a {group.name}"))
            tags = part.whole(1, 2)[:, 0] if element.property else np.zeros(len(part), dtype=np.int64)
            found.setdefault(kind, []).append((part.lines, cells, tags))
    return int(((there > 0) & ~higher).sum())
