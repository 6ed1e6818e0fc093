"""Regions by number and groups by name: one made of the other, for what knows only names."""

from collections.abc import Mapping

import numpy as np

from wct_plugin.mesh.index_arrays import masks
from wct_plugin.types import Ints


def regions_of(groups: Mapping[str, Ints], count: int) -> tuple[Ints, dict[str, int], dict[str, Ints]]:
    """A tag for each of ``count`` cells (0: in no group), the tags that have names, and groups that stay sets.

    There is a tag for each combination of groups that some cell is in. Groups that are such a combination by
    themselves have their name for it, groups that share cells with others stay sets.
    """
    groups = {name: ids for name, ids in groups.items() if len(ids)}
    table = np.zeros((count, len(groups)), dtype=bool)
    for column, members in enumerate(masks(groups, count).values()):
        table[:, column] = members
    rows, which = np.unique(table, axis=0, return_inverse=True)
    which = which.reshape(-1)
    owned = {name: np.flatnonzero(rows[:, column]) for column, name in enumerate(groups)}
    numbers = _numbers(rows, {name: int(own[0]) for name, own in owned.items() if len(own) == 1})
    tags = numbers[which]
    names = {name: int(numbers[own[0]]) for name, own in owned.items() if len(own) == 1}
    return tags, names, {name: ids for name, ids in groups.items() if name not in names}


def _numbers(rows: Ints, named: Mapping[str, int]) -> Ints:
    """A tag per combination: that of its name where this is a number, else the least that is free; 0 for none."""
    numbers = np.zeros(len(rows), dtype=np.int64)
    for name, row in named.items():
        if name.isdecimal() and 0 < int(name) < 2**31 and int(name) not in numbers:
            numbers[row] = int(name)
    order = [*dict.fromkeys(named.values()), *range(len(rows))]
    for row in (row for row in order if rows[row].any()):
        if not numbers[row]:
            numbers[row] = min(set(range(1, len(rows) + 2)) - set(numbers.tolist()))
    return numbers


def tag_names(names: Mapping[str, tuple[int, int]], dimension: int) -> dict[int, str]:
    """The name of each tag of cells of that ``dimension`` that has one."""
    return {tag: name for name, (tag, of) in names.items() if of == dimension}


def names_of(
    tags: Ints, names: Mapping[str, tuple[int, int]], dimension: int, sets: Mapping[str, Ints]
) -> dict[str, Ints]:
    """Every group of cells by name: tags by their names of that ``dimension``, or by the number, and sets.

    A tag without a name is left out where it says no more than the sets do: it is that of a combination of them.
    """
    found = {name: np.flatnonzero(tags == tag) for name, (tag, of) in names.items() if of == dimension}
    found = {name: ids for name, ids in found.items() if len(ids)} | {
        name: np.unique(ids) for name, ids in sets.items()
    }
    table = np.column_stack([np.zeros(len(tags), dtype=bool), *masks(found, len(tags)).values()])
    _, which = np.unique(table, axis=0, return_inverse=True)
    which = which.reshape(-1)
    known = {tag for tag, of in names.values() if of == dimension}
    for tag in np.unique(tags[tags != 0]).tolist():
        members = tags == tag
        combination = which[members.argmax()]
        is_one = table[members.argmax()].any() and np.array_equal(members, which == combination)
        if tag not in known and not is_one:
            found.setdefault(str(tag), np.flatnonzero(members))
    return found
