"""MED's families: every cell is of one, which has a number and the groups that its cells are in.

Files of others have the numbers as tags, and the groups as sets. In our own the name of a family says which tag its
cells have, of which dimension they are, and whether its first group is the name of the tag.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from wct_plugin.io import hdf5, read_limit
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.text_lines import decoded
from wct_plugin.mesh import cell_kinds
from wct_plugin.types import Ints

#: The array of tags.
TAGS = "cell_tags"
#: Bytes that the name of a group may have.
LONGEST = 80
_OURS = re.compile(r"(\d)D_TAG(-?\d+)(_NAME)?(_SET)?_-?\d+")


@dataclass(frozen=True)
class Family:
    """What the cells of a family have in common."""

    number: int
    tag: int
    name: str  #: of the tag, or none
    groups: tuple[str, ...]  #: sets that its cells are in
    dimension: int | None = None  #: of its cells, where the family says it

    @property
    def called(self) -> str:
        """The name under which it is written."""
        flags = "_NAME" * bool(self.name) + "_SET" * (bool(self.name) and self.name in self.groups)
        return f"{self.dimension}D_TAG{self.tag}{flags}_{self.number}"

    @property
    def written_groups(self) -> list[str]:
        """The groups that are written: the name of the tag first; one as gmsh gives where there would be none."""
        if not self.name:
            return list(self.groups) or [_nameless(self.dimension, self.tag)]
        return [self.name, *(group for group in self.groups if group != self.name)]


def _nameless(dimension: int | None, tag: int) -> str:
    return f"G_{dimension}D_{tag}"


def dimension_of(kind: str) -> int:
    """The dimension of MED's cells of a kind; 3 of those that are not known otherwise."""
    known = cell_kinds.dimension(kind)
    return known if known >= 0 else 2 if kind == "polygon" else 3


def fits(name: str) -> bool:
    """Whether a group can have this name."""
    return name.strip() == name and 0 < len(name.encode()) <= LONGEST and "\0" not in name


def read(families: Any) -> dict[int, Family]:
    """The families of an HDF5 group, by number."""
    found = {}
    for called, family in hdf5.children(families):
        number = hdf5.number(family, "NUM")
        groups = [_text(row) for row in hdf5.array(family["GRO"], "NOM", "iuSV")] if "GRO" in family else []
        ours = _OURS.fullmatch(called)
        if not ours:
            found[number] = Family(number, number, "", tuple(filter(None, groups)))
            continue
        dimension, tag = int(ours[1]), int(ours[2])
        name = groups.pop(0) if ours[3] and groups else ""
        sets = [group for group in groups if group != _nameless(dimension, tag)]
        found[number] = Family(number, tag, name, (*sets, *([name] if ours[4] else [])), dimension)
    return found


def _text(row: Any) -> str:
    """A name as MED holds it: bytes up to the first zero, in UTF-8, or else as older programs wrote it."""
    return decoded(np.asarray(row).astype(np.int8).tobytes().split(b"\0")[0]).strip()


def put_cells(raw: RawMesh, families: Mapping[int, Family]) -> None:
    """Tags, sets and names of tags from the families of cells, whose numbers ``raw`` has as tags."""
    numbers = [column for column in raw.cell_data.get(TAGS, []) if column is not None]
    if not numbers:
        return
    raw.cell_data[TAGS] = [_looked_up(column, {n: one.tag for n, one in families.items()}) for column in numbers]
    used = {number for column in numbers for number in np.unique(column).tolist()}
    for group in dict.fromkeys(group for one in families.values() for group in one.groups):
        ids = [number for number, one in families.items() if group in one.groups]
        if used & set(ids) or any(families[number].dimension == 3 for number in ids):
            members = [np.flatnonzero(np.isin(column, ids)) for column in numbers]
            read_limit.claim(sum(part.nbytes for part in members), f"group {group!r}")
            raw.cell_sets[group] = [*members]
    for one in families.values():
        if one.name and one.dimension is not None:
            raw.field_data[one.name] = np.array([one.tag, one.dimension])
    dimensions = [dimension_of(block.type) for block in raw.cells]
    for dimension in sorted(set(dimensions), reverse=True):
        there = {n for d, column in zip(dimensions, numbers, strict=True) if d == dimension for n in column.tolist()}
        mine = [families[number] for number in sorted(there, reverse=True) if number in families]
        for group, tag in _names_of_tags(mine).items():
            raw.field_data.setdefault(group, np.array([tag, dimension]))


def _names_of_tags(families: list[Family]) -> dict[str, int]:
    """Groups that are one family, which is in no other group: these name the tag; only for files of others."""
    groups = [group for one in families for group in one.groups]
    return {
        one.groups[0]: one.tag
        for one in families
        if one.dimension is None and len(one.groups) == 1 and groups.count(one.groups[0]) == 1
    }


def _looked_up(numbers: Ints, tags: Mapping[int, int]) -> Ints:
    found, place = np.unique(numbers, return_inverse=True)
    return np.array([tags.get(number, number) for number in found.tolist()], dtype=np.int64)[place.ravel()]


def write(parent: Any, families: Sequence[Family]) -> None:
    """Put families into an HDF5 group."""
    for family in families:
        put(parent, family.called, family.number, family.written_groups)


def put(parent: Any, called: str, number: int, groups: Sequence[str]) -> None:
    """Put one family into an HDF5 group."""
    made = parent.create_group(called)
    made.attrs.create("NUM", number)
    if groups:
        held = made.create_group("GRO")
        held.attrs.create("NBR", len(groups))
        rows = held.create_dataset("NOM", (len(groups),), dtype=f"{LONGEST}int8")
        for k, group in enumerate(groups):
            rows[k] = np.frombuffer(group.encode().ljust(LONGEST, b"\0"), dtype=np.int8)


def combined(tags: Ints, sets: Mapping[str, Ints]) -> Iterator[tuple[int, tuple[str, ...], Ints]]:
    """Each combination of a tag and sets that there is, with its members, but for that of no tag and no set.

    A set of no members comes by itself.
    """
    table = np.zeros((len(tags), 1 + len(sets)), dtype=np.int64)
    table[:, 0] = tags
    for column, members in enumerate(sets.values(), start=1):
        table[members, column] = 1
    rows, place = np.unique(table, axis=0, return_inverse=True)
    for k, row in enumerate(rows.tolist()):
        inside = tuple(name for name, having in zip(sets, row[1:], strict=True) if having)
        if row[0] or inside:
            yield row[0], inside, np.flatnonzero(place.ravel() == k)
    for name, members in sets.items():
        if not len(members):
            yield 0, (name,), members
