"""Why no weights give some tets their orthocenters: conditions that contradict each other, proven exactly.

That a tet has its orthocenter on the inner side of a facet is linear in the weights w of its vertices: c + a . w > 0,
with c and a from the points alone. If multipliers y >= 0, not all zero, give sum y a = 0 and sum y c <= 0, then no w
whatsoever meets all conditions with y > 0, as the sum of y (c + a . w) would have to be positive (Farkas, *Theorie der
einfachen Ungleichungen*, 1902). So at least one of their tets goes without its orthocenter, in any choice of weights.

Which conditions they are a small linear programme around one tet says. It gives a vertex of the polyhedron of all
multipliers, which makes the conditions an irreducible infeasible subsystem: all but any one can be met (Gleeson and
Ryan, *Identifying minimally infeasible subsystems of inequalities*, 1990), and their multipliers are determined but
for a factor. These are then solved for in integers, with nothing taken from the programme but which conditions.
"""

from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csr_array, vstack

from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import exact_values
from wct_plugin.measure import orthocenters
from wct_plugin.types import Floats, Ints
from wct_plugin.weights.rows import by_weights

#: How many vertices away from a tet's own the others are looked for.
_RINGS = 2
#: Sums of multipliers times heights, over local length, below which the programme's conditions are worth proving.
_NEARLY = 1e-9
#: A multiplier of the programme, out of a sum of 1, that is not rounding.
_PRESENT = 1e-12
#: Conditions of a proof; the time of the proof grows steeply with their number.
_MOST = 50


@dataclass(frozen=True)
class Contradiction:
    """Conditions that no weights meet together, one at least of whose tets must go without its orthocenter."""

    tets: tuple[int, ...]  #: of each condition
    facets: tuple[int, ...]  #: of each condition: which facet of the tet it is, by the corner opposite
    #: of each condition, rounded, the largest 1; for the orthocenter's barycentric coordinate times its tet's volume^2
    multipliers: tuple[float, ...]

    @property
    def names(self) -> list[int]:
        """The tets, ascending, each once."""
        return sorted(set(self.tets))

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers and lists."""
        return {key: list(value) for key, value in vars(self).items()}


def contradiction(
    points: Floats, tets: Ints, heights: Floats, tet: int, kept: NDArray[np.bool_]
) -> Contradiction | None:
    """Proof that ``tet`` cannot have its orthocenter along with the tets near that are ``kept`` (m,), if there is one.

    ``heights`` (m, 4): of the orthocenters over the facets, for any weights.
    """
    near = np.zeros(len(points), dtype=bool)
    near[tets[tet]] = True
    for _ in range(_RINGS):
        near[tets[near[tets].any(axis=1)]] = True
        inside = kept & near[tets].all(axis=1)
        inside[tet] = True
        conditions = _contradicting(points, tets, heights, np.flatnonzero(inside))
        if len(conditions):
            return _proven(points, tets, conditions)
    return None


def separate(found: list[Contradiction]) -> int:
    """How many of the contradictions have no tet in common, the short ones first: so many tets at least are missed."""
    used: set[int] = set()
    count = 0
    for one in sorted(found, key=lambda one: len(one.names)):
        if used.isdisjoint(one.tets):
            used.update(one.tets)
            count += 1
    return count


def _contradicting(points: Floats, tets: Ints, heights: Floats, cells: Ints) -> Ints:
    """The conditions, 4 tet + facet, of the tets ``cells`` that exclude each other by rounded arithmetic; or none."""
    own = tets[cells]
    edges = points[own[:, 1:]] - points[own[:, :1]]
    length = np.sqrt((edges**2).sum(axis=(1, 2)) / 3)
    slopes = orthocenters.slopes(points, own) * (np.median(length) ** 2 / length)[:, None, None]
    vertices, columns = np.unique(own, return_inverse=True)
    matrix = by_weights(slopes, columns.reshape(-1, 4), len(vertices))
    values = heights[cells].ravel()
    # min y . values: the multipliers, with sum 1, whose conditions are violated most.
    system = vstack([matrix.T, csr_array(np.ones((1, len(values))))])
    found = linprog(values, A_eq=system, b_eq=np.append(np.zeros(len(vertices)), 1.0), method="highs-ds")
    if found.x is None or found.fun > _NEARLY:
        return np.zeros(0, dtype=np.int64)
    support = np.flatnonzero(found.x > _PRESENT)
    return cells[support // 4] * 4 + support % 4


def _proven(points: Floats, tets: Ints, conditions: Ints) -> Contradiction | None:
    if len(conditions) > _MOST:
        return None
    rows, constants, scales = zip(*(_condition(points, tets, *divmod(int(one), 4)) for one in conditions), strict=True)
    vertices = sorted(set().union(*rows))
    multipliers = _null_vector([[row.get(vertex, 0) for row in rows] for vertex in vertices])
    if multipliers is None or min(multipliers) < 0 or sum(map(int.__mul__, multipliers, constants)) > 0:
        return None
    multipliers = list(map(int.__mul__, multipliers, scales))
    largest = max(multipliers)
    return Contradiction(
        tuple((conditions // 4).tolist()),
        tuple((conditions % 4).tolist()),
        tuple(float(Fraction(one, largest)) for one in multipliers),
    )


def _condition(points: Floats, tets: Ints, tet: int, facet: int) -> tuple[dict[int, int], int, int]:
    """Integers a by vertex, and c, with c + a . w positive where the orthocenter is on the inner side of the facet.

    That is the orthocenter's barycentric coordinate times 72 volume^2 times the third value.
    """
    corners = points[tets[tet]]
    constant = exact_values(predicates.circumcenter, corners)[facet]
    pulls = exact_values(predicates.pulls, corners)[4 * facet : 4 * facet + 4]
    scale = lcm(constant.denominator, *(pull.denominator for pull in pulls))
    return (
        {v: int(-pull * scale) for v, pull in zip(tets[tet].tolist(), pulls, strict=True)},
        int(constant * scale),
        scale,
    )


def _null_vector(table: list[list[int]]) -> list[int] | None:
    """The y with table @ y = 0 and a positive last entry, if it is the only one but for a factor; else None.

    By elimination in integers, without the common factor of each row.
    """
    size = len(table[0]) - 1
    for k in range(size):
        at = [i for i in range(k, len(table)) if table[i][k]]
        if not at:
            return None
        pivot = min(at, key=lambda i: sum(map(bool, table[i])))  # the sparsest: it fills the others least
        table[k], table[pivot] = table[pivot], table[k]
        head = table[k]
        for i, row in enumerate(table):
            if i != k and row[k]:
                common = gcd(head[k], row[k])
                one, other = head[k] // common, row[k] // common
                mixed = [one * x - other * y for x, y in zip(row, head, strict=True)]
                common = gcd(*mixed) or 1
                table[i] = [x // common for x in mixed]
    if any(row[size] for row in table[size:]):
        return None
    last = lcm(*(row[k] for k, row in enumerate(table[:size])))
    return [-row[size] * (last // row[k]) for k, row in enumerate(table[:size])] + [last]
