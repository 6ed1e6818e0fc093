"""Medit's files, ``.mesh`` as text and ``.meshb`` in binary, versions 1 to 4, as mmg, gmsh and FreeFem write them.

What the counts of the sections announce must be there; whether the file ends with ``End`` says nothing, and many
writers leave it out.
"""

import re
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import medit_binary
from wct_plugin.io.medit_sections import CELLS, SETS, CellSection, SetSection
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.io.text_lines import Lines, numbers, shown, whole_numbers
from wct_plugin.types import Floats, Ints

REFERENCES = "medit:ref"

_KEYWORD = re.compile(rb"(?![Nn][Aa][Nn]$|[Ii][Nn][Ff])[A-Za-z]\w*$")
_CELLS: dict[str, CellSection] = {one.name.lower(): one for one in CELLS} | {"hexaedra": CELLS[5]}
_SETS: dict[str, SetSection] = {one.name.lower(): one for one in SETS}


@dataclass
class Read:
    """What was read so far: rows by section, and the names of sections that were left."""

    points: Floats | None = None
    references: Ints | None = None
    cells: dict[CellSection, Ints] = field(default_factory=dict)  #: corners, from 1, and reference
    sets: dict[SetSection, Ints] = field(default_factory=dict)  #: numbers, from 1
    lost: list[str] = field(default_factory=list)

    def put_vertices(self, points: Floats, references: Ints) -> None:
        """Keep the vertices; they come once."""
        if self.points is not None:
            raise InputError("has section 'Vertices' twice")
        self.points, self.references = points, references

    def put(self, section: CellSection | SetSection, rows: Ints) -> None:
        """Keep the rows of another section; it comes once."""
        into: dict[Any, Ints] = self.cells if isinstance(section, CellSection) else self.sets
        if section in into:
            raise InputError(f"has section {section.name!r} twice")
        into[section] = rows

    def lose(self, name: str, count: int | None) -> None:
        """Note a section that is not read."""
        self.lost.append(
            f"section {name!r}" + ("" if count is None else f" of {count} entr{'y' if count == 1 else 'ies'}")
        )


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the file holds, and the names of what of it is not read.

    mmg's Corners, RequiredVertices, Ridges, RequiredEdges and RequiredTriangles are sets of these names: of tagged
    vertices, edges and facets. Raises :class:`InputError`, without the file's name, where a section is not as it says.
    """
    data = path.read_bytes()
    found = medit_binary.sections(data, Read()) if medit_binary.is_binary(data) else _text_sections(data)
    return _raw(found), found.lost


def _text_sections(text: bytes) -> Read:
    found, dimension = Read(), 0
    for name, content in _split(text):
        match name.lower():
            case "meshversionformatted":
                version = _single(name, content)
                if version not in (0, 1, 2, 3, 4):
                    raise InputError(f"is of version {version}; allowed are 1, 2, 3 and 4")
            case "dimension":
                dimension = _single(name, content)
                if dimension not in (2, 3):
                    raise InputError(f"has dimension {dimension}; allowed are 2 and 3")
            case "end":
                break
            case "vertices":
                if not dimension:
                    raise InputError("has no 'Dimension' before its 'Vertices'")
                rows = _rows(name, content, dimension + 1, np.float64)
                found.put_vertices(rows[:, :-1], whole_numbers(rows[:, -1]))
            case low if low in _CELLS:
                found.put(_CELLS[low], _rows(name, content, _CELLS[low].corners + 1, np.int64))
            case low if low in _SETS:
                found.put(_SETS[low], _rows(name, content, 1, np.int64)[:, 0])
            case _:
                word = content.split(None, 1)[:1]
                found.lose(name, int(word[0]) if word and word[0].isdigit() else None)
    return found


def _split(text: bytes) -> list[tuple[str, bytes]]:
    """Each keyword with what stands between it and the next."""
    if b"#" in text:
        text = re.sub(rb"#[^\n\r]*", b"", text)
    if text.lstrip().startswith(b"MFEM "):
        raise InputError("is a mesh of MFEM, not of Medit; MFEM's Mesh::PrintVTU writes it as .vtu, which is read")
    lines = Lines.of(text)
    letters = (lines.first | 32) - np.uint8(97) < 26
    found: list[tuple[str, bytes]] = []
    keywords = [row for row in np.flatnonzero(letters).tolist() if _KEYWORD.match(lines.line(row).split()[0])]
    for row, following in pairwise([*keywords, len(lines)]):
        for word in lines.line(row).split():  # a line may have several, each with its number
            if _KEYWORD.match(word):
                found.append((word.decode("ascii"), b""))
            else:
                found[-1] = (found[-1][0], found[-1][1] + b" " + word)
        found[-1] = (found[-1][0], found[-1][1] + b"\n" + lines.block(row + 1, following))
    if not found or found[0][0].lower() != "meshversionformatted":
        raise InputError(f"begins with {shown(text.split(None, 1)[0]) if text.split() else 'nothing'}; expected "
                         "'MeshVersionFormatted'")  # fmt: skip
    return found


def _single(name: str, content: bytes) -> int:
    found = numbers(content, np.int64)
    if len(found) != 1:
        raise InputError(f"keyword {name!r} has {len(found)} numbers behind it; expected one")
    return int(found[0])


def _rows(name: str, content: bytes, width: int, kind: type[Any]) -> NDArray[Any]:
    try:
        found = numbers(content, kind)
    except InputError as error:
        raise InputError(f"section {name!r} {error}") from None
    if not len(found):
        raise InputError(f"section {name!r} has no number of entries")
    count = int(found[0]) if np.isfinite(found[0]) else -1
    if count < 0 or len(found) - 1 != count * width:
        raise InputError(
            f"section {name!r} announces {count} entries of {width} numbers each, {count * width} in all; "
            f"found {len(found) - 1}"
        )
    return found[1:].reshape(count, width)


def _raw(found: Read) -> RawMesh:
    if found.points is None or found.references is None:
        raise InputError("has no section 'Vertices'")
    blocks, references = [], []
    for section, rows in found.cells.items():
        blocks.append(RawBlock(section.kind, rows[:, :-1] - 1))
        references.append(rows[:, -1])
    counts = {block.type: len(block) for block in blocks} | {"vertex": len(found.points)}
    members = {one: _numbered(one, rows, counts.get(one.kind, 0)) for one, rows in found.sets.items()}
    named = [rows for one, rows in members.items() if one.kind == "vertex"]
    if named:  # the points that are named are the tagged vertices
        nodes = np.unique(np.concatenate(named))
        blocks.append(RawBlock("vertex", nodes[:, None]))
        references.append(np.zeros(len(nodes), dtype=np.int64))
        members |= {one: np.searchsorted(nodes, rows) for one, rows in members.items() if one.kind == "vertex"}
    return RawMesh(
        found.points,
        blocks,
        point_data={REFERENCES: found.references},
        cell_data={REFERENCES: list(references)},
        cell_sets={
            one.name: [rows if block.type == one.kind else None for block in blocks] for one, rows in members.items()
        },
    )


def _numbered(section: SetSection, rows: Ints, count: int) -> Ints:
    bad = rows[(rows < 1) | (rows > count)]
    if len(bad):
        what = {"vertex": "vertex", "line": "edge", "triangle": "triangle"}[section.kind]
        allowed = f"allowed are 1 to {count}" if count else "there are none"
        raise InputError(f"section {section.name!r} names {what} {bad[0]}; {allowed}")
    return np.unique(rows) - 1
