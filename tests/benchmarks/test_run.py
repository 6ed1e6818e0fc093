"""What becomes of a tool is a row, whatever it is."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.builders import ball, jittered_cube, regular_tet, sphere_surface

from benchmarks import growth, kernels, ours, table
from benchmarks.judge import judge, row_of
from benchmarks.odt import odt_delaunay
from benchmarks.ours import MESHING
from benchmarks.peers import MESHER
from benchmarks.run import run, watch
from wct_plugin.io import write
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


def test_the_mesher_fills_the_surface_given_with_the_mesh(tmp_path: Path) -> None:
    mesh, surface = ball(2), sphere_surface(800)
    write(tmp_path / "ball.vtu", mesh)
    write(tmp_path / "sphere.ply", surface)
    outcome = run(MESHER.name, tmp_path / "ball.vtu", tmp_path / "sphere.ply", 120.0)
    row = row_of("ball", MESHER.name, outcome, mesh, surface)
    assert row["status"] == "ok"
    assert row["deviation"] < 1.2e-3 < 0.1 * judge(mesh, mesh, surface)["deviation"]
    assert row["ms_per_tet"] == pytest.approx(1e3 * row["cpu"] / row["tets"])
    assert row["kb_per_tet"] == pytest.approx(row["memory_above"] * 2**20 / 1e3 / row["tets"])


def test_a_tolerance_is_given_with_a_surface_only(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []

    def apply(name: str, mesh: TetMesh, **options: Any) -> tuple[TetMesh, dict[str, Any]]:
        seen.append(options)
        return mesh, {}

    monkeypatch.setattr(ours, "apply_filter", apply)
    mesh = regular_tet()
    near = replace(mesh, reference=mesh.boundary_surface())
    meshing = [tool for tool in ours.OURS if tool.filter == MESHING.filter]
    for tool in meshing:
        tool.run(mesh)
        tool.run(near)
    boundaries = [{"boundary": "fixed"}, {"boundary": "keep"}, {}]
    assert seen == [options | more for options in boundaries for more in ({}, {"tolerance": 1e-3})]


def test_fixed_and_keep_leave_what_is_well_centered(tmp_path: Path) -> None:
    mesh = regular_tet()
    write(tmp_path / "tet.vtu", mesh)
    for boundary in ("fixed", "keep"):
        outcome = run(f"{MESHING.name} {boundary}", tmp_path / "tet.vtu", None, 60.0)
        row = row_of("tet", boundary, outcome, mesh, mesh.boundary_surface())
        assert (row["status"], row["tets"], row["cwc"]) == ("ok", 1, 100.0)


def test_cpu_time_is_compared_on_the_same_mesh_only() -> None:
    def row(mesh: str, tool: str, cpu: float, status: str = "ok") -> table.Row:
        return {"mesh": mesh, "tool": tool, "status": status, "cpu": cpu}

    rows = [
        row("a", MESHING.name, 3.0),
        row("a", MESHER.name, 2.0),
        {"mesh": "a", "tool": "other", "status": "not installed"},
        row("b", MESHING.name, 3.0),
        row("b", MESHER.name, 1.0, "unusable: nothing"),
    ]
    assert [found.get("cpu_ratio") for found in table.beside_mesher(rows)] == [1.5, 1.0, None, None, None]


def _grown(tool: str, power: float, sizes: list[int]) -> list[table.Row]:
    known = {"shape": "ball", "mesh": "ball", "tool": tool, "status": "ok", "inverted": 0, "encloses": True}
    costs = [1e-3 * size**power for size in sizes]
    return [
        {**known, "tets": size, "cpu": cost, "ms_per_tet": 1e3 * cost / size, "kb_per_tet": 1.5}
        for size, cost in zip(sizes, costs, strict=True)
    ]


def test_growth_is_the_power_between_the_ends(tmp_path: Path) -> None:
    failed = {"shape": "ball", "mesh": "ball", "tool": "a", "status": "stopped after 9 s", "load": 1.0}
    rows = [*_grown("a", 1.5, [9000, 270_000]), failed, *_grown("b", 1.2, [9000, 30_000]), *_grown("c", 1.0, [9000])]
    of_a, of_b, of_c = growth.summary(rows)
    assert of_c == "ball, c: 1.00 ms and 1.50 kB per tet at 9000 tets"
    assert of_b.endswith("over a factor 3.3 in tets CPU time grows as tets^1.20")
    assert of_a.endswith(f"over a factor 30.0 in tets CPU time grows as tets^1.50: t(300 k) / t(10 k) = {30**1.5:.1f}")
    assert "| stopped after 9 s |" in growth.markdown(rows, table.machine(["numpy"]))
    large = {**_grown("TetGen -pYq1.2/12 -a", 0.5, [100_000])[0], "mesh": "ball100000", "3wc": 80.0, "cwc": 72.0}
    assert growth.summary([*rows, large]) == [of_a, of_b, of_c]
    beside = growth.markdown([*rows, large], table.machine(["numpy"])).splitlines()
    assert beside[-1] == "| ball | TetGen -pYq1.2/12 -a | 3.2 | 80.0 | 72.0 |"
    assert growth.plot(rows, tmp_path / "growth.png")
    assert (tmp_path / "growth.png").stat().st_size > 0


def test_kernels_report_their_rates() -> None:
    row = {
        "name": "test_energy_and_gradient[h/R]",
        "extra_info": {"rate": 26.81, "unit": "M tets / CPU s"},
        "stats": {"median": 0.00386, "rounds": 250},
    }
    lines = kernels.markdown({"benchmarks": [row]}).splitlines()
    assert lines[-1] == "| energy and gradient[h/R] | 26.8 | M tets / CPU s | 3.9 | 250 |"
