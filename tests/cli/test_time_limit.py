"""``--time-limit``: the best so far is written, with exit code 1 and a last line that says why."""

import json

import numpy as np
import pytest
from support.builders import ball, bcc, jittered_cube
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main

SAID = "the time limit of 0.5 s ended the run; what is written is the best so far"
LARGE = ["--edge-length", "0.08"]  # of a ball of radius 1: some 120 thousand tets


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wct.write("ball.vtu", ball(4))
    wct.write("cube.vtu", jittered_cube(4))
    return tmp_path


def volume(mesh):
    a, b, c, d = np.moveaxis(mesh.points[mesh.tets], 1, 0)
    six = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)
    assert (six > 0).all()
    return six.sum() / 6.0


def test_optimize_stops_in_the_middle_of_a_large_run(place, capsys):
    assert main.run(["optimize", "ball.vtu", "out.vtu", "--time-limit", "0.5", *LARGE]) == 1
    assert capsys.readouterr().out.splitlines()[-1] == SAID
    assert volume(wct.read("out.vtu")) == pytest.approx(volume(ball(4)), rel=0.02)


def test_run_stops_and_says_so_beside_metadata_on_stdout(place, capsys):
    stage = {"type": "filters.meshing_well_centered", "edge_length": 0.08}
    (place / "chain.json").write_text(json.dumps([stage]))
    assert main.run(["run", "chain.json", "ball.vtu", "out.vtu", "--time-limit", "0.5", "--metadata", "-"]) == 1
    said = capsys.readouterr()
    assert json.loads(said.out)["stages"][1]["metrics"]["stopped"]
    assert said.err.splitlines()[-1] == SAID
    wct.read("out.vtu")


def test_a_run_that_ends_in_time_is_as_without_a_limit(place, capsys):
    for out, limit in (("a.vtu", []), ("b.vtu", ["--time-limit", "600"])):
        assert main.run(["optimize", "cube.vtu", out, *limit]) == 0
        assert "time limit" not in capsys.readouterr().out
    assert (place / "a.vtu").read_bytes() == (place / "b.vtu").read_bytes()


def test_time_that_is_up_before_the_filter_starts_hands_the_mesh_on(place):
    limit = wct.TimeLimit(1e-9)
    result = (wct.Reader("cube.vtu") | wct.Filter.meshing_well_centered()).execute(limit)
    assert np.array_equal(result.mesh.points, wct.read("cube.vtu").points)
    assert "time limit" in limit.ended(result)


def test_a_mesh_that_needs_nothing_is_not_cut_short(place):
    wct.write("good.vtu", bcc(2))
    assert main.run(["optimize", "good.vtu", "out.vtu", "--time-limit", "1e-9"]) == 0


def test_a_batch_keeps_the_best_of_each_file(place):
    mover = wct.Filter.meshing_well_centered(edge_length=0.08)
    done = wct.run_batch(mover, ["ball.vtu"], "out", jobs=1, time_limit=0.5)
    assert [(one.exit_code, SAID in one.cause) for one in done.records] == [(1, True)]
    wct.read("out/ball.vtu")


def test_limits_of_no_use_are_refused(place, capsys):
    assert "--time-limit" in refused(capsys, "optimize", "cube.vtu", "out.vtu", "--time-limit", "0")
    with pytest.raises(wct.OptionError, match="the time limit is nan s"):
        wct.TimeLimit(float("nan"))
