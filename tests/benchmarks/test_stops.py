"""Stops: some hold, and the judges of what is left see what does not."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.fuzz.judge.result import Arrays
from benchmarks.fuzz.random_mesh import Made
from benchmarks.stops import left
from benchmarks.stops.__main__ import _run
from benchmarks.stops.cases import CASES, KICKS, MARGIN, PASSES, cube


def _promise() -> left.Promise:
    points, tets = cube(2)
    return left.Promise(Arrays(points, tets, np.ones(len(tets), dtype=np.int64)), "3wc", 1e-3)


def regular() -> tuple[np.ndarray, np.ndarray]:
    points = np.array([[1, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1]], dtype=float)
    return points, np.arange(4)[None]


def test_some_stops_in_python_hold() -> None:
    found = _run("moving vertices", "Python", 2)
    assert found.faults == []
    assert found.stops["moving vertices"] >= 4
    assert set(found.codes) == {"False: 0", "an exception: 0"}


def test_every_case_names_what_it_must_be_stopped_in() -> None:
    assert all(case.stages for case in CASES)
    stages = {stage for case in CASES for stage in case.stages}
    assert stages >= {"resampling", "conforming", "moving vertices", PASSES, KICKS, MARGIN}


def test_a_mesh_that_breaks_a_promise_is_a_fault() -> None:
    promise = _promise()
    old = promise.old
    assert left.faults_of_mesh(old, promise) == []
    assert "not positively" in left.faults_of_mesh(replace(old, tets=old.tets[:, [1, 0, 2, 3]]), promise)[0]
    assert "regions" in left.faults_of_mesh(replace(old, regions=old.regions + 1), promise)[0]
    swollen = left.faults_of_mesh(replace(old, points=old.points * 1.02), promise)
    assert ["volume" in one or "boundary" in one for one in swollen] == [True, True]
    good = left.Promise(Arrays(*regular(), np.ones(1, dtype=np.int64)), "3wc", 0.1)
    flatter = good.old.points * [1, 1, 0.97]
    flatter[0, 2] -= 0.05
    assert left.faults_of_mesh(replace(good.old, points=flatter), good) == []
    right = Arrays(np.vstack([np.zeros(3), np.eye(3)]), good.old.tets, good.old.regions)
    assert any("0.0% of the tets are 3wc after 100.0%" in one for one in left.faults_of_mesh(right, good))


def test_distances_to_a_surface_are_those_of_plane_side_and_corner() -> None:
    triangle = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    for point, distance in (((0.2, 0.2, 0.5), 0.5), ((0.5, -2, 0), 2), ((4, 0, 4), 5), ((1, 1, 0), 0.5**0.5)):
        assert np.isclose(left._distances(np.array(point, dtype=float), triangle), distance)


def test_what_a_stopped_command_says_and_leaves_must_agree(tmp_path: Path) -> None:
    promise = _promise()
    nothing, some = "error: interrupted; nothing was written", "error: interrupted; written before: out.vtu"
    assert left.faults_of_command(2, nothing, tmp_path, set(), promise) == []
    assert left.faults_of_command(2, some, tmp_path, set(), promise) != []
    assert left.faults_of_command(0, "", tmp_path, set(), promise) == ["exit code 0, and no mesh is written"]
    assert left.faults_of_command(-15, "", tmp_path, set(), promise) != []
    Made("", promise.old.points, promise.old.tets, promise.old.regions).write(tmp_path / "out.vtu")
    assert left.faults_of_command(2, some, tmp_path, set(), promise) == []
    assert left.faults_of_command(1, "", tmp_path, set(), promise) == []
    assert left.faults_of_command(2, nothing, tmp_path, set(), promise) != []
    (tmp_path / ".out.vtu.wct-1").mkdir()
    assert ".out.vtu.wct-1 is left" in left.faults_of_command(1, "", tmp_path, set(), promise)
