"""SU2's meshes, read and written here: meshio keeps no names of markers, and fails on writing any boundary cell.

The number of a tag whose marker has a name stands in a comment, so that it comes back.
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.io.text_lines import columns_of_rows, number_rows, whole_number
from wct_plugin.types import Floats, Ints

#: By VTK's number of a kind of cell: what meshio calls it, and how many points it has.
_KINDS = {
    1: ("vertex", 1),
    3: ("line", 2),
    5: ("triangle", 3),
    9: ("quad", 4),
    10: ("tetra", 4),
    12: ("hexahedron", 8),
    13: ("wedge", 6),
    14: ("pyramid", 5),
}
_NUMBERS = {kind: number for number, (kind, _) in _KINDS.items()}
_VOLUMES = ("tetra", "hexahedron", "wedge", "pyramid")
_FACES = ("triangle", "quad")
_KEYWORD = re.compile(rb"^[ \t]*([A-Z][A-Z_0-9]*)[ \t]*=[ \t]*([^\r\n]*)", re.MULTILINE)
_TAG = re.compile(rb"^% tag (-?\d+) is marker (\S+)\s*$", re.MULTILINE)


def read(file: Path) -> tuple[RawMesh, list[str]]:
    """Points, cells, and as tags of boundary cells their markers: the number, or one of its own under its name."""
    text = file.read_bytes()
    known = {_name(name): int(tag) for tag, name in _TAG.findall(text)}
    text = re.sub(rb"%[^\r\n]*", b"", text)
    heads = list(_KEYWORD.finditer(text))
    ends = [*(head.start() for head in heads[1:]), len(text)]
    values = {head[1].decode(): head[2].strip() for head in heads}
    dimension = _name(values.get("NDIME", b"not there"))
    if dimension not in ("2", "3"):
        raise InputError(f"NDIME is {dimension}; allowed are 2 and 3")
    points: Floats = np.empty((0, int(dimension)))
    blocks: list[RawBlock] = []
    owners: list[int] = []  # of each block its marker, or -1
    markers: list[str] = []
    for head, end in zip(heads, ends, strict=True):
        key, value, body = head[1].decode(), head[2].strip(), text[head.end() : end]
        try:
            if key == "NPOIN":
                points = _points(body, _count(value), int(dimension))
            elif key == "MARKER_TAG":
                markers.append(_name(value))
            elif key in ("NELEM", "MARKER_ELEMS"):
                found = _cells(body, _count(value))
                blocks += found
                owners += [len(markers) - 1 if key == "MARKER_ELEMS" else -1] * len(found)
        except InputError as error:
            raise InputError(f"{key} {error}") from None
    announced = _count(values["NMARK"]) if "NMARK" in values else len(markers)
    if len(markers) != announced:
        raise InputError(f"has {len(markers)} markers but announces {announced}")
    numbers = _numbers(markers, known)
    of_owner = [*(numbers[name] for name in markers), 0]
    tags = [np.full(len(block), of_owner[at]) for at, block in zip(owners, blocks, strict=True)]
    named = {name: np.array([tag, int(dimension) - 1]) for name, tag in numbers.items() if not _is_number(name)}
    return RawMesh(points, blocks, cell_data={"su2:tag": [*tags]}, field_data=named), []


def _name(name: bytes) -> str:
    return name.decode("utf-8", "surrogateescape")


def _count(value: bytes) -> int:
    count = whole_number((value.split() or [b""])[0], "the count")  # NPOIN may have further numbers
    if count < 0:
        raise InputError(f"has the count {count}; allowed are 0 and more")
    return count


def _points(body: bytes, count: int, dimension: int) -> Floats:
    """The coordinates; behind them a number of the point, or several, may stand."""
    values, widths = number_rows(body, np.float64)
    if count == 0 or len(widths) != count or (widths < dimension).any():
        raise InputError(f"has {len(values)} coordinates and numbers of points but announces {count} points")
    return np.ascontiguousarray(columns_of_rows(values, widths, 0, dimension))


def _cells(body: bytes, count: int) -> list[RawBlock]:
    """The cells by kind, each in the order of the file; a number of its own may stand behind each."""
    values, widths = number_rows(body, np.int64)
    if len(widths) != count:
        raise InputError(f"has {len(widths)} cells but announces {count}")
    starts = np.cumsum(widths) - widths
    kinds = values[starts]
    blocks = []
    for kind in dict.fromkeys(kinds.tolist()):
        if kind not in _KINDS:
            raise InputError(f"has cells of kind {kind}; allowed are {', '.join(map(str, _KINDS))}")
        name, width = _KINDS[kind]
        mine = np.flatnonzero(kinds == kind)
        lengths = np.unique(widths[mine]).tolist()
        if lengths not in ([width + 1], [width + 2]):
            found = ", ".join(map(str, lengths))
            raise InputError(f"has lines of {found} numbers for {name} cells; allowed is {width + 1}, or one more")
        blocks.append(RawBlock(name, values[starts[mine, None] + np.arange(1, width + 1)]))
    return blocks


def _numbers(markers: Sequence[str], known: Mapping[str, int]) -> dict[str, int]:
    """A tag for each marker: its own number, the one that a comment gives, or the next that is free."""
    numbers = {name: int(name) for name in markers if _is_number(name)}
    for name in markers:
        if name in known and known[name] not in numbers.values():
            numbers.setdefault(name, known[name])
    for name in markers:
        numbers.setdefault(name, max(0, *numbers.values(), 0) + 1)
    return numbers


def _is_number(name: str) -> bool:
    return re.fullmatch(r"-?\d+", name) is not None


def can_name(name: str) -> bool:
    """Whether a marker can have this name: SU2 takes out blanks, and a number would be that of a tag."""
    return name.split() == [name] and not _is_number(name) and not set("%=()") & set(name)


def write(
    path: Path,
    points: Floats,
    cells: Sequence[tuple[str, Ints]],
    tags: Sequence[Ints],
    names: Mapping[int, str],
) -> None:
    """Write volumes, and faces as markers by their tags, under the ``names`` of tags that have one.

    ``cells``: each kind with its cells (k, d), ``tags``: for each kind those of its cells.
    """
    volumes = [(_NUMBERS[kind], rows) for kind, rows in cells if kind in _VOLUMES]
    faces = [(_NUMBERS[kind], rows, own) for (kind, rows), own in zip(cells, tags, strict=True) if kind in _FACES]
    markers = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *(own for _, _, own in faces)])).tolist()
    with path.open("w", encoding="utf-8", errors="surrogateescape") as file:
        file.writelines(f"% tag {marker} is marker {names[marker]}\n" for marker in markers if marker in names)
        file.write(f"NDIME= 3\nNPOIN= {len(points)}\n")
        file.writelines(f"{x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        file.write(f"NELEM= {sum(len(rows) for _, rows in volumes)}\n")
        for kind, rows in volumes:
            file.writelines(_rows(kind, rows))
        file.write(f"NMARK= {len(markers)}\n")
        for marker in markers:
            mine = [(kind, rows[own == marker]) for kind, rows, own in faces]
            file.write(f"MARKER_TAG= {names.get(marker, marker)}\nMARKER_ELEMS= {sum(len(one) for _, one in mine)}\n")
            for kind, one in mine:
                file.writelines(_rows(kind, one))


def _rows(kind: int, cells: Ints) -> list[str]:
    return [f"{kind} " + " ".join(map(str, cell)) + "\n" for cell in cells.tolist()]
