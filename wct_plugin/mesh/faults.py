"""What makes tets no mesh: vertices twice in one, tets twice, no volume, facets of three, tets folded onto others.

Rows are counted from 0, in the order in which the tets are given.
"""

import re
from dataclasses import dataclass

import numpy as np

from wct_plugin.exact import predicates
from wct_plugin.mesh.topology import crowded_facets, folded_pairs
from wct_plugin.types import Floats, Ints

_CHUNK = 1 << 17  # tets looked at together, so that checks take little memory beside the mesh
#: Odd factors that make one number, modulo 2 ** 64, of a tet's ascending vertices; of the splitmix64 generator.
_MIX = np.array([0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB, 1], dtype=np.uint64)
#: As many are named of each fault.
_NAMED = 5


@dataclass(frozen=True)
class Faults:
    """Rows of tets by what is wrong with them; a tet is under the first thing alone."""

    not_finite: Ints  #: (k,) tets with a vertex whose coordinates are no numbers
    degenerate: Ints  #: (k,) tets with a vertex twice
    repeated: Ints  #: (k, 2) tets whose vertices are those of a tet before, and that tet
    flat: Ints  #: (k,) tets whose volume is exactly zero
    inverted: Ints  #: (k,) tets turned against most others and folded onto all of their neighbours
    crowded: Ints  #: (k, 6) facets of three or more of the other tets: three vertices, three tets

    def __bool__(self) -> bool:
        return any(len(rows) for rows in vars(self).values())

    def __str__(self) -> str:
        crowded = [f"({a}, {b}, {c}) of tets {i}, {j}, {k}" for a, b, c, i, j, k in self.crowded[:_NAMED].tolist()]
        twins = [f"{second} (as {first})" for second, first in self.repeated[:_NAMED].tolist()]
        found = {
            "tets with coordinates that are no numbers": (self.not_finite, _numbers(self.not_finite)),
            "tets with a vertex twice": (self.degenerate, _numbers(self.degenerate)),
            "repeated tets": (self.repeated, twins),
            "tets of zero volume": (self.flat, _numbers(self.flat)),
            "tets folded onto their neighbours": (self.inverted, _numbers(self.inverted)),
            "facets of three or more tets": (self.crowded, crowded),
        }
        return "; ".join(
            f"{counted(len(rows), what)}: {', '.join(named)}{', ...' if len(rows) > _NAMED else ''}"
            for what, (rows, named) in found.items()
            if len(rows)
        )


def counted(count: int, what: str) -> str:
    """So many of what is named in the plural: ``1 repeated tet``, ``2 tets of zero volume``."""
    return f"{count} {re.sub('(tet|point|facet|cell)s', lambda word: word[1], what, count=1) if count == 1 else what}"


def _numbers(rows: Ints) -> list[str]:
    return [str(row) for row in rows[:_NAMED].tolist()]


def find(points: Floats, tets: Ints) -> Faults:
    """Everything that is wrong with tets (m, 4) whose vertices are all among the points (n, 3)."""
    left = np.ones(len(tets), dtype=bool)
    finite = np.flatnonzero(np.isfinite(points).all(axis=1))
    not_finite = np.flatnonzero(~np.isin(tets, finite).all(axis=1))
    left[not_finite] = False
    degenerate = with_a_vertex_twice(tets)
    degenerate = degenerate[left[degenerate]]
    left[degenerate] = False
    twins = repeated(tets)
    twins = twins[left[twins[:, 0]]]
    left[twins[:, 0]] = False
    rows = np.flatnonzero(left)
    signs = predicates.orientation(points, tets[rows])
    flat = rows[signs == 0]
    rows, signs = rows[signs != 0], signs[signs != 0]
    inverted = rows[folded(tets[rows], signs)]
    rows = np.setdiff1d(rows, inverted)
    crowded = crowded_facets(tets[rows], len(points))
    crowded[:, 3:] = rows[crowded[:, 3:]]
    return Faults(not_finite, degenerate, twins, flat, inverted, crowded)


def with_a_vertex_twice(tets: Ints) -> Ints:
    """Rows (k,) of the tets (m, 4) whose vertices are less than four."""
    bad = [np.empty(0, dtype=np.int64)]
    for start in range(0, len(tets), _CHUNK):
        ordered = np.sort(tets[start : start + _CHUNK], axis=1)
        bad.append(start + np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1)))
    return np.concatenate(bad)


def repeated(tets: Ints) -> Ints:
    """(k, 2) the tets whose vertices are those of a tet before, and the first such tet; ascending."""
    keys = np.empty(len(tets), dtype=np.uint64)
    for start in range(0, len(tets), _CHUNK):
        keys[start : start + _CHUNK] = np.sort(tets[start : start + _CHUNK], axis=1).astype(np.uint64) @ _MIX
    ascending = np.sort(keys)
    alike = np.flatnonzero(np.isin(keys, ascending[1:][ascending[1:] == ascending[:-1]]))
    ordered = np.sort(tets[alike], axis=1)  # equal tets have equal keys, and few others have
    _, first, place = np.unique(ordered, axis=0, return_index=True, return_inverse=True)
    before = first[place.reshape(-1)]
    again = before != np.arange(len(alike))
    return np.column_stack([alike[again], alike[before[again]]])


def folded(tets: Ints, signs: Ints) -> Ints:
    """Rows (k,) of the tets that face the other way than most, and lie on the same side of all their facets' others.

    ``signs`` (m,) is the orientation of each, 1 or -1. Where tets are only listed the other way round nothing is
    folded; where as many face one way as the other nothing says which are wrong.
    """
    minority = -1 if (signs > 0).sum() > (signs < 0).sum() else 1
    suspects = signs == minority
    if not suspects.any() or 2 * suspects.sum() == len(signs):
        return np.empty(0, dtype=np.int64)
    turned = tets.copy()
    turned[signs < 0] = turned[signs < 0][:, [0, 1, 3, 2]]
    pairs, over = folded_pairs(turned)
    meets = np.bincount(pairs.ravel(), minlength=len(tets))
    folds = np.bincount(pairs[over].ravel(), minlength=len(tets))
    return np.flatnonzero(suspects & (meets > 0) & (folds == meets))
