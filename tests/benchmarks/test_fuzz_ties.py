"""Near ties: all that is said of a mesh is what fractions say, and the judges see a single flag that is not."""

import copy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmarks.fuzz import tie_case
from benchmarks.fuzz.judge import ties
from wct_plugin.measure import shape_polynomials
from wct_plugin.mesh import TetMesh
from wct_plugin.reports.report import make_report

COUNT = 120


def test_what_is_said_of_near_ties_is_so() -> None:
    for number in range(COUNT):
        assert tie_case.judged(*tie_case.make(3, number)) == [], f"python -m benchmarks.fuzz --case tie:3:{number}"


def test_cases_are_ties_and_lie_to_either_side_of_them() -> None:
    """Among them are meshes whose flags floating point cannot tell: within its bound of zero, and exactly at it."""
    signs: dict[str, set[int]] = {"centers": set(), "triangles": set(), "powers": set()}
    within = 0
    for number in range(COUNT):
        points, tets = tie_case.make(3, number)
        assert all(np.array_equal(a, b) for a, b in zip((points, tets), tie_case.make(3, number), strict=True))
        true = ties.told(points, tets)
        for name, seen in signs.items():
            seen |= set(getattr(true, name))
        shapes = next(shape_polynomials.in_chunks(points, tets)[1])[1]
        open_ = [np.abs(p) <= bound for p, bound in zip(shapes.heights(), shapes.height_bounds(), strict=True)]
        within += int(np.any(open_, axis=0).sum())
    assert all(seen == {-1, 0, 1} for seen in signs.values())
    assert within > COUNT


@pytest.fixture(scope="module")
def case() -> tuple[dict[str, Any], ties.Told]:
    """The report of a mesh with some tets of each flag, and what is so."""
    for number in range(1000):
        points, tets = tie_case.make(4, number)
        true = ties.told(points, tets)
        mixed = all(0 < sum(values) < len(tets) for values in true.flags.values())
        if mixed and min(true.powers) >= 0 and tie_case.is_ordinary(points):
            report = make_report(TetMesh(points, tets), exact=True).to_dict()
            if report["tiers"]["valid"]:
                return report, true
    raise AssertionError("no such case")


def test_judges_of_flags_see_one_that_is_not_so(case: tuple[dict[str, Any], ties.Told]) -> None:
    _, true = case
    assert ties.faults_of_flags("flag", true.flags, true) == []
    for name, values in true.flags.items():
        for tet in range(len(values)):
            doctored = {**true.flags, name: [flag != (k == tet) for k, flag in enumerate(values)]}
            (fault,) = ties.faults_of_flags("flag", doctored, true)
            assert fault == f"flag {name} of tet {tet} is {not values[tet]}"


def test_judges_of_reports_see_a_number_that_is_not_so(case: tuple[dict[str, Any], ties.Told]) -> None:
    report, true = case
    assert ties.faults_of_counts(report, true) == ties.faults_of_certificate(report["certificate"], true) == []
    for name in ("3wc", "2wc", "cwc", "acute"):
        doctored = copy.deepcopy(report)
        doctored[name]["count"] += 1
        assert len(ties.faults_of_counts(doctored, true)) == 1
    for tier in ("3WC", "CWC", "Delaunay"):
        doctored = copy.deepcopy(report)
        doctored["tiers"][tier] = not doctored["tiers"][tier]
        assert len(ties.faults_of_counts(doctored, true)) == 1
    for name in ("3wc", "2wc", "delaunay"):
        for key in ("elements", "violations", "ties"):
            doctored = copy.deepcopy(report["certificate"])
            doctored["checks"][name][key] += 1
            assert len(ties.faults_of_certificate(doctored, true)) == 1
        doctored = {**report["certificate"], name: not report["certificate"][name]}
        assert len(ties.faults_of_certificate(doctored, true)) == 1
    one_sided = {**report, "tiers": {**report["tiers"], "one-sided": True}}
    tied = replace(true, powers=[0, *true.powers])
    assert "one-sided" in ties.faults_of_counts(one_sided, tied)[0]


def test_fractions_against_plain_cases() -> None:
    """A corner of a cube, a regular tet, and pairs of tets: a vertex within, on and outside the other's sphere."""
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    found = ties.told(corner, np.arange(4)[None])
    assert (found.centers, sorted(found.triangles), found.powers) == ([-1], [0, 0, 0, 1], [])
    assert found.flags == {"3wc": [False], "2wc": [False], "acute": [False]}
    regular = np.array([[1, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1]], dtype=float)
    found = ties.told(regular, np.arange(4)[None])
    assert (found.centers, found.triangles) == ([1], [1] * 4)
    assert found.flags == {"3wc": [True], "2wc": [True], "acute": [True]}
    for across, sign in ((0.9, -1), (1.0, 0), (1.1, 1)):
        points = np.vstack([corner, [across, across, across]])
        assert ties.told(points, np.array([[0, 1, 2, 3], [4, 1, 3, 2]])).powers == [sign]
