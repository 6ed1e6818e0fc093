"""gmsh's files of versions 1, 2.0 to 2.2, 4.0 and 4.1, as text and in binary, each section parsed at once.

Partitions are put together again: an entity of a partition counts as the one that it is a part of, and cells that lie
between partitions are left out.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io import gmsh_data, gmsh_v2, gmsh_v4
from wct_plugin.io.gmsh_file import Format, GmshFile, Section
from wct_plugin.io.number_streams import BinaryNumbers, TextNumbers
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.text_lines import decoded, shown

_VERSIONS = {"1": 1, "2": 2, "2.0": 2, "2.1": 2, "2.2": 2, "4": 4, "4.0": 4, "4.1": 4}
#: Sections that have nothing of the mesh.
_SAY_NOTHING = ("Comments", "MeshFormat", "GhostElements")
_BLANKS = re.compile(rb"\s*")
_NAME = re.compile(rb'\s*(\d+)\s+(-?\d+)\s+"(.*)"\s*')


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the file holds, and the names of what of it is not read.

    ``gmsh:physical`` is the first group of each cell, ``gmsh:geometrical`` its entity; groups that have cells with
    another first group are sets too. Raises :class:`InputError`, without the file's name, for what is no good file.
    """
    data = path.read_bytes()
    form = _format(data)
    file = GmshFile()
    for section in _sections(data, form):
        _take(section, form, file)
    return file.raw(), file.lost


def _format(data: bytes) -> Format:
    if re.match(rb"\s*\$NOD\s", data):
        return Format("1", 1, False, "<", "i8")
    found = re.search(rb"^\$MeshFormat\s*\n\s*([\d.]+)\s+([01])\s+(\d+)[^\n]*\n", data[:100_000], re.MULTILINE)
    if not found:
        first = data.split(b"\n", 1)[0].strip()
        raise InputError(f"begins with {shown(first)}; expected '$MeshFormat' with version, 0 or 1, and a size")
    version, binary, size = found[1].decode(), found[2] == b"1", int(found[3])
    if version not in _VERSIONS:
        raise InputError(f"is of version {version}; allowed are 1, 2.0 to 2.2, 4.0 and 4.1")
    order = "<"
    if binary:
        one = data[found.end() : found.end() + 4]
        if one not in (b"\1\0\0\0", b"\0\0\0\1"):
            raise InputError("is binary and has no 1 of four bytes behind its version")
        order = "<" if one[0] else ">"
    return Format(version, _VERSIONS[version], binary, order, "i4" if size == 4 else "i8")


def _sections(data: bytes, form: Format) -> Iterator[Section]:
    """The sections one after the other; those in binary must have been read when the next is asked for."""
    at = 0
    while (at := _after_blanks(data, at)) < len(data):
        stop = data.find(b"\n", at)
        head = data[at : len(data) if stop < 0 else stop].strip()
        if not re.fullmatch(rb"\$\w+", head):
            raise InputError(f"has {shown(head)} where a section should begin")
        name = head[1:].decode()
        closing = b"$END" + head[1:] if form.major == 1 else b"$End" + head[1:]
        start = len(data) if stop < 0 else stop + 1
        if form.binary and name in (*gmsh_v2.BINARY, *gmsh_v4.BINARY) and not (form.major == 2 and name == "Periodic"):
            section = Section(name, b"", BinaryNumbers(data, start, form.order))
            yield section
            end = _after_blanks(data, section.numbers.at)
            if data[end : end + len(closing)] != closing:
                raise InputError(f"section ${name} is not closed by {closing.decode()} where its counts say")
        else:
            end = data.find(closing, start)
            if end < 0:
                raise InputError(f"section ${name} is not closed by {closing.decode()}")
            yield Section(name, data[start:end], BinaryNumbers(data, start, form.order))
        at = end + len(closing)


def _after_blanks(data: bytes, at: int) -> int:
    found = _BLANKS.match(data, at)
    assert found is not None  # it matches nothing, too
    return found.end()


def _take(section: Section, form: Format, file: GmshFile) -> None:
    try:
        match section.name:
            case name if name in _SAY_NOTHING:
                pass
            case "PhysicalNames":
                _names(section.text, file)
            case "NodeData" | "ElementData":
                gmsh_data.take(section, form, file)
            case "Periodic" if form.version in ("4", "4.0") and not form.binary:
                gmsh_v2.text_periodic(section, form, file)
            case name if form.major == 4 and name in gmsh_v4.READERS:
                real = name != "Elements"
                stream = section.numbers if form.binary else TextNumbers(section.text, real=real)
                gmsh_v4.READERS[name](stream, form, file)
            case name if form.major < 4 and name in gmsh_v2.READERS:
                gmsh_v2.READERS[name](section, form, file)
            case name:
                file.lost.append(f"section ${name}")
    except InputError as error:
        raise InputError(f"section ${section.name} {error}") from None


def _names(text: bytes, file: GmshFile) -> None:
    lines = text.strip().splitlines()
    announced = int(lines[0]) if lines and lines[0].strip().isdigit() else -1
    if announced != len(lines) - 1:
        raise InputError(f"announces {announced} names and has {len(lines) - 1}")
    for line in lines[1:]:
        found = _NAME.fullmatch(line)
        if not found:
            raise InputError(f"has the line {shown(line)}; expected dimension, number and a name in quotes")
        dimension, tag, name = int(found[1]), int(found[2]), decoded(found[3])
        if name in file.names:
            file.lost.append(f"name {name!r} of group {tag} of dimension {dimension}, as another group has it")
            continue
        file.names[name] = np.array([tag, dimension])
