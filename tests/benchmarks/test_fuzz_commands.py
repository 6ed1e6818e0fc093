"""Fuzzed commands: what does not hold is found, whatever it is, and a few cases hold."""

import os
import shutil
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from support.fuzzing import POINTS, command

from benchmarks.fuzz import command_case, command_child, random_mesh
from benchmarks.fuzz.command_case import Ran
from wct_plugin.cli import entry, main
from wct_plugin.io import read


def test_a_command_that_holds(tmp_path: Path) -> None:
    case = command(tmp_path)
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
    case = command(tmp_path)
    monkeypatch.setattr(entry, "main", does)
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
    case = command(tmp_path)
    command_child.run(case, tmp_path)
    shutil.copy(tmp_path / "in.vtu", tmp_path / "out.vtu")
    mesh = meshio.read(tmp_path / "out.vtu")
    doctor(mesh)
    meshio.write(tmp_path / "out.vtu", mesh)
    found = command_case.judge(case, Ran(0, "", 1.0), tmp_path)
    assert any(fault in one for one in found), found


def test_too_much_time_and_fewer_tets(tmp_path: Path) -> None:
    case = command(tmp_path, "3wc")
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
    case = command(tmp_path)
    ran = command_child.run(case, tmp_path)
    assert command_child._again(case, ran, tmp_path) == []

    def another() -> None:
        code = main.run(case.arguments)
        Path("out.vtu").write_bytes(Path("out.vtu").read_bytes().replace(b"<Points>", b"<Points >"))
        mesh = meshio.read("out.vtu")
        mesh.points[0, 0] += 1e-16
        meshio.write("out.vtu", mesh)
        raise SystemExit(code)

    monkeypatch.setattr(entry, "main", another)
    assert command_child._again(case, ran, tmp_path) == ["points differ on one core"]
    monkeypatch.setattr(entry, "main", _exits(2, "error: a"))
    assert command_child._again(case, ran, tmp_path) == [f"the exit code is {ran.code}, and 2 on one core"]


def test_another_mesh_when_read_and_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import wct_plugin as wct

    case = command(tmp_path)
    command_child.run(case, tmp_path)
    assert command_child._round_trip(case, tmp_path) == []
    monkeypatch.setattr(wct, "read", lambda path: replace(read(path), regions=None))
    assert command_child._round_trip(case, tmp_path) == ["regions differ when it is read and written"]


@pytest.mark.parametrize("library", ["meshio", "pyvista", "arrays"])
def test_other_libraries_meshes(library: str, tmp_path: Path) -> None:
    case = command(tmp_path)
    case = replace(case, name="object", arguments=(library, "apply_coord_well_centering", "{}"), outputs=("out.vtu",))
    ran = command_child.run(case, tmp_path)
    assert ran.code == 0, ran.text
    assert command_case.judge(case, ran, tmp_path) == []
    case = replace(case, arguments=(library, "apply_coord_well_centering", '{"margin": -1}'))
    (tmp_path / "out.vtu").unlink()
    ran = command_child.run(case, tmp_path)
    assert (ran.code, command_case.judge(case, ran, tmp_path)) == (2, [])


def test_some_commands(tmp_path: Path) -> None:
    for number in (0, 3, 8):
        (tmp_path / str(number)).mkdir()
        case, _, faults = command_child.whole(0, number, tmp_path / str(number))
        assert faults == [], case.arguments
