"""What is proven about a mesh: every check is exact on the floating-point coordinates as they are stored.

======================  ==============================================================================================
orientation             every tet has positive volume
conformity              tets do not overlap and meet face to face, see :mod:`wct_plugin.certify.overlaps` for the proof
Delaunay                no vertex inside the circumsphere of the tet across a facet; cospherical points are allowed
3WC                     every tet has its circumcenter strictly inside
2WC                     every triangle has its circumcenter strictly inside: three acute angles
======================  ==============================================================================================

Nothing is assumed but that :class:`~wct_plugin.mesh.TetMesh` holds what the file says. Signs come from
:mod:`wct_plugin.exact.polynomial_signs`: a floating-point filter with a proven bound, and integers for what it leaves
open, so that a right angle is told from an angle one unit in the last place below it. Coordinates that are changed on
the way into a file, by fewer digits or single precision, make another mesh: certify what is read back.

Delaunay is checked facet by facet. Where the tets fill a convex domain, that makes the mesh the Delaunay
tetrahedralization of its vertices; elsewhere it is what is called locally Delaunay. 3WC implies it: of the
circumcenters of two neighbours each lies beyond the other as seen across the facet.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any

import numpy as np

from wct_plugin.certify.overlaps import overlaps
from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import Polynomial, exact_signs, exact_values
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import FACETS
from wct_plugin.types import Floats, Ints

#: The checks in order, and what they run over.
CHECKS = {"orientation": "tets", "conformity": "facets", "delaunay": "interior facets", "3wc": "tets", "2wc": "facets"}
#: How many violations of each check are named.
_NAMED = 5
#: Exact fractions longer than this are given to six digits instead.
_LONGEST = 40
#: Cells that are gathered at a time.
_BLOCK = 1 << 20


@dataclass(frozen=True)
class Violation:
    """One element that fails a check."""

    tets: tuple[int, ...]  #: the tets concerned
    vertices: tuple[int, ...]  #: the element's own vertices
    what: str  #: what is measured, or what is wrong
    value: str  #: the exact value as a fraction, or rounded to six digits if that is long; empty if it has none

    def __str__(self) -> str:
        tets = ("tet " if len(self.tets) == 1 else "tets ") + " and ".join(map(str, self.tets))
        return f"{tets}, vertices {' '.join(map(str, self.vertices))}: {self.what} {self.value}".rstrip()


@dataclass(frozen=True)
class Check:
    """How one check went."""

    elements: int  #: how many were checked
    violations: int  #: how many failed
    ties: int  #: how many had a value of exactly zero; those fail 3WC and 2WC and pass Delaunay
    exactly: int  #: values that took integers; the filter decided all others
    first: tuple[Violation, ...]  #: the first that failed

    @property
    def passed(self) -> bool:
        """Whether none failed."""
        return not self.violations


@dataclass(frozen=True)
class Certificate:
    """What is proven about a mesh, and what is not, see :func:`certify`."""

    checks: Mapping[str, Check]  #: by the names of :data:`CHECKS`

    @property
    def valid(self) -> bool:
        """All tets positive, without overlap, face to face."""
        return self.checks["orientation"].passed and self.checks["conformity"].passed

    def meets(self, goal: str) -> bool:
        """Whether a valid mesh is, without doubt, ``delaunay``, ``3wc``, ``2wc`` or ``cwc`` in every element."""
        return self.valid and all(self.checks[name].passed for name in (("3wc", "2wc") if goal == "cwc" else (goal,)))

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, strings, lists and dicts."""
        return {
            "valid": self.valid,
            **{goal: self.meets(goal) for goal in ("delaunay", "3wc", "2wc", "cwc")},
            "checks": {
                name: {
                    **{key: value for key, value in vars(check).items() if key != "first"},
                    "first": [
                        {**vars(one), "tets": list(one.tets), "vertices": list(one.vertices)} for one in check.first
                    ],
                }
                for name, check in self.checks.items()
            },
        }

    def headline(self) -> str:
        """One line: what is proven."""
        if not self.valid:
            return "not a valid mesh"
        proven = [label for goal, label in _LABELS.items() if self.meets(goal)]
        return "proven: " + ", ".join(["valid", *proven])

    def rows(self) -> list[tuple[str, ...]]:
        """Check, elements, violations, ties, how many took integers; the columns of :data:`HEAD`."""
        return [
            (
                _LABELS.get(name, name),
                f"{check.elements} {CHECKS[name]}",
                str(check.violations),
                str(check.ties) if name != "conformity" else "-",
                str(check.exactly),
            )
            for name, check in self.checks.items()
        ]

    def lines(self) -> list[str]:
        """The first violations of each check, one line each."""
        return [f"{_LABELS.get(name, name)}: {one}" for name, check in self.checks.items() for one in check.first]


HEAD = ("", "checked", "violations", "exactly zero", "decided by integers")
_LABELS = {"delaunay": "Delaunay", "3wc": "3WC", "2wc": "2WC", "cwc": "CWC"}


def certify(mesh: TetMesh) -> Certificate:
    """Check every tet, facet and boundary facet of a mesh exactly.

    Raises :class:`wct_plugin.errors.InputError` where three or more tets share a facet.
    """
    tets, pairs = mesh.tets, mesh.topology.interior_pairs
    half_facets = np.concatenate([pairs[:, :2], mesh.topology.boundary_half_facets])

    def tet(rows: slice) -> Ints:
        return tets[rows]

    def facet(rows: slice) -> Ints:
        cells: Ints = tets[half_facets[rows, :1], FACETS[half_facets[rows, 1]]]
        return cells

    def tet_and_vertex_across(rows: slice) -> Ints:
        return np.column_stack([tets[pairs[rows, 0]], tets[pairs[rows, 2], pairs[rows, 3]]])

    own = np.arange(len(tets))[:, None]
    return Certificate(
        {
            "orientation": _check(mesh, predicates.volume, tet, own, _volume),
            "conformity": _conformity(mesh),
            "delaunay": _check(
                mesh, predicates.circumsphere, tet_and_vertex_across, pairs[:, [0, 2]], _power, ties_pass=True
            ),
            "3wc": _check(mesh, predicates.circumcenter, tet, own, _barycentric),
            "2wc": _check(mesh, predicates.corners, facet, half_facets[:, :1], _product),
        }
    )


def _check(
    mesh: TetMesh,
    polynomial: Polynomial,
    cells: Callable[[slice], Ints],
    tets: Ints,
    measure: Callable[[Floats], tuple[str, Fraction]],
    ties_pass: bool = False,
) -> Check:
    """All values of ``polynomial`` are positive for the cells of each row of ``tets`` (k, t), which contain them.

    ``measure`` says what a violation is.
    """
    violations, ties, exactly = 0, 0, 0
    first: list[Violation] = []
    for start in range(0, len(tets), _BLOCK):
        block = cells(slice(start, start + _BLOCK))
        found = exact_signs(polynomial, mesh.points, block)
        worst = found.values.min(axis=1)
        bad = np.flatnonzero(worst < (0 if ties_pass else 1))
        for row in bad[: _NAMED - len(first)]:
            what, value = measure(mesh.points[block[row]])
            first.append(Violation(_numbers(tets[start + row]), _numbers(block[row]), what, _text(value)))
        violations += len(bad)
        ties += int((worst == 0).sum())
        exactly += found.exactly
    return Check(len(tets), violations, ties, exactly, tuple(first))


def _conformity(mesh: TetMesh) -> Check:
    found = overlaps(mesh)
    faults = {
        "lie on the same side of their common facet": found.one_sided,
        "have boundary facets that cross, touch or coincide": found.crossing,
        "overlap": found.covered,
    }
    bad = [(pair, what) for what, pairs in faults.items() for pair in pairs]
    first = tuple(
        Violation(_numbers(pair), _numbers(np.unique(mesh.tets[pair])), what, "") for pair, what in bad[:_NAMED]
    )
    facets = len(mesh.topology.interior_pairs) + len(mesh.topology.boundary)
    return Check(facets, len(bad), 0, found.exactly, first)


def _numbers(indices: Ints) -> tuple[int, ...]:
    return tuple(int(index) for index in indices)


def _text(value: Fraction) -> str:
    """The fraction itself, or where that is long its nearest six digits; never rounded to zero."""
    exact = str(value)
    if len(exact) <= _LONGEST:
        return exact
    with localcontext(prec=6, Emin=-999999, Emax=999999):
        return f"{Decimal(value.numerator) / Decimal(value.denominator):.6g}"


def _volume(corners: Floats) -> tuple[str, Fraction]:
    return "its volume is", exact_values(predicates.volume, corners)[0] / 6


def _power(corners: Floats) -> tuple[str, Fraction]:
    scaled = exact_values(predicates.circumsphere, corners)[0]
    return "the last one's power in the others' sphere is", scaled / exact_values(predicates.volume, corners[:4])[0]


def _barycentric(corners: Floats) -> tuple[str, Fraction]:
    scaled = exact_values(predicates.circumcenter, corners)
    return "the circumcenter's smallest barycentric coordinate is", min(scaled) / sum(scaled)


def _product(corners: Floats) -> tuple[str, Fraction]:
    return "the smallest dot product of two edges is", min(exact_values(predicates.corners, corners))
