"""The judges of fuzzing: a good mesh has no fault, and each judge fails where what it looks at is doctored."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.fuzzing import POINTS, TETS, TWO, command, read_as, six_tets

from benchmarks.fuzz import random_mesh
from benchmarks.fuzz.judge import exact, read_mesh, result, said
from benchmarks.fuzz.judge.result import Arrays
from wct_plugin.io import read
from wct_plugin.measure import quality


def test_a_good_mesh_has_no_fault() -> None:
    assert result.faults_of_mesh(TWO) == []
    assert result.faults_of_regions(TWO, TWO, volumes=True) == []
    assert result.faults_of_groups(TWO, TWO) == []
    assert result.faults_of_same(TWO, TWO, "twice") == []


@pytest.mark.parametrize(
    ("doctored", "fault"),
    [
        (replace(TWO, tets=TETS[:0], regions=TWO.regions[:0]), "no tets"),
        (replace(TWO, points=np.where(POINTS == 1, np.nan, POINTS)), "not finite"),
        (replace(TWO, tets=TETS + 1), "out of range"),
        (replace(TWO, tets=TETS[:, [1, 0, 2, 3]]), "tet 0 of the output is not positively oriented"),
        (replace(TWO, tets=np.array([TETS[0], [0, 1, 2, 4]])), "same side of a facet"),
        (
            replace(TWO, points=np.vstack([POINTS, POINTS[:4] * 0.1 + 0.05]), tets=np.array([TETS[0], [5, 6, 7, 8]])),
            "vertex 5 of the output lies within tet 0",
        ),
    ],
)
def test_what_is_no_mesh(doctored: Arrays, fault: str) -> None:
    (found,) = result.faults_of_mesh(doctored)
    assert fault in found


def test_a_volume_by_the_last_bit() -> None:
    """Three points and one off their plane by less than rounding: only fractions tell on which side it is."""
    flat = np.array([[0.1, 0.1, 0.1], [0.3, 0.1, 0.2], [0.1, 0.3, 0.7], [0.2, 0.2, 0.45]])
    volumes = []
    for step in range(-2, 3):
        points = flat.copy()
        points[3, 2] += step * 2.0**-54
        volume = exact.volume6(exact.as_fractions(points))
        volumes.append(volume)
        assert bool(exact.not_positive(points, TETS[:1])) == (volume <= 0)
    assert volumes == sorted(volumes)
    assert volumes[0] < 0 < volumes[-1]


@pytest.mark.parametrize(
    ("doctored", "fault"),
    [
        (replace(TWO, regions=np.array([1, 3])), "regions [1, 2] became [1, 3]"),
        (replace(TWO, regions=np.array([2, 1])), "the volume of region 1 changed by +100.00%"),
        (replace(TWO, points=POINTS * [1, 1, 1.006]), "the volume of region 1 changed by +0.60%"),
    ],
)
def test_what_became_of_regions(doctored: Arrays, fault: str) -> None:
    assert fault in result.faults_of_regions(TWO, doctored, volumes=True)
    assert len(result.faults_of_regions(TWO, doctored, volumes=False)) == ("became" in fault)


def test_what_became_of_groups() -> None:
    (lost,) = result.faults_of_groups(TWO, replace(TWO, facets=TWO.facets[:1], facet_tags=TWO.facet_tags[:1]))
    assert lost == "groups of facets [7, 8] became [7]"
    (smaller,) = result.faults_of_groups(TWO, replace(TWO, points=POINTS * [1, 1, 0.99]))
    assert smaller == "the area of group 8 changed by -1.00%"


def test_planes() -> None:
    box = replace(TWO, tets=TETS[:1])
    assert result.faults_of_planes(box, box) == ["1 boundary facets left their planes"]  # of none along the axes
    cube = random_mesh.Made("cube", *six_tets(), regions=np.ones(6, dtype=np.int64))
    given = Arrays(cube.points, cube.tets, cube.regions)
    assert result.faults_of_planes(given, given) == []
    bent = cube.points.copy()
    bent[0, 0] -= 1e-16
    assert result.faults_of_planes(given, replace(given, points=bent)) != []


def test_flags_in_fractions_are_those_in_floats() -> None:
    """Where no sign is near zero both ways of counting agree; and the near ones are for the fractions to tell."""
    random_ = np.random.default_rng(3)
    points = random_.normal(size=(400, 3))
    tets = np.arange(400).reshape(-1, 4)

    counted = exact.count_flags(points, tets)
    heights = quality.heights_over_radius(points, tets)
    assert counted["3wc"] == int((heights > 0).all(axis=1).sum()) > 0
    assert counted["2wc"] == int((quality.face_angles(points, tets) < 90).all(axis=1).sum()) > 0
    assert exact.count_flags(points, tets, Fraction(1, 2)) == {"3wc": 0, "2wc": 0, "cwc": 0}


def test_reports() -> None:
    flags = exact.count_flags(TWO.points, TWO.tets)
    report: dict[str, Any] = {name: {"count": count} for name, count in flags.items()}
    report |= {"tets": 2, "regions": {"1": 1, "2": 1}}
    assert result.faults_of_report(report, TWO) == []
    for wrong in ({"tets": 3}, {"regions": {"1": 2}}, {"2wc": {"count": flags["2wc"] + 1}}):
        assert len(result.faults_of_report(report | wrong, TWO)) == 1
    right = replace(TWO, points=np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 2, 2]]))
    assert exact.count_flags(right.points, right.tets[:1])["2wc"] == 0  # right angles are not acute


@pytest.mark.parametrize("name", ["points", "tets", "regions", "facets", "facet_tags"])
def test_the_same_bits(name: str) -> None:
    values = getattr(TWO, name).copy()
    values.flat[0] = np.nextafter(values.flat[0], 1) if name == "points" else values.flat[0] + 1
    assert result.faults_of_same(TWO, replace(TWO, **{name: values}), "twice") == [f"{name} differ twice"]


@pytest.mark.parametrize(
    ("message", "fault"),
    [
        ("a.vtu: two\nlines", "several lines"),
        ("b.vtu: is empty", "does not name the file"),
        ("a.vtu: cannot be read: malformed or truncated (IndexError: 3)", "malformed or truncated ("),
        ("a.vtu: internal error, please report it", "internal error"),
        ("a.vtu: ran out of memory", "ran out of memory"),
        ("a.vtu: " + 2000 * "x", "2007 characters"),
    ],
)
def test_messages(message: str, fault: str) -> None:
    assert said.faults_of_message("a.vtu: is empty", "a.vtu: ") == []
    (found,) = said.faults_of_message(message, "a.vtu: ")
    assert fault in found


def test_what_is_printed() -> None:
    assert said.faults_of_output("a table\nof lines\n") == []
    assert said.faults_of_output("Traceback (most recent call last)") != []
    assert said.faults_of_output("name \x1b[2J") != []


@pytest.mark.parametrize(
    ("doctored", "fault"),
    [
        ({"points": POINTS.astype("f4")}, "points are float32"),
        ({"points": np.where(POINTS == 1, np.inf, POINTS)}, "not finite"),
        ({"tets": TETS + 1}, "tets have an index out of 0..4"),
        ({"regions": np.array([1])}, "regions '' has 1 rows for 2"),
        ({"point_data": {"u": np.zeros(4)}}, "point data 'u' has 4 rows for 5"),
        ({"cell_data": {"v": np.zeros(4)}}, "tet data 'v' has 4 rows for 2"),
        ({"tet_sets": {"s": np.array([2])}}, "set of tets 's' has members out of 0..1"),
        ({"point_sets": {"s": np.array([-1])}}, "set of points 's' has members out of 0..4"),
        ({"tets": TETS[:1], "regions": np.array([1])}, "a point is in no tet"),
        ({"tets": TETS[[0, 1, 1]], "regions": np.array([1, 2, 2])}, "a tet is there twice"),
        ({"tets": TETS[:, [1, 0, 2, 3]]}, "tet 0 is not positively oriented"),
    ],
)
def test_what_is_read(doctored: dict[str, Any], fault: str) -> None:
    assert read_mesh.faults_of(read_as()) == []
    (found,) = read_mesh.faults_of(read_as(**doctored))
    assert fault in found


def test_pairs_of_ends() -> None:
    points, tets = six_tets()
    given = Arrays(points, tets, np.ones(len(tets), dtype=np.int64))
    assert result.faults_of_pairs(given, given) == []
    moved = points.copy()
    moved[moved[:, 0] == 1] += [0, 0, 1e-16]
    faults = result.faults_of_pairs(given, replace(given, points=moved))
    assert faults[0] == "the ends of axis 0 matched, and have 4 and 4 vertices that do not"


def test_written_meshes_are_read_as_they_are(tmp_path: Path) -> None:
    """What the judges read of a file by meshio is what we read of it: otherwise they would judge something else."""
    case = command(tmp_path)
    case.mesh.facets, case.mesh.facet_tags = TWO.facets, TWO.facet_tags
    for suffix in (".vtu", ".msh", ".mesh"):
        case.mesh.write(tmp_path / f"a{suffix}")
        found, ours = result.load(tmp_path / f"a{suffix}"), read(tmp_path / f"a{suffix}")
        assert result.faults_of_same(found, TWO, suffix) == []
        assert np.array_equal(ours.regions, TWO.regions)
