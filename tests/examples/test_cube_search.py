"""The parts of ``examples/cube_search.py`` against closed forms, the measures of quality.py, and themselves resumed."""

import cube_search
import numpy as np
import pytest
from cube_search import Search, certified
from cubes.descent import Energy, descend, tetrahedralization
from cubes.known import sketches
from cubes.moves import changed, layered_arrangement, random_arrangement
from cubes.obstructions import obstructions
from cubes.polish import least_margin, margins, polish, polished
from cubes.symmetry import CORNERS, Arrangement, operations, subgroups

from wct_plugin.measure import quality


def same_set(a, b):
    gaps = np.linalg.norm(a[:, None] - b, axis=2)
    return len(a) == len(b) and gaps.min(0).max() < 1e-9 and gaps.min(1).max() < 1e-9


def sketched(goal):
    seats = sketches(goal)[0] - 0.5
    return Arrangement(0, seats)


@pytest.fixture(scope="module")
def thirty():
    return polished(descend(sketched("3wc"), "3wc", 60)[0].points(), "3wc")


def test_subgroups_of_the_cube_are_all_that_two_elements_make():
    found = subgroups()
    ops = operations()
    for group in found:
        members = ops[list(group)]
        products = np.einsum("aij,bjk->abik", members, members).reshape(-1, 9)
        assert len(np.unique(products, axis=0)) == len(group)
    # 33 classes, see the tables of point groups; two of mmm and the one of 4/mmm take three generators
    assert len(found) == 33 - 3


@pytest.mark.parametrize("group", range(0, 30, 3))
def test_an_arrangement_keeps_its_symmetry_and_its_planes(group):
    rng = np.random.default_rng(group)
    arrangement = random_arrangement(rng, group, 40)
    moved = arrangement.at(arrangement.parameters + 0.003 * rng.normal(size=len(arrangement.parameters)))
    points = moved.points()
    assert all(same_set(points @ operation.T, points) for operation in moved.elements)
    assert same_set(points[:8], CORNERS)
    np.testing.assert_array_equal(np.abs(points) == 0.5, np.abs(arrangement.points()) == 0.5)
    np.testing.assert_allclose(moved.released().points(), points, atol=1e-12)


def test_a_change_gives_an_arrangement_of_the_same_group():
    rng = np.random.default_rng(1)
    start = layered_arrangement(rng, 4, 3)
    others = [other for _ in range(60) if (other := changed(rng, start)) is not None]
    assert len(others) > 30
    assert len({len(other.points()) for other in others}) > 3
    for other in others:
        assert other.group == 4
        assert all(same_set(other.points() @ operation.T, other.points()) for operation in other.elements)


@pytest.mark.parametrize("goal", ["3wc", "cwc"])
def test_the_slope_is_that_of_the_energy(goal):
    arrangement = layered_arrangement(np.random.default_rng(2), 3, 4)
    energy, x = Energy(arrangement, goal), arrangement.parameters
    _, slope = energy(x)
    steps = 1e-7 * np.eye(len(x))
    differences = [(energy(x + step)[0] - energy(x - step)[0]) / 2e-7 for step in steps]
    np.testing.assert_allclose(slope, differences, rtol=1e-4, atol=1e-5)


def test_descent_descends_and_ends_flat():
    arrangement = sketched("3wc")
    before, _ = Energy(arrangement, "3wc")(arrangement.parameters)
    there, after = descend(arrangement, "3wc", 200)
    assert after < 0.2 * before
    assert np.abs(Energy(there, "3wc")(there.parameters)[1]).max() < 1e-2


def test_points_that_meet_cost_without_bound():
    twice = Arrangement(0, np.array([[0.1, 0.2, 0.3], [0.1, 0.2, 0.3]]))
    assert Energy(twice, "3wc")(twice.parameters)[0] == np.inf


def test_margins_are_the_measures_of_quality():
    points = np.random.default_rng(3).normal(size=(30, 3))
    tets, _ = tetrahedralization(points)
    values = margins(points[tets], "cwc")
    np.testing.assert_allclose(values[:, :4], quality.heights_over_radius(points, tets), rtol=1e-7, atol=1e-9)
    angles = quality.face_angles(points, tets).reshape(len(tets), 12)
    np.testing.assert_allclose(np.sort(values[:, 4:]), np.sort(np.cos(np.radians(angles))), atol=1e-9)


def test_the_polished_thirty_is_at_a_local_best(thirty):
    points, tets, least = thirty
    assert len(tets) == 30
    assert least == pytest.approx(0.017273140, abs=1e-8)  # as two other implementations found it
    rng = np.random.default_rng(4)
    inside = np.abs(points) != 0.5
    shaken = points + 0.002 * inside * rng.normal(size=points.shape)
    assert least_margin(shaken, tets, "3wc") < least
    again, back = polish(shaken, tets, "3wc")
    assert back == pytest.approx(least, abs=1e-8)
    np.testing.assert_array_equal(again[~inside], points[~inside])


def test_concentric_neighbours_are_counted():
    tets, concentric = tetrahedralization(CORNERS)
    assert concentric == (4 * len(tets) - 12) // 2  # every facet inside
    assert tetrahedralization(sketched("3wc").points())[1] == 0


def test_obstructions():
    tets, _ = tetrahedralization(CORNERS)
    # twelve triangles on the faces, and each of the 24 right angles wants two: 24 * 2 - 12 * 3 angles are missing
    assert obstructions(CORNERS, tets) == 12
    points, tets, least = polished(descend(sketched("cwc"), "cwc", 120)[0].points(), "cwc")
    assert len(tets) == 84
    assert least > 2e-4
    assert obstructions(points, tets) == 0


def test_only_what_is_well_centered_and_fills_the_cube_is_certified(thirty):
    points, tets, _ = thirty
    published = np.round(points + 0.5, 3)
    assert certified(published, tets, "3wc", 3)
    assert not certified(published, tets, "cwc", 3)
    assert not certified(published, tets[1:], "3wc", 3)
    assert not certified(np.round(published, 1), tets, "3wc", 1)
    dented = published.copy()
    dented[np.flatnonzero(published[:, 0] == 0)[-1], 0] = 0.001
    assert not certified(dented, tets, "3wc", 3)


@pytest.fixture
def brief(monkeypatch):
    monkeypatch.setattr(cube_search, "PATIENCE", 4)
    monkeypatch.setattr(cube_search, "STARTS", 2)


def arguments(path, chains, seed=7):
    return ["--fewer-than", "31", "--chains", str(chains), "--seed", str(seed), "--state", str(path)]


@pytest.mark.usefixtures("brief")
def test_a_search_in_parts_is_the_search_in_one(tmp_path):
    whole, parts = tmp_path / "whole.json", tmp_path / "parts.json"
    cube_search.main(arguments(whole, 3))
    for chains in (1, 2):
        cube_search.main(arguments(parts, chains))
    assert parts.read_text() == whole.read_text()
    findings = parts.with_suffix(".found.jsonl").read_text()
    assert findings == whole.with_suffix(".found.jsonl").read_text()
    assert findings.count("\n") >= 1


@pytest.mark.usefixtures("brief")
def test_a_state_of_another_search_is_refused(tmp_path):
    cube_search.main(arguments(tmp_path / "state.json", 0))
    with pytest.raises(SystemExit, match=r"is of a search for .*'seed': 7"):
        cube_search.main(arguments(tmp_path / "state.json", 0, seed=8))
    assert Search("3wc", 31, 1e-4, 7).aim != Search("cwc", 31, 1e-4, 7).aim
