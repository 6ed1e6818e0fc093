"""Whether all that is said of a mesh is what fractions say: of each tet, of each triangle, of each pair of tets."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.fuzz.judge import exact


@dataclass(frozen=True)
class Told:
    """What is so, exactly."""

    flags: Mapping[str, list[bool]]  #: 3wc, 2wc and acute per tet
    centers: list[int]  #: per tet the sign of the least barycentric coordinate of its circumcenter
    triangles: list[int]  #: per triangle the sign of the cosine of its largest angle
    powers: list[int]  #: per pair of tets with a common facet the sign of the power of one's apex in the other's sphere


def told(points: NDArray[np.float64], tets: NDArray[np.int64]) -> Told:
    """All of it, for a mesh of positive tets."""
    x = exact.as_fractions(points)
    rows = tets.tolist()
    corners = [[x[v] for v in row] for row in rows]
    flags = {
        "3wc": [exact.is_well_centered(one) for one in corners],
        "2wc": [exact.has_acute_triangles(one) for one in corners],
        "acute": [_has_acute_dihedrals(one) for one in corners],
    }
    triangles = {tuple(sorted(three)) for row in rows for three in combinations(row, 3)}
    at: dict[tuple[int, ...], list[list[int]]] = {}
    for row in rows:
        for three in combinations(row, 3):
            at.setdefault(tuple(sorted(three)), []).append(row)
    powers = []
    for pair in at.values():
        if len(pair) == 2:
            (apex,) = set(pair[1]) - set(pair[0])
            powers.append(_sign(_power([x[v] for v in pair[0]], x[apex])))
    return Told(
        flags,
        [_sign(min(_shares(one))) for one in corners],
        [_sign(min(_cosines([x[v] for v in three]))) for three in triangles],
        powers,
    )


def _sign(value: Fraction) -> int:
    return int(value > 0) - int(value < 0)


def _shares(corners: Sequence[exact.Vector]) -> list[Fraction]:
    """Positive multiples of the circumcenter's barycentric coordinates, from lengths and angles at vertex 0."""
    a, b, c = (exact.minus(corner, corners[0]) for corner in corners[1:])
    squares = [exact.dot(side, side) for side in (a, b, c)]
    gram = [[exact.dot(p, q) for q in (a, b, c)] for p in (a, b, c)]
    shares = []
    for k in range(3):  # Cramer's rule for gram . share = squares / 2, without the positive determinant
        table = [[squares[i] if j == k else gram[i][j] for j in range(3)] for i in range(3)]
        shares.append(_determinant(table))
    return [2 * _determinant(gram) - sum(shares), *shares]


def _determinant(rows: Sequence[Sequence[Fraction]]) -> Fraction:
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def _cosines(corners: Sequence[exact.Vector]) -> list[Fraction]:
    sides = [exact.minus(corners[k - 1], corners[k]) for k in range(3)]  # each from corner k to the one before
    return [-exact.dot(sides[k], sides[(k + 1) % 3]) for k in range(3)]


def _has_acute_dihedrals(corners: Sequence[exact.Vector]) -> bool:
    """At each edge the parts of the two other vertices' sides that are upright on it have a positive product."""
    for p, q in combinations(range(4), 2):
        r, s = (k for k in range(4) if k not in (p, q))
        along = exact.minus(corners[q], corners[p])
        one, other = (exact.minus(corners[k], corners[p]) for k in (r, s))
        upright = exact.dot(one, other) * exact.dot(along, along) - exact.dot(one, along) * exact.dot(other, along)
        if upright <= 0:
            return False
    return True


def _power(corners: Sequence[exact.Vector], point: exact.Vector) -> Fraction:
    """A positive multiple of the power of a point in the sphere of a positive tet: the determinant for five points."""
    rows = []
    for corner in corners:
        side = exact.minus(corner, point)
        rows.append([*side, exact.dot(side, side)])
    total = Fraction(0)
    for k, row in enumerate(rows):  # by the column of squares
        minor = _determinant([other[:3] for other in rows[:k] + rows[k + 1 :]])
        total += (-1) ** (k + 1) * row[3] * minor
    return total


def faults_of_flags(what: str, found: Mapping[str, Any], true: Told) -> list[str]:
    """Whether each tet's flags are those that it has."""
    faults = []
    for name, values in true.flags.items():
        wrong = [tet for tet, (a, b) in enumerate(zip(found[name], values, strict=True)) if bool(a) != b]
        if wrong:
            faults.append(f"{what} {name} of tet {wrong[0]} is {bool(found[name][wrong[0]])}")
    return faults


def faults_of_counts(report: Mapping[str, Any], true: Told) -> list[str]:
    """Whether a report counts the tets that have each flag, and draws the tiers from them."""
    both = [a and b for a, b in zip(true.flags["3wc"], true.flags["2wc"], strict=True)]
    faults = []
    for name, values in (*true.flags.items(), ("cwc", both)):
        if report[name]["count"] != sum(values):
            faults.append(f"the report counts {report[name]['count']} tets that are {name}, and {sum(values)} are")
    valid = report["tiers"]["valid"]
    for tier, least in (("3WC", true.flags["3wc"]), ("CWC", both)):
        if report["tiers"][tier] != (valid and all(least)):
            faults.append(f"tier {tier} is {report['tiers'][tier]}")
    if valid and min(true.powers, default=0) >= 0 and not report["tiers"]["Delaunay"]:
        faults.append("the tier is not Delaunay, and the mesh is")
    if report["tiers"]["one-sided"] and min(true.powers, default=1) <= 0:
        faults.append("the tier is one-sided, and no dual edge is positive there")
    if report["bad_by_place"] and sum(row["not_cwc"] for row in report["bad_by_place"].values()) != both.count(False):
        faults.append("the tets by place are not those that are not completely well-centered")
    return faults


def faults_of_certificate(found: Mapping[str, Any], true: Told) -> list[str]:
    """Whether a certificate has the violations and ties that there are, and proves what is so."""
    faults = []
    for name, signs, least in (("3wc", true.centers, 1), ("2wc", true.triangles, 1), ("delaunay", true.powers, 0)):
        check = found["checks"][name]
        expected = {
            "elements": len(signs), "violations": sum(sign < least for sign in signs), "ties": signs.count(0),
        }  # fmt: skip
        for key, value in expected.items():
            if check[key] != value:
                faults.append(f"the certificate has {check[key]} {key} of {name}, and there are {value}")
        if found[name] != (found["valid"] and not expected["violations"]):
            faults.append(f"the certificate says {found[name]} of {name}")
    return faults
