"""The fuzzing itself: cases are what their numbers say, judges do fail, what dies is noticed, and a few cases hold."""

import json
import os
import random
import shutil
import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import meshio
import numpy as np
import pytest

from benchmarks.fuzz import changed_bytes, command_case, command_child, file_case, file_run, random_mesh, seed_files
from benchmarks.fuzz.command_case import Case, Ran
from benchmarks.fuzz.findings import Finding, Findings
from benchmarks.fuzz.judge import exact, read_mesh, result, said
from benchmarks.fuzz.judge.result import Arrays
from wct_plugin.cli import main
from wct_plugin.io import read
from wct_plugin.measure import quality

#: Two tets on one facet, in two regions.
POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
TETS = np.array([[0, 1, 2, 3], [1, 4, 2, 3]])
TWO = Arrays(POINTS, TETS, np.array([1, 2]), np.array([[0, 2, 1], [0, 1, 3]]), np.array([7, 8]))


@pytest.fixture(scope="module")
def seeds(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("seeds")
    seed_files.made(folder / "all")
    return folder / "all"


# --- judges ---------------------------------------------------------------------------------------------------------


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
    cube = random_mesh.Made("cube", *_cube(), regions=np.ones(6, dtype=np.int64))
    given = Arrays(cube.points, cube.tets, cube.regions)
    assert result.faults_of_planes(given, given) == []
    bent = cube.points.copy()
    bent[0, 0] -= 1e-16
    assert result.faults_of_planes(given, replace(given, points=bent)) != []


def _cube() -> tuple[Any, Any]:
    draw = SimpleNamespace(choice=lambda options: options[0], random=lambda: 0.5)
    return random_mesh._grid(draw, np.random.default_rng(0))  # type: ignore[arg-type]


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


def _mesh(**doctored: Any) -> Any:
    none: dict[str, Any] = {
        "vertices": np.empty((0, 1), np.int64),
        "tags": np.empty(0, np.int64),
        "data": {},
        "sets": {},
    }
    cells = {"facets": 3, "edges": 2, "nodes": 1}
    parts = {
        what: SimpleNamespace(**{**none, "vertices": np.empty((0, width), np.int64)}) for what, width in cells.items()
    }
    mesh = {"points": POINTS, "tets": TETS, "regions": np.array([1, 2]), "point_data": {}, "cell_data": {}, **parts}
    return SimpleNamespace(**{**mesh, "point_sets": {}, "tet_sets": {}, **doctored})


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
    assert read_mesh.faults_of(_mesh()) == []
    (found,) = read_mesh.faults_of(_mesh(**doctored))
    assert fault in found


# --- commands -------------------------------------------------------------------------------------------------------


def _command(folder: Path, goal: str = "delaunay") -> Case:
    mesh = random_mesh.Made("two", POINTS, TETS, np.array([1, 2]))
    mesh.write(folder / "in.vtu")
    arguments = ("optimize", "in.vtu", "out.vtu", "--json", "report.json", "--goal", "delaunay", "--quiet")
    return Case("optimize", arguments, ("in.vtu",), ("out.vtu", "report.json"), mesh, {"goal": goal})


def test_a_command_that_holds(tmp_path: Path) -> None:
    case = _command(tmp_path)
    ran = command_child.run(case, tmp_path)
    assert ran.code in (0, 1)
    assert command_case.judge(case, ran, tmp_path) == []


def _raises() -> None:
    raise ValueError("of no one's")


def _exits(code: int, text: str = "", write: str = "") -> Callable[[], None]:
    def run() -> None:
        if write:
            Path(write).write_text("half")
        sys.stdout.write(text)
        raise SystemExit(code)

    return run


@pytest.mark.parametrize(
    ("does", "fault"),
    [
        (lambda: os.kill(os.getpid(), 9), "died of signal 9"),
        (_raises, "Traceback"),
        (_exits(5), "the exit code is 5"),
        (_exits(2), "exit code 2 with 0 lines of errors"),
        (_exits(2, "error: a\nerror: b"), "exit code 2 with 2 lines of errors"),
        (_exits(2, "error: a", "out.vtu"), "exit code 2, and out.vtu is written"),
        (_exits(2, "error: a", ".out.vtu.wct-x"), ".out.vtu.wct-x is left"),
        (_exits(0), "there is no output"),
        (lambda: bytearray(8 << 30) and None, "Traceback"),
    ],
)
def test_commands_that_do_not_hold(
    does: Callable[[], Any], fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = _command(tmp_path)
    monkeypatch.setattr(main, "main", does)
    found = command_case.judge(case, command_child.run(case, tmp_path), tmp_path)
    assert any(fault in one for one in found), found


@pytest.mark.parametrize(
    ("doctor", "fault"),
    [
        (lambda mesh: mesh.cell_data["gmsh:physical"][0].fill(1), "regions [1, 2] became [1]"),
        (lambda mesh: mesh.points.__imul__([1, 1, 1.01]), "the volume of region 1 changed by +1.00%"),
        (lambda mesh: mesh.points.__setitem__(3, [1.0, 1, -1]), "not positively oriented"),
    ],
)
def test_outputs_that_are_doctored(doctor: Callable[[Any], None], fault: str, tmp_path: Path) -> None:
    case = _command(tmp_path)
    command_child.run(case, tmp_path)
    shutil.copy(tmp_path / "in.vtu", tmp_path / "out.vtu")
    mesh = meshio.read(tmp_path / "out.vtu")
    doctor(mesh)
    meshio.write(tmp_path / "out.vtu", mesh)
    found = command_case.judge(case, Ran(0, "", 1.0), tmp_path)
    assert any(fault in one for one in found), found


def test_too_much_time_and_fewer_tets(tmp_path: Path) -> None:
    case = _command(tmp_path, "3wc")
    command_child.run(case, tmp_path)
    assert "the command took more than 60 s of CPU time" in command_case.judge(case, Ran(1, "", 61.0), tmp_path)
    good = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])[[0, 2, 1, 3]]
    mesh = random_mesh.Made("one", good, np.array([[0, 1, 2, 3]]), np.array([1]))
    mesh.write(tmp_path / "in.vtu")
    mesh.points = POINTS[:4]
    mesh.write(tmp_path / "out.vtu")
    found = command_case.judge(replace(case, mesh=mesh), Ran(1, "volume", 1.0), tmp_path)
    assert any("fewer tets are 3wc: 0 of 1 after 1 of 1" in one for one in found), found
    found = command_case.judge(replace(case, mesh=mesh), Ran(0, "", 1.0), tmp_path)
    assert any("exit code 0, and 1 tets are not 3wc" in one for one in found), found


def test_another_result_on_one_core(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case = _command(tmp_path)
    ran = command_child.run(case, tmp_path)
    assert command_child._again(case, ran, tmp_path) == []

    def another() -> None:
        code = main.run(case.arguments)
        Path("out.vtu").write_bytes(Path("out.vtu").read_bytes().replace(b"<Points>", b"<Points >"))
        mesh = meshio.read("out.vtu")
        mesh.points[0, 0] += 1e-16
        meshio.write("out.vtu", mesh)
        raise SystemExit(code)

    monkeypatch.setattr(main, "main", another)
    assert command_child._again(case, ran, tmp_path) == ["points differ on one core"]
    monkeypatch.setattr(main, "main", _exits(2, "error: a"))
    assert command_child._again(case, ran, tmp_path) == [f"the exit code is {ran.code}, and 2 on one core"]


# --- cases ----------------------------------------------------------------------------------------------------------


def test_a_number_is_a_case(seeds: Path, tmp_path: Path) -> None:
    places = seed_files.made(seeds)
    for number in range(12):
        made = []
        for turn in "ab":
            folder = tmp_path / f"{number}{turn}"
            folder.mkdir()
            file_case.make(places, 5, number, folder)
            made.append({path.name: path.read_bytes() for path in folder.iterdir() if path.suffix != ".h5"})
            folder = tmp_path / f"{number}{turn}c"
            folder.mkdir()
            case = command_case.make(5, number, folder)
            made[-1] |= {path.name: path.read_bytes() for path in folder.iterdir()}
            made[-1]["arguments"] = repr(case.arguments).encode()
        assert made[0] == made[1]


def test_every_seed_file_is_read_or_refused_for_a_reason(seeds: Path) -> None:
    whole = [place for place in seed_files.made(seeds) if not place.name.startswith("data-")]
    assert len(whole) > 90
    for place in whole:
        outcome = file_case.read_and_judge(seed_files.main_file(place))
        assert outcome.what == "read", (place.name, outcome.said)
        assert outcome.faults == ()


def test_changes_change() -> None:
    data = b"1 2 3\n4 5 6\n" * 9
    made = {changed_bytes.changed(random.Random(number), data, b"") for number in range(300)}
    assert len(made) > 250


def test_readers_that_do_not_hold(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import wct_plugin as wct

    def slow(_: Any) -> None:
        while True:
            pass

    def warns(path: Path) -> Any:
        np.float16(1) * np.float16(60000) * np.float16(2)
        return _mesh()

    path = tmp_path / "a.vtu"
    for reads, fault in (
        (_raise(KeyError("a")), "KeyError is raised"),
        (_raise(wct.InputError("of two\nlines")), "the message has several lines"),
        (slow, "reading took more than"),
        (warns, "RuntimeWarning is left"),
        (lambda _: bytearray(1 << 30) and _mesh(), "reading took"),
        (lambda _: _mesh(tets=TETS + 1), "tets have an index out of"),
    ):
        monkeypatch.setattr(wct, "read", reads)
        monkeypatch.setattr(file_case, "SECONDS", 0.2)
        assert any(fault in one for one in file_case.read_and_judge(path).faults), fault


def _raise(error: Exception) -> Callable[[Any], Any]:
    def raises(_: Any) -> Any:
        raise error

    return raises


def test_a_child_that_dies_is_a_finding(seeds: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    dies = tmp_path / "python"
    dies.write_text(
        '#!/bin/sh\nfor last; do :; done\nif [ "$last" = 3 ]; then echo 0; echo 1; kill -11 $$; fi\necho 2\n'
    )
    dies.chmod(0o755)
    monkeypatch.setattr(file_run.sys, "executable", str(dies))
    findings = Findings(tmp_path / "findings")
    assert file_run._child(seeds, seed_files.made(seeds), 0, 0, 3, findings) == 2
    told = json.loads((tmp_path / "findings/file-0-1/finding.json").read_text())
    assert told["faults"] == ["the process died of SIGSEGV"]
    assert told["again"] == "python -m benchmarks.fuzz --case file:0:1"
    assert any((tmp_path / "findings/file-0-1/files").iterdir())


def test_findings_of_one_kind_are_one_line(tmp_path: Path) -> None:
    findings = Findings(tmp_path)
    for number in range(5):
        findings.add(Finding("file", 0, number, "main.vtu", (f"tet {number} is bad",), "said"), None)
    assert findings.lines()[-1].split() == ["5", "file:0:0", "main.vtu:", "tet", "0", "is", "bad", "said"]
    assert len(list(tmp_path.iterdir())) == 2


def test_some_files(seeds: Path, tmp_path: Path) -> None:
    findings = Findings(tmp_path)
    file_run.run(seeds, 0, 0, 1500, findings)
    assert sum(findings.counts.values()) == 1500
    assert not findings.found, findings.lines()


def test_some_commands(tmp_path: Path) -> None:
    for number in (0, 3, 8):
        (tmp_path / str(number)).mkdir()
        case, _, faults = command_child.whole(0, number, tmp_path / str(number))
        assert faults == [], case.arguments


def test_written_meshes_are_read_as_they_are(tmp_path: Path) -> None:
    """What the judges read of a file by meshio is what we read of it: otherwise they would judge something else."""
    case = _command(tmp_path)
    case.mesh.facets, case.mesh.facet_tags = TWO.facets, TWO.facet_tags
    for suffix in (".vtu", ".msh", ".mesh"):
        case.mesh.write(tmp_path / f"a{suffix}")
        found, ours = result.load(tmp_path / f"a{suffix}"), read(tmp_path / f"a{suffix}")
        assert result.faults_of_same(found, TWO, suffix) == []
        assert np.array_equal(ours.regions, TWO.regions)


def test_pairs_of_ends() -> None:
    points, tets = _cube()
    given = Arrays(points, tets, np.ones(len(tets), dtype=np.int64))
    assert result.faults_of_pairs(given, given) == []
    moved = points.copy()
    moved[moved[:, 0] == 1] += [0, 0, 1e-16]
    faults = result.faults_of_pairs(given, replace(given, points=moved))
    assert faults[0] == "the ends of axis 0 matched, and have 4 and 4 vertices that do not"


def test_another_mesh_when_read_and_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import wct_plugin as wct

    case = _command(tmp_path)
    command_child.run(case, tmp_path)
    assert command_child._round_trip(case, tmp_path) == []
    monkeypatch.setattr(wct, "read", lambda path: replace(read(path), regions=None))
    assert command_child._round_trip(case, tmp_path) == ["regions differ when it is read and written"]


@pytest.mark.parametrize("library", ["meshio", "pyvista", "arrays"])
def test_other_libraries_meshes(library: str, tmp_path: Path) -> None:
    case = _command(tmp_path)
    case = replace(case, name="object", arguments=(library, "apply_coord_well_centering", "{}"), outputs=("out.vtu",))
    ran = command_child.run(case, tmp_path)
    assert ran.code == 0, ran.text
    assert command_case.judge(case, ran, tmp_path) == []
    case = replace(case, arguments=(library, "apply_coord_well_centering", '{"margin": -1}'))
    (tmp_path / "out.vtu").unlink()
    ran = command_child.run(case, tmp_path)
    assert (ran.code, command_case.judge(case, ran, tmp_path)) == (2, [])
