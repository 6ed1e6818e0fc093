"""``-`` on the command line: meshes through pipes, with what is said on stderr alone."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from support.builders import jittered_cube
from support.refusals import refused

import wct_plugin as wct

WCT = Path(sys.executable).with_name("wct")


def run(*arguments: str, given: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    return subprocess.run([WCT, *arguments], input=given, capture_output=True)


def test_optimize_from_stdin_to_stdout(tmp_path):
    wct.write(tmp_path / "cube.vtu", jittered_cube(4))
    done = run("optimize", "-", "-", "--input-format", "vtu", "--output-format", "msh.gz", "--goal", "3wc",
               given=(tmp_path / "cube.vtu").read_bytes())  # fmt: skip
    assert done.returncode == 0
    assert b"before" in done.stderr
    (tmp_path / "piped.msh.gz").write_bytes(done.stdout)
    code = run("optimize", str(tmp_path / "cube.vtu"), str(tmp_path / "plain.msh.gz"), "--goal", "3wc").returncode
    assert code == 0
    assert done.stdout == (tmp_path / "plain.msh.gz").read_bytes()


def test_create_report_and_run_in_a_pipe(tmp_path):
    made = run("create", "cube", "-", "--output-format", "mesh")
    assert (made.returncode, made.stdout[:22]) == (0, b"MeshVersionFormatted 2")
    report = run("report", "-", "--input-format", "mesh", "--json", "-", given=made.stdout)
    assert json.loads(report.stdout)["source"] == "-"
    (tmp_path / "chain.json").write_text(json.dumps([{"type": "filters.get_quality"}]))
    ran = run(
        "run",
        str(tmp_path / "chain.json"),
        "-",
        "-",
        "--input-format",
        "mesh",
        "--output-format",
        "vtk",
        given=made.stdout,
    )
    assert (ran.returncode, ran.stdout[:26]) == (0, b"# vtk DataFile Version 5.1")
    assert b"readers.mesh" in ran.stderr
    plan = run("optimize", "-", "out.vtu", "--input-format", "mesh", "--print-pipeline", given=made.stdout)
    assert {"type": "readers.mesh", "filename": "-", "format": "mesh"} in json.loads(plan.stdout)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["optimize", "cube.vtu", "-"], "-: has no suffix that tells its format; --output-format names it, as vtu"),
        (["optimize", "cube.vtu", "-", "--output-format", "xdmf"], "-: XDMF has several files; standard output is one"),
        (["optimize", "cube.vtu", "-", "--output-format", "vtu", "--json", "-"],
         "'-' is given twice; standard output takes one file"),
        (["report", "-", "-", "--input-format", "vtu"], "'-' is given twice; standard input is one file"),
    ],
)  # fmt: skip
def test_refusals(arguments, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    wct.write("cube.vtu", jittered_cube(4))
    assert refused(capsys, *arguments) == said
    assert [file.name for file in tmp_path.iterdir()] == ["cube.vtu"]
