"""Named sets that share no member and together have all: the materials of files that have sets and no tags."""

from collections.abc import Mapping

import numpy as np

from wct_plugin.types import Ints

#: Kinds of members looked at, over all tries, after which the search for a choice of sets gives up; real files need
#: one try per set.
_WORK = 4_000_000


def disjoint_cover(sets: Mapping[str, Ints], count: int) -> list[str]:
    """Names, in their order, of two or more sets that have each of ``count`` members once; none where there are none.

    Where several choices of sets do, it is one of many small sets: the larger ones, such as an assembly of parts, are
    then unions of those.
    """
    candidates = {name: members for name, members in sets.items() if 0 < len(members) < count}
    together = sum(map(len, candidates.values()))
    if together < count:
        return []
    if together == count:
        all_of_them = np.concatenate(list(candidates.values()))
        return list(candidates) if (np.bincount(all_of_them, minlength=count) == 1).all() else []
    kinds, number = _kinds_of_members(candidates, count)
    chosen = _exact_cover(kinds, number)
    return [name for name in candidates if name in chosen]


def _kinds_of_members(sets: Mapping[str, Ints], count: int) -> tuple[dict[str, frozenset[int]], int]:
    """Each set as kinds of members, which are in the same sets; and how many kinds there are."""
    signature = np.zeros(count, dtype=np.uint64)
    marks = np.random.default_rng(0).integers(1, 2**63, size=len(sets), dtype=np.uint64)
    for mark, members in zip(marks, sets.values(), strict=True):
        signature[np.unique(members)] += mark
    found, kind = np.unique(signature, return_inverse=True)
    return {name: frozenset(np.unique(kind[members]).tolist()) for name, members in sets.items()}, len(found)


def _exact_cover(sets: Mapping[str, frozenset[int]], count: int) -> frozenset[str]:
    """Names of sets that have each of the numbers below ``count`` once, the smallest sets first; empty if none do."""
    having: list[list[str]] = [[] for _ in range(count)]
    for name in sorted(sets, key=lambda name: len(sets[name])):
        for kind in sets[name]:
            having[kind].append(name)
    stack: list[tuple[frozenset[int], frozenset[str]]] = [(frozenset(), frozenset())]
    for _ in range(_WORK // max(count, 1)):
        if not stack:
            break
        covered, chosen = stack.pop()
        if len(covered) == count:
            return chosen
        kind = min((kind for kind in range(count) if kind not in covered), key=lambda kind: len(having[kind]))
        fitting = [name for name in having[kind] if not sets[name] & covered]
        stack += [(covered | sets[name], chosen | {name}) for name in reversed(fitting)]
    return frozenset()
