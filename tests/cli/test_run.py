"""``wct run`` and ``wct optimize --print-pipeline`` as their users meet them."""

import io
import json
import sys

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from support.builders import ball, bcc, jittered_cube, single, sphere_surface
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.pipeline import presets

CUBE = jittered_cube(4, 0)
FLAT = single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.1]])
MOVE = {"type": "filters.apply_coord_well_centering", "goal": "3wc", "boundary": "fixed"}


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wct.write("cube.vtu", CUBE)
    return tmp_path


def chain(place, content, name="chain.json"):
    (place / name).write_text(json.dumps(content))
    return name


def stdin(monkeypatch, content):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(json.dumps(content).encode())))


# --- what it does ---------------------------------------------------------------------------------------------------


def test_a_file_with_readers_and_writers(place, capsys):
    assert main.run(["run", chain(place, ["cube.vtu", {"type": "filters.get_quality"}, "out.vtu", "out.html"])]) == 0
    printed = capsys.readouterr().out
    assert f"{len(CUBE.tets)} tets, {len(CUBE.points)} points" in printed
    assert "filters.get_quality" in printed
    assert "<svg" in (place / "out.html").read_text()
    assert np.array_equal(wct.read("out.vtu").tets, CUBE.tets)


def test_filters_alone_between_files_given_on_the_command_line(place, capsys):
    name = chain(place, [MOVE])
    assert main.run(["run", name, "cube.vtu", "out.vtu", "out.json"]) == 1
    assert "tets miss the goal 3wc" in capsys.readouterr().out
    assert json.loads((place / "out.json").read_text())["source"] == "out.vtu"


def test_exit_codes_follow_the_goal(place):
    wct.write("good.vtu", bcc(2))
    wct.write("flat.vtu", FLAT)
    name = chain(place, [MOVE])
    assert main.run(["run", name, "good.vtu", "out.vtu"]) == 0
    assert main.run(["run", name, "flat.vtu", "out2.vtu"]) == 1
    assert np.array_equal(wct.read("out2.vtu").points, FLAT.points)


def test_settings(place, capsys):
    wct.write("bcc.vtu", bcc(2))
    name = chain(place, ["bcc.vtu", {**MOVE, "tag": "mover"}, "out.vtu"])
    settings = ["--set", "mover.goal=cwc", "--set", "filters.apply_coord_well_centering.tolerance=null"]
    assert main.run(["run", name, *settings, "--metadata", "m.json"]) == 0
    options = json.loads((place / "m.json").read_text())["stages"][1]["options"]
    assert (options["goal"], options["tolerance"], options["boundary"]) == ("cwc", None, "fixed")
    capsys.readouterr()
    assert "unknown option 'gaol'; did you mean 'goal'" in refused(capsys, "run", name, "--set", "mover.gaol=cwc")
    assert "no stage 'moved' in the pipeline; did you mean 'mover'" in refused(
        capsys, "run", name, "--set", "moved.goal=cwc"
    )


def test_stdin_and_metadata_on_stdout(place, capsys, monkeypatch):
    stdin(monkeypatch, [{"type": "filters.get_quality", "worst": 1}])
    assert main.run(["run", "-", "cube.vtu", "--metadata", "-"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["stages"][1]["metrics"]["tets"] == len(CUBE.tets)
    assert found["stages"][0]["options"] == {"filename": "cube.vtu", "format": None, "repair": False}


def test_validate_checks_and_runs_nothing(place, capsys):
    name = chain(place, ["cube.vtu", MOVE, "out.vtu"])
    assert main.run(["run", name, "--validate"]) == 0
    line = "valid: readers.mesh | filters.apply_coord_well_centering | writers.mesh\n"
    assert capsys.readouterr().out == line
    assert not (place / "out.vtu").exists()
    assert main.run(["run", chain(place, [MOVE]), "--validate"]) == 0
    capsys.readouterr()
    clash = chain(
        place, [{"type": "filters.generate_tetrahedralization"}, {"type": "filters.generate_tetrahedralization"}]
    )
    assert "stage 2 of 2 (filters.generate_tetrahedralization): needs a surface" in refused(
        capsys, "run", clash, "--validate"
    )


def test_the_schema_is_printed_and_fits_what_runs(place, capsys):
    assert main.run(["run", "--schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    Draft202012Validator.check_schema(schema)
    assert Draft202012Validator(schema).is_valid(["cube.vtu", MOVE, "out.vtu"])


# --- what it refuses ------------------------------------------------------------------------------------------------


def test_errors_are_one_line_and_leave_nothing_behind(place, capsys):
    cases = {
        "stage 2 of 3 (filters.get_qualty): unknown stage 'filters.get_qualty'; did you mean": [
            "cube.vtu", {"type": "filters.get_qualty"}, "out.vtu",
        ],
        "stage 1 of 3 (readers.mesh): cub.vtu: no such file": ["cub.vtu", MOVE, "out.vtu"],
        "unknown option 'gaol'; did you mean 'goal'": ["cube.vtu", {**MOVE, "gaol": 1}, "out.vtu"],
        "cycle: ": ["cube.vtu", {**MOVE, "tag": "a", "inputs": "b"}, {**MOVE, "tag": "b", "inputs": "a"}, "out.vtu"],
        "needs a surface, here is a tet mesh": ["cube.vtu", {"type": "filters.generate_tetrahedralization"}, "out.vtu"],
        "STL cannot carry a tetrahedral mesh": ["cube.vtu", MOVE, "out.stl"],
        "the pipeline has no stages": [],
    }  # fmt: skip
    for message, content in cases.items():
        name = chain(place, content)
        for mode in ([], ["--validate"]):
            if content or mode:
                assert message in refused(capsys, "run", name, *mode)
    assert sorted(path.name for path in place.iterdir()) == ["chain.json", "cube.vtu"]


def test_usage(place, capsys, monkeypatch):
    name = chain(place, [MOVE])
    assert refused(capsys, "run") == "Missing argument 'PIPELINE'."
    assert refused(capsys, "run", name).endswith(f"give one: wct run {name} IN [OUT...]")
    assert refused(capsys, "run", name, "cube.vtu").startswith("nothing would be written; give an output")
    closed = chain(place, ["cube.vtu", MOVE, "out.vtu"], "closed.json")
    assert "needs no input; only filters that take a mesh can have cube.vtu" in refused(
        capsys, "run", closed, "cube.vtu"
    )
    (place / "bad.json").write_text('["cube.vtu"')
    said = refused(capsys, "run", "bad.json")
    assert said == "bad.json: the pipeline is no JSON: line 1, column 12: Expecting ',' delimiter"
    stdin(monkeypatch, {"pipline": []})
    assert refused(capsys, "run", "-").startswith("stdin: unknown key 'pipline' beside the pipeline; did you mean")
    assert refused(capsys, "run", "dec-redy").startswith(
        "dec-redy: no such file; did you mean 'dec-ready'? (ready-made"
    )
    (place / "folder").mkdir()
    assert refused(capsys, "run", "folder") == "folder: is a directory; the name of a pipeline's file is needed"
    assert "there is no directory no" in refused(capsys, "run", name, "cube.vtu", "o.vtu", "--metadata", "no/m.json")


def test_a_filter_that_fails_is_named_and_nothing_is_written(place, capsys):
    plane = wct.SurfaceMesh(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=float), np.array([[0, 1, 2]]))
    wct.write("flat.ply", plane)
    name = chain(place, ["flat.ply", "copy.ply", {"type": "filters.generate_tetrahedralization"}, "out.vtu"])
    said = refused(capsys, "run", name)
    assert said.startswith("stage 3 of 4 (filters.generate_tetrahedralization): flat.ply: the surface is planar")
    assert sorted(path.name for path in place.iterdir()) == ["chain.json", "cube.vtu", "flat.ply"]


def test_a_bug_in_a_filter_is_one_line_with_its_name(place, capsys, monkeypatch):
    monkeypatch.setattr("wct_plugin.filters.get_quality.make_report", lambda *_, **__: 1 / 0)
    name = chain(place, ["cube.vtu", {"type": "filters.get_quality"}, "out.vtu"])
    said = refused(capsys, "run", name)
    assert said.startswith("internal error in stage 2 of 3 (filters.get_quality), please report it: ZeroDivisionError")
    assert not (place / "out.vtu").exists()


def test_a_full_disk(small_disk, place, capsys):
    wct.write("big.vtu", jittered_cube(10, 0))
    name = chain(place, ["big.vtu", {"type": "filters.get_quality"}, str(small_disk / "out.vtu")])
    assert str(small_disk / "out.vtu") in refused(capsys, "run", name)
    assert list(small_disk.iterdir()) == []


# --- optimize as a pipeline -----------------------------------------------------------------------------------------


def test_the_printed_pipeline_does_what_optimize_does(place, capsys):
    wct.write("ball.vtu", ball(3))
    wct.write("true.ply", sphere_surface(500))
    arguments = ["ball.vtu", "out.vtu", "--goal", "3wc", "--reference", "true.ply", "--tolerance", "0.01"]
    arguments += ["--json", "out.json"]
    assert main.run(["optimize", *arguments, "--print-pipeline"]) == 0
    printed = capsys.readouterr().out
    assert not (place / "out.vtu").exists()
    (place / "chain.json").write_text(printed)
    found = []
    for command in (["optimize", *arguments], ["run", "chain.json"]):
        assert main.run(command) == 0
        mesh, report = wct.read("out.vtu"), json.loads((place / "out.json").read_text())
        for stage in report["provenance"]["stages"]:
            stage.pop("seconds")
        found.append((mesh.points.tobytes(), mesh.tets.tobytes(), report))
    assert found[0] == found[1]
    assert set(found[0][2]) == {"before", "after", "filters", "provenance"}


def test_the_printed_pipeline_of_a_surface(place, capsys):
    wct.write("ball.ply", sphere_surface(40))
    arguments = ["ball.ply", "out.vtu", "--tolerance", "1e-4", "--mesher-edge-length", "0.2", "--html", "page.htm"]
    assert main.run(["optimize", *arguments, "--print-pipeline"]) == 0
    assert json.loads(capsys.readouterr().out) == [
        "ball.ply",
        {"type": "filters.generate_tetrahedralization", "edge_length": 0.2, "tag": "before"},
        {"type": "filters.meshing_well_centered", "tolerance": 1e-4},
        {"type": "writers.mesh", "filename": "out.vtu", "tag": "after"},
        {"type": "writers.report", "filename": "page.htm", "format": "html", "inputs": ["before", "after"]},
    ]
    assert main.run(["optimize", *arguments[:2], "--print-pipeline"]) == 0
    short = ["ball.ply", {"type": "filters.generate_tetrahedralization"}, {"type": "filters.meshing_well_centered"}]
    assert json.loads(capsys.readouterr().out) == [*short, "out.vtu"]
    assert "epsilon" in refused(capsys, "optimize", *arguments, "--mesher-epsilon", "1e-3", "--print-pipeline")


# --- ready-made -----------------------------------------------------------------------------------------------------


def test_ready_made_pipelines_hold_filters_only_and_say_what_for(capsys):
    assert presets.names() == ["dec-ready", "repair-ftetwild", "tetgen-regions"]
    assert main.run(["run", "--help"]) == 0
    shown = capsys.readouterr().out
    for name in presets.names():
        content = json.loads(presets.read(name))
        assert f"{name} " in shown
        assert content["description"] in shown
        assert all(stage["type"].startswith("filters.") for stage in content["pipeline"])


def test_dec_ready(place):
    assert main.run(["run", "dec-ready", "cube.vtu", "out.vtu"]) == 0
    mesh = wct.read("out.vtu")
    assert mesh.cell_data["is_cwc"].all()
    assert mesh.point_data["dual_volume"].min() > 0
    assert mesh.cell_data["min_dual_length"].min() > 0
    assert mesh.point_data["dual_volume"].sum() == pytest.approx(1.0)
