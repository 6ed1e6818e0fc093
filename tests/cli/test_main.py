"""``wct`` as its users meet it: exit codes, one-line errors, tables, JSON, files written or not at all."""

import contextlib
import json
import os
import pty
import re
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from support.builders import ball, bcc, jittered_cube, single, sphere_surface
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.cli.optimize import OPTIMIZERS
from wct_plugin.errors import OptionError
from wct_plugin.measure import quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.pipeline.pipeline import mesher_within_tolerance
from wct_plugin.pipeline.stage import find_filter

WCT = Path(sys.executable).with_name("wct")
CUBE = jittered_cube(4, 0)


@pytest.fixture
def cube(tmp_path):
    wct.write(tmp_path / "cube.vtu", CUBE)
    return tmp_path / "cube.vtu"


# --- optimize -------------------------------------------------------------------------------------------------------


def test_optimize_writes_the_mesh_the_table_and_the_reports(cube, tmp_path, capsys):
    out, page, numbers = tmp_path / "out.vtu", tmp_path / "out.html", tmp_path / "out.json"
    code = main.run(["optimize", str(cube), str(out), "--goal", "3wc", "--html", str(page), "--json", str(numbers)])
    table = capsys.readouterr().out
    found = json.loads(numbers.read_text())
    better = wct.read(out)
    assert code == (0 if found["after"]["3wc"]["count"] == len(better.tets) else 1)
    assert found["after"]["3wc"]["count"] > found["before"]["3wc"]["count"]
    assert found["after"]["source"] == str(out)
    assert re.search(r"3WC +[\d.]+ % +[\d.]+ %", table)
    assert "<svg" in page.read_text()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cube.vtu", "out.html", "out.json", "out.vtu"]


def test_goal_met_is_exit_code_0(tmp_path):
    mesh = single([[0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]])
    wct.write(tmp_path / "regular.vtu", mesh)
    assert main.run(["optimize", str(tmp_path / "regular.vtu"), str(tmp_path / "out.vtu")]) == 0


def test_goal_missed_is_exit_code_1_and_the_output_is_there(tmp_path):
    flat = single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.1]])
    wct.write(tmp_path / "flat.vtu", flat)
    assert main.run(["optimize", str(tmp_path / "flat.vtu"), str(tmp_path / "out.vtu"), "--boundary", "fixed"]) == 1
    assert np.array_equal(wct.read(tmp_path / "out.vtu").points, flat.points)


def test_a_surface_goes_through_the_mesher(tmp_path):
    wct.write(tmp_path / "ball.stl", sphere_surface(100))
    arguments = ["optimize", str(tmp_path / "ball.stl"), str(tmp_path / "ball.vtu"), "--json", str(tmp_path / "b.json")]
    assert main.run([*arguments, "--mesher-edge-length", "0.25", "--mesher-epsilon", "0.01"]) in (0, 1)
    found = json.loads((tmp_path / "b.json").read_text())
    assert found["filters"]["generate_tetrahedralization"]["tets"] == found["before"]["tets"]
    assert 0 < found["after"]["deviation"]["fraction_of_diagonal"] < 0.05
    assert "meshing_well_centered" in found["filters"]


def test_a_surface_goes_through_tetgen(tmp_path, capsys):
    wct.write(tmp_path / "ball.ply", sphere_surface(100))
    arguments = ["optimize", tmp_path / "ball.ply", tmp_path / "ball.vtu", "--mesher", "tetgen"]
    options = ["--mesher-edge-length", "0.2", "--mesher-min-dihedral", "5", "--tolerance", "0.02", "--goal", "3wc"]
    assert main.run([*map(str, arguments), *options]) == 0
    assert "3WC" in capsys.readouterr().out
    assert len(wct.read(tmp_path / "ball.vtu").tets) > 100
    said = refused(capsys, *arguments, "--mesher-epsilon", "0.01")
    assert said == "filters.generate_tetrahedralization: option 'epsilon' is for mesher 'ftetwild', not for 'tetgen'"
    assert refused(capsys, *arguments, "--mesher-timeout", "0.01").startswith(
        "filters.generate_tetrahedralization: TetGen was stopped after 0.01 s, its timeout"
    )
    said = refused(capsys, "optimize", tmp_path / "ball.vtu", tmp_path / "out.vtu", "--mesher", "tetgen")
    assert said == f"--mesher is for surfaces; {tmp_path / 'ball.vtu'} has tets already"
    assert not (tmp_path / "out.vtu").exists()


def test_the_mesher_gets_half_of_the_tolerance_given():
    mesher, optimizer = find_filter("generate_tetrahedralization"), find_filter(OPTIMIZERS[0])

    def epsilon(given, **options):
        return mesher_within_tolerance(mesher(**given), optimizer(**options)).options.epsilon

    assert epsilon({}) == 5e-4
    assert epsilon({}, tolerance=1e-2) == 5e-4
    assert epsilon({"edge_length": 0.1}, tolerance=4e-4) == 2e-4
    assert epsilon({"epsilon": 2e-4}, tolerance=4e-4) == 2e-4
    with pytest.raises(OptionError, match=r"'epsilon' is 0.001; of the tolerance of 0.001 it may take half, 0.0005"):
        epsilon({"epsilon": 1e-3}, tolerance=1e-3)
    exact = mesher(mesher="tetgen")
    assert mesher_within_tolerance(exact, optimizer(tolerance=1e-4)) is exact


def test_the_reference_is_a_file_and_both_reports_are_about_it(tmp_path):
    wct.write(tmp_path / "ball.vtu", ball(4))
    wct.write(tmp_path / "true.ply", sphere_surface(2000))
    names = {name: str(tmp_path / name) for name in ("ball.vtu", "out.vtu", "true.ply", "out.json")}
    arguments = ["--reference", names["true.ply"], "--tolerance", "0.01", "--goal", "3wc", "--json", names["out.json"]]
    assert main.run(["optimize", names["ball.vtu"], names["out.vtu"], *arguments]) == 0
    found = json.loads((tmp_path / "out.json").read_text())
    before, after = (found[side]["deviation"]["fraction_of_diagonal"] for side in ("before", "after"))
    true = measure_deviation(ball(4).boundary_surface(), sphere_surface(2000)).max / sphere_surface(2000).diagonal
    assert before == pytest.approx(true, rel=1e-6)
    assert 0 < after <= 0.01


def test_a_reference_of_no_use_is_refused_before_the_work(cube, tmp_path, capsys):
    (tmp_path / "bad.stl").write_text("what is this?")
    before = sorted(tmp_path.iterdir())
    for name, message in (("none.ply", "there is no such file"), ("bad.stl", "bad.stl: "), ("cube.vtu", "a tet mesh")):
        out = tmp_path / "out.vtu"
        assert message in refused(capsys, "optimize", tmp_path / "no.ply", out, "--reference", tmp_path / name)
    assert sorted(tmp_path.iterdir()) == before


def test_edge_length_is_a_number_or_a_field_of_the_mesh(tmp_path, capsys):
    mesh = replace(CUBE, point_data={"size": np.full(len(CUBE.points), 0.15)})
    wct.write(tmp_path / "cube.vtu", mesh)
    given, out = str(tmp_path / "cube.vtu"), str(tmp_path / "out.vtu")
    counts = []
    for length in ("0.15", "size"):
        assert main.run(["optimize", given, out, "--goal", "3wc", "--edge-length", length]) == 0
        counts.append(len(wct.read(out).tets))
    assert counts[0] == counts[1] > 2 * len(CUBE.tets)
    capsys.readouterr()
    said = refused(capsys, "optimize", given, tmp_path / "other.vtu", "--edge-length", "sise")
    assert said.endswith("it must be a number or one of the mesh's point data: 'size'")
    assert not (tmp_path / "other.vtu").exists()


def test_another_filter_by_name(cube, tmp_path, capsys):
    out, numbers = tmp_path / "out.vtu", tmp_path / "out.json"
    mover = ["--filter", "apply_coord_well_centering"]
    assert main.run(["optimize", str(cube), str(out), *mover, "--boundary", "slide", "--json", str(numbers)]) == 1
    assert list(json.loads(numbers.read_text())["filters"]) == ["apply_coord_well_centering"]
    assert np.array_equal(wct.read(out).tets, CUBE.tets)
    capsys.readouterr()
    assert "unknown option 'seed'" in refused(capsys, "optimize", cube, out, *mover, "--seed", "1")
    assert "'boundary' is 'slide'" in refused(capsys, "optimize", cube, out, "--boundary", "slide")


def test_json_to_stdout_is_nothing_but_json(cube, tmp_path, capsys):
    main.run(["optimize", str(cube), str(tmp_path / "out.vtu"), "--goal", "3wc", "--json", "-"])
    assert set(json.loads(capsys.readouterr().out)) == {"before", "after", "filters", "provenance"}


def on_a_terminal(folder, arguments, signal_at=None, *signals):
    """Run wct with a terminal for stderr, signals when it first shows ``signal_at``; exit code, stdout, stderr."""
    ours, theirs = pty.openpty()
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "120"}
    with (folder / "stdout").open("w+") as out:
        child = subprocess.Popen([WCT, *arguments], cwd=folder, stdout=out, stderr=theirs, env=environment)
        os.close(theirs)
        shown = ""
        with contextlib.suppress(OSError):  # the terminal is gone when the child is
            while part := os.read(ours, 65536).decode(errors="replace"):
                shown += re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", part)
                if signal_at and signal_at in shown:
                    for one in signals:
                        child.send_signal(one)
                    signal_at = None
        os.close(ours)
        code = child.wait(60)
        out.seek(0)
        return code, out.read(), shown


@pytest.mark.parametrize(("stage", "sent"), [("resampling", signal.SIGTERM), ("local search: passes", signal.SIGINT)])
def test_ctrl_c_and_sigterm_keep_the_best_so_far(stage, sent, tmp_path):
    before = jittered_cube(16, 0)
    wct.write(tmp_path / "big.vtu", before)
    code, out, err = on_a_terminal(tmp_path, ["optimize", "big.vtu", "out.vtu", "--json", "out.json"], stage, sent)
    assert code == 1, err
    assert "the best so far is kept" in err
    assert "tets miss the goal" in out
    after = wct.read(tmp_path / "out.vtu")
    assert quality.volumes(after.points, after.tets).sum() == pytest.approx(1.0, rel=1e-9)
    good = [quality.measure(mesh).completely_well_centered for mesh in (before, after)]
    assert good[1].mean() >= good[0].mean()
    left = json.loads((tmp_path / "out.json").read_text())["filters"]["meshing_well_centered"]
    assert left["stopped"]
    assert left["remaining"]["count"] == (~good[1]).sum() > 0


def test_a_second_signal_gives_up(tmp_path):
    """One of each kind at once: two of the same kind that are not taken up yet count as one."""
    wct.write(tmp_path / "big.vtu", jittered_cube(16, 0))
    work = ["optimize", "big.vtu", "out.vtu", "--json", "out.json"]
    code, _, err = on_a_terminal(tmp_path, work, "resampling", signal.SIGINT, signal.SIGTERM)
    assert code == 2
    assert err.splitlines()[-1] == "error: interrupted; nothing was written"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["big.vtu", "stdout"]


def test_progress_shows_stage_bad_tets_and_time_on_a_terminal(tmp_path):
    wct.write(tmp_path / "cube.vtu", jittered_cube(8, 0))
    code, _, text = on_a_terminal(tmp_path, ["optimize", "cube.vtu", "out.vtu", "--goal", "3wc"])
    assert code in (0, 1)
    for stage in ("resampling", "local search: passes"):
        assert re.search(rf"stage 2 of 3: {stage}, \d+ bad tets? left(, about \d+ tets)? *\s+━+.? ?━* 0:\d\d", text)


def test_what_is_left_is_said_on_the_terminal_in_json_and_in_html(tmp_path, capsys):
    wct.write(tmp_path / "flat.vtu", single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.1]]))
    names = {suffix: str(tmp_path / f"out.{suffix}") for suffix in ("vtu", "json", "html")}
    extra = ["--boundary", "fixed", "--json", names["json"], "--html", names["html"]]
    assert main.run(["optimize", str(tmp_path / "flat.vtu"), names["vtu"], *extra]) == 1
    left = json.loads(Path(names["json"]).read_text())["after"]["remaining"]
    assert (left["count"], left["proven"], left["tets"][0]["place"]) == (1, 1, "corner")
    printed = " ".join(capsys.readouterr().out.split())
    for text in (printed, Path(names["html"]).read_text()):
        assert "1 tets miss the goal: 1 corner" in text
        assert "boundary=keep or move" in text
        assert "1 of them at creases that open no wider" in text


# --- report and filters ---------------------------------------------------------------------------------------------


def test_report_prints_tables_and_histogram(cube, capsys):
    assert main.run(["report", "--full", str(cube)]) == 0
    printed = capsys.readouterr().out
    for word in ("h/R", "Dihedral angle", "one-sided", "2WC", "Acute", "█", "Worst tets", "interior", "corner"):
        assert word in printed


def test_report_json_of_one_and_of_several(cube, capsys):
    assert main.run(["report", str(cube), "--json", "-"]) == 0
    one = json.loads(capsys.readouterr().out)
    assert one["tets"] == len(CUBE.tets)
    assert main.run(["report", str(cube), str(cube), "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out) == [one, one]


def test_several_reports_stand_side_by_side(cube, tmp_path, capsys):
    wct.write(tmp_path / "bcc.vtu", bcc(2))
    assert main.run(["report", "--full", str(cube), str(tmp_path / "bcc.vtu")]) == 0
    printed = capsys.readouterr().out
    assert re.search(r"\n +1: cube.vtu +2: bcc.vtu", printed)
    assert re.search(rf"tets +{len(CUBE.tets)} +{len(bcc(2).tets)} *\n", printed)
    assert re.search(r"CWC +no +yes *\n", printed)
    bars = printed.partition("Smallest h/R of each tet: 1: cube.vtu; 2: bcc.vtu\n")[2].partition("Largest")[0]
    counts = [re.findall(r" (\d+)\b", line)[-2:] for line in bars.splitlines()]
    assert [sum(int(pair[k]) for pair in counts) for k in (0, 1)] == [len(CUBE.tets), len(bcc(2).tets)]
    assert "Worst tets, 2: bcc.vtu" in printed


@pytest.mark.parametrize("suffix", ["stl", "vtu"])
def test_report_measures_against_a_surface_or_a_meshs_boundary(suffix, cube, tmp_path, capsys):
    larger = replace(CUBE, points=1.1 * CUBE.points)
    wct.write(tmp_path / f"larger.{suffix}", larger if suffix == "vtu" else larger.boundary_surface())
    assert main.run(["report", str(cube), "--json", "-", "--reference", str(tmp_path / f"larger.{suffix}")]) == 0
    found = json.loads(capsys.readouterr().out)["deviation"]
    assert found["max"] == pytest.approx(0.1 * np.sqrt(3.0))


def test_report_needs_a_file(capsys):
    assert main.run(["report"]) == 2
    assert "Missing argument 'FILE...'" in capsys.readouterr().err


def test_report_goal_decides_the_exit_code(cube, tmp_path, capsys):
    assert main.run(["report", str(cube), "--goal", "cwc"]) == 1
    wct.write(tmp_path / "bcc.vtu", bcc(2))
    assert main.run(["report", str(tmp_path / "bcc.vtu"), "--goal", "cwc"]) == 0


def test_filters_lists_and_shows_a_page(capsys):
    assert main.run(["filters"]) == 0
    assert "get_quality" in capsys.readouterr().out
    assert main.run(["filters", "apply_coord_well_centering"]) == 0
    page = capsys.readouterr().out
    assert re.search(r"goal +cwc +3wc \| cwc", page)
    assert re.search(r"crease_angle +40.0 +> 0, < 180", page)
    assert main.run(["filters", "get_quality", "--json", "-"]) == 0
    assert "worst" in json.loads(capsys.readouterr().out)["get_quality"]["options"]["properties"]
    assert main.run(["filters", "--json", "-"]) == 0
    mesher = json.loads(capsys.readouterr().out)["meshing_well_centered"]["options"]["properties"]
    assert mesher["reference"]["anyOf"] == [{"type": "string"}, {"type": "null"}]
    assert main.run(["filters", "meshing_well_centered"]) == 0
    assert re.search(r"boundary +move +move: resampled", capsys.readouterr().out)


def test_help_names_every_declared_option(capsys):
    assert main.run(["optimize", "--help"]) == 0
    shown = capsys.readouterr().out
    for option in ("--goal", "--boundary", "--reference", "--seed", "--filter", "--effort", "--mesher-edge-length"):
        assert option in shown


# --- bad input ------------------------------------------------------------------------------------------------------


def raw(path, points, cells):
    meshio.Mesh(np.asarray(points, dtype=float), [(kind, np.asarray(rows, np.int32)) for kind, rows in cells]).write(
        path
    )
    return path


CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]
FAULTS = {
    "nan": (
        [[0, 0, 0], [1, 0, 0], [0, np.nan, 0], [0, 0, 1]],
        [("tetra", [[0, 1, 2, 3]])],
        "coordinates must be finite",
    ),
    "range": (CORNERS, [("tetra", [[0, 1, 2, 9]])], "indices must lie in 0..4"),
    "twice": (CORNERS, [("tetra", [[0, 1, 2, 3], [1, 0, 3, 2]])], "tet 1 repeats tet 0"),
    "flat": ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [("tetra", [[0, 1, 2, 3]])], "has zero volume"),
}


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("command", ["optimize", "report"])
def test_bad_meshes(fault, command, tmp_path, capsys):
    points, cells, message = FAULTS[fault]
    path = raw(tmp_path / "bad.vtu", points, cells)
    outputs = [tmp_path / "out.vtu"] if command == "optimize" else ["--json", tmp_path / "out.json"]
    said = refused(capsys, command, path, *outputs)
    assert said.startswith(f"{path}: ")
    assert message in said
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(("kind", "count"), [("hexahedron", 8), ("hexahedron20", 20), ("wedge", 6), ("pyramid", 5)])
def test_other_cells_are_refused_by_name(kind, count, tmp_path, capsys):
    points = np.random.default_rng(0).random((count, 3))
    path = raw(tmp_path / "bad.vtu", points, [(kind, [list(range(count))])])
    assert f"has 1 {kind} cells and no tet" in refused(capsys, "optimize", path, tmp_path / "out.vtu")
    assert list(tmp_path.iterdir()) == [path]


def test_missing_empty_and_garbage_files(tmp_path, capsys):
    assert "no such file" in refused(capsys, "report", tmp_path / "none.vtu").lower()
    for suffix in (".vtu", ".msh", ".ply", ".stl"):
        empty, garbage = tmp_path / f"empty{suffix}", tmp_path / f"garbage{suffix}"
        empty.touch()
        garbage.write_text("what is this?\nnot a mesh\n" * 20)
        assert str(empty) in refused(capsys, "report", empty)
        assert str(garbage) in refused(capsys, "optimize", garbage, tmp_path / "out.vtu")
    assert not (tmp_path / "out.vtu").exists()


def test_a_surface_where_tets_are_needed(tmp_path, capsys):
    wct.write(tmp_path / "ball.ply", sphere_surface(30))
    assert "needs a tet mesh, here is a surface" in refused(capsys, "report", tmp_path / "ball.ply")


def test_a_planar_surface_is_refused_before_the_mesher(tmp_path, capsys):
    path = raw(tmp_path / "flat.ply", [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [("triangle", [[0, 1, 2]])])
    said = refused(capsys, "optimize", path, tmp_path / "out.vtu")
    assert "plan" in said
    assert str(path) in said
    assert list(tmp_path.iterdir()) == [path]


def test_options(cube, tmp_path, capsys):
    out = tmp_path / "out.vtu"
    assert "--gaol" in refused(capsys, "optimize", cube, out, "--gaol", "cwc")
    assert "'margin' is 0.7" in refused(capsys, "optimize", cube, out, "--margin", "0.7")
    assert "--effort" in refused(capsys, "optimize", cube, out, "--effort", "much")
    assert "is for surfaces" in refused(capsys, "optimize", cube, out, "--mesher-edge-length", "0.1")
    assert "unknown filter 'no_such'" in refused(capsys, "filters", "no_such")
    assert "No such command" in refused(capsys, "optimise")
    assert list(tmp_path.iterdir()) == [cube]


def test_outputs_are_checked_before_the_work(cube, tmp_path, capsys):
    for flag in ("--json", "--html"):
        said = refused(capsys, "optimize", cube, tmp_path / "out.vtu", flag, tmp_path / "none" / "file")
        assert str(tmp_path / "none") in said
    assert "unknown suffix" in refused(capsys, "optimize", cube, tmp_path / "out.xyz")
    assert "STL cannot carry a tetrahedral mesh" in refused(capsys, "optimize", cube, tmp_path / "out.stl")
    assert "/proc/out.vtu" in refused(capsys, "optimize", cube, "/proc/out.vtu")
    assert list(tmp_path.iterdir()) == [cube]


@pytest.mark.parametrize("suffix", [".vtu", ".msh", ".xdmf"])
def test_a_full_disk(small_disk, tmp_path, capsys, suffix):
    wct.write(tmp_path / "big.vtu", jittered_cube(10, 0))
    said = refused(capsys, "optimize", tmp_path / "big.vtu", small_disk / f"out{suffix}", "--effort", "1")
    assert str(small_disk / f"out{suffix}") in said
    assert list(small_disk.iterdir()) == []


def test_a_crash_of_ours_is_one_line_too(cube, capsys, monkeypatch):
    monkeypatch.setattr("wct_plugin.cli.report.make_report", lambda *_, **__: 1 / 0)
    assert "internal error, please report it: ZeroDivisionError" in refused(capsys, "report", cube)


def test_what_a_format_drops_is_said_in_one_line(tmp_path, capsys):
    mesh, _ = wct.apply_filter("compute_scalar_by_well_centeredness", CUBE)
    wct.write(tmp_path / "marked.vtu", mesh)
    main.run(["optimize", str(tmp_path / "marked.vtu"), str(tmp_path / "out.mesh"), "--goal", "3wc"])
    said = capsys.readouterr().err
    assert said.startswith("warning: ")
    assert "dual_volume" in said
