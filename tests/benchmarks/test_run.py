"""What becomes of a tool is a row, whatever it is."""

import sys
from pathlib import Path

import numpy as np
import pytest
from builders import jittered_cube

from benchmarks import table
from benchmarks.judge import judge
from benchmarks.odt import odt_delaunay
from benchmarks.run import run, watch
from wct_plugin.adapters.meshio import write
from wct_plugin.mesh import TetMesh


@pytest.mark.parametrize(
    ("code", "status"),
    [
        ("pass", "ok"),
        ("import os; os.abort()", "crashed: SIGABRT"),
        ("raise ValueError('no | tets')", "failed: ValueError: no | tets"),
        ("raise SystemExit(3)", "not installed"),
        ("import time; time.sleep(60)", "stopped after 1 s"),
    ],
)
def test_every_end_has_a_status(code: str, status: str, tmp_path: Path) -> None:
    assert watch([sys.executable, "-c", code], tmp_path, 30.0 if "sleep" not in code else 1.0) == status


def test_a_tool_runs_in_a_process_of_its_own(tmp_path: Path) -> None:
    mesh = jittered_cube(3)
    write(tmp_path / "cube.vtu", mesh)
    outcome = run("wct apply_coord slide cwc", tmp_path / "cube.vtu", None, 60.0)
    assert outcome.status == "ok"
    row = judge(TetMesh(outcome.arrays["points"], outcome.arrays["tets"]), mesh, mesh.boundary_surface())
    assert row["tets"] == len(mesh.tets)
    assert row["encloses"]
    assert row["inverted"] == 0
    assert row["deviation"] < 1e-9
    assert 0.0 < outcome.arrays["cpu"] < outcome.cpu
    assert 0 <= outcome.arrays["memory_above"] < outcome.arrays["memory"]


def test_odt_keeps_the_boundary_and_gains() -> None:
    mesh = jittered_cube(4)
    made = TetMesh(*odt_delaunay(np.array(mesh.points), np.array(mesh.tets), sweeps=10))
    before, after = (judge(which, mesh, mesh.boundary_surface()) for which in (mesh, made))
    assert after["deviation"] < 1e-9
    assert abs(after["volume_change"]) < 1e-9
    assert after["3wc"] > before["3wc"]


def test_rows_that_failed_are_in_the_table() -> None:
    mesh = jittered_cube(2)
    rows = [
        {"mesh": "cube", "tool": "input", "status": "ok", **judge(mesh, mesh, mesh.boundary_surface())},
        {"mesh": "cube", "tool": "other", "status": "failed: a | b", "load": 1.0},
    ]
    lines = table.markdown(rows, table.machine(["numpy", "no-such-package"])).splitlines()
    assert any(line.startswith("| other | - |") and line.endswith("| failed: a / b |") for line in lines)
    assert any(line.startswith("| other | 0 of 1 |") for line in lines)
