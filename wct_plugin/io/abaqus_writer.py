"""Writes Abaqus' input files: elements in the types that they came in, sets by name."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from wct_plugin.io.abaqus_elements import element_of
from wct_plugin.io.abaqus_names import TYPE_SET, USUAL
from wct_plugin.types import Floats, Ints

#: Numbers that a line of a set may have.
_PER_LINE = 16


def write(
    path: Path,
    points: Floats,
    cells: Sequence[tuple[str, Ints]],
    point_sets: Mapping[str, Ints],
    cell_sets: Mapping[str, Sequence[Ints]],
    types: Mapping[str, str],
    comments: Iterable[str],
) -> None:
    """Write points, cells and sets; ``cell_sets`` have row numbers for each kind of cell, ``comments`` are lines.

    ``types`` are those of elements by their kind, where it is not the usual one.
    """
    with path.open("w", encoding="utf-8") as file:
        file.write("*HEADING\nwritten by wct_plugin\n")
        file.writelines(comments)
        file.write("*NODE\n")
        numbered = enumerate(points.tolist(), start=1)
        file.writelines(f"{number}, {x!r}, {y!r}, {z!r}\n" for number, (x, y, z) in numbered)
        number, ids = 1, []
        for k, (kind, rows) in enumerate(cells):
            own = np.empty(len(rows), dtype=np.int64)
            sets = {name: of[k] for name, of in cell_sets.items()}
            for called, members in _types(kind, len(rows), types.get(kind, USUAL[kind]), sets):
                own[members] = np.arange(number, number + len(members))
                file.write(f"*ELEMENT, TYPE={called}\n")
                table = np.column_stack([own[members], rows[members] + 1])
                file.writelines(",".join(map(str, row)) + "\n" for row in table.tolist())
                number += len(members)
            ids.append(own)
        for name, of_kinds in cell_sets.items():
            if not name.startswith(TYPE_SET):
                together = [own[members] for own, members in zip(ids, of_kinds, strict=True)]
                file.writelines(_set("ELSET", name, np.concatenate(together)))
        for name, members in point_sets.items():
            file.writelines(_set("NSET", name, members + 1))


def _types(kind: str, count: int, usual: str, sets: Mapping[str, Ints]) -> Iterator[tuple[str, Ints]]:
    """The types of the cells of a kind, each with its cells."""
    rest = np.ones(count, dtype=bool)
    found = []
    for name, members in sets.items():
        known = element_of(name.removeprefix(TYPE_SET)) if name.startswith(TYPE_SET) else None
        if known and known.kind == kind and rest[members].any():
            found.append((name.removeprefix(TYPE_SET), members[rest[members]]))
            rest[members] = False
    if rest.any():
        yield usual, np.flatnonzero(rest)
    yield from found


def _set(keyword: str, name: str, members: Ints) -> Iterator[str]:
    yield f"*{keyword}, {keyword}={name}\n"
    for start in range(0, len(members), _PER_LINE):
        yield ", ".join(map(str, members[start : start + _PER_LINE].tolist())) + "\n"
