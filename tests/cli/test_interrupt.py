"""SIGTERM, as batch schedulers send it: nothing is left at work or half written, and what is written is named."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from support.builders import jittered_cube, sphere_surface
from support.processes import wait_until, working_in

import wct_plugin as wct
from wct_plugin.cli import main

WCT = Path(sys.executable).with_name("wct")
NEIGHBOURS = {
    "ftetwild": [{"type": "filters.generate_tetrahedralization", "mesher": "ftetwild", "edge_length": 0.01}],
    "meshlab.child": [{"type": "filters.meshlab", "filter": "meshing_remove_duplicate_vertices"}],
}


def started(folder: Path, *arguments: str) -> "subprocess.Popen[str]":
    """``wct`` at work in ``folder``, with temporary files in ``folder/tmp``."""
    (folder / "tmp").mkdir()
    environment = os.environ | {"TMPDIR": str(folder / "tmp")}
    return subprocess.Popen([WCT, *arguments], cwd=folder, env=environment, text=True, stderr=subprocess.PIPE)


def ended(program: str, folder: Path) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of ``wct report`` after what a program does first, in ``folder``."""
    call = """
sys.argv = ["wct", "report", "in.vtu", "--json", "out.json"]
from wct_plugin.cli.entry import main
main()
"""
    done = subprocess.run(
        [sys.executable, "-c", program + call], cwd=folder, capture_output=True, text=True, timeout=60, check=False
    )
    return done.returncode, done.stdout, done.stderr.strip()


@pytest.mark.parametrize("neighbour", NEIGHBOURS)
def test_sigterm_ends_the_neighbour_too_and_leaves_nothing(neighbour: str, tmp_path: Path) -> None:
    wct.write(tmp_path / "in.ply", sphere_surface(60))
    (tmp_path / "chain.json").write_text(json.dumps(NEIGHBOURS[neighbour]))
    suffix = "ply" if neighbour == "meshlab.child" else "vtu"
    with started(tmp_path, "run", "chain.json", "in.ply", f"out.{suffix}") as child:
        wait_until(lambda: any(neighbour in command for command in working_in(tmp_path / "tmp")), 60)
        child.send_signal(signal.SIGTERM)
        _, said = child.communicate(timeout=20)
    assert child.returncode == 2
    assert said.strip() == "error: interrupted; nothing was written"
    wait_until(lambda: not working_in(tmp_path), 2)
    assert not list((tmp_path / "tmp").iterdir())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["chain.json", "in.ply", "tmp"]


def test_sigterm_between_two_writers_names_what_the_first_one_wrote(tmp_path: Path) -> None:
    wct.write(tmp_path / "in.vtu", jittered_cube(16))
    (tmp_path / "chain.json").write_text(json.dumps([{"type": "filters.get_quality"}]))
    with started(tmp_path, "run", "chain.json", "in.vtu", "out.xdmf", "out.html") as child:
        wait_until((tmp_path / "out.xdmf").exists, 60)
        child.send_signal(signal.SIGTERM)
        _, said = child.communicate(timeout=20)
    assert child.returncode == 2
    assert said.strip() == "error: interrupted; written before: out.h5, out.xdmf"
    assert len(wct.read(tmp_path / "out.xdmf").tets) == len(jittered_cube(16).tets)
    assert sorted(path.name for path in tmp_path.glob("out*")) == ["out.h5", "out.xdmf"]


def test_an_error_between_two_writers_names_what_the_first_one_wrote(
    tmp_path: Path, small_disk: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    wct.write("in.vtu", jittered_cube(8))
    Path("chain.json").write_text(json.dumps([{"type": "filters.get_quality"}]))
    (small_disk / "rest").write_bytes(bytes(60_000))
    assert main.run(["run", "chain.json", "in.vtu", "out.vtu", "disk/out.vtu"]) == 2
    said = capsys.readouterr().err
    assert said == "error: disk/out.vtu: cannot be written: No space left on device; written before: out.vtu\n"
    assert [path.name for path in small_disk.iterdir()] == ["rest"]


@pytest.mark.parametrize("sent", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize("lost", [False, True])
@pytest.mark.parametrize("module", ["click", "wct_plugin.io.reader"])
def test_a_signal_while_modules_are_imported(tmp_path: Path, sent: str, lost: bool, module: str) -> None:
    """Before there is a command, and while one is at its imports; also where Python drops what the signal raises."""
    wct.write(tmp_path / "in.vtu", jittered_cube(2))
    program = f"""
import os, signal, sys

class Interrupted:
    def __del__(self):
        os.kill(os.getpid(), signal.{sent})

class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            sys.meta_path.remove(self)
            {"Interrupted()" if lost else f"os.kill(os.getpid(), signal.{sent})"}

sys.meta_path.insert(0, Finder())
"""
    assert ended(program, tmp_path) == (2, "", "error: interrupted; nothing was written")
    assert [path.name for path in tmp_path.iterdir()] == ["in.vtu"]


def test_an_interrupt_that_native_code_takes_for_an_error_of_its_own(tmp_path: Path) -> None:
    """NumPy raises IndexError whatever an index raises as it is asked for its number."""
    wct.write(tmp_path / "in.vtu", jittered_cube(2))
    program = """
import os, signal, sys
import numpy as np

class Index:
    def __index__(self):
        os.kill(os.getpid(), signal.SIGTERM)
        return 0

class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == "wct_plugin.io.reader":
            np.zeros(1)[Index()]

sys.meta_path.insert(0, Finder())
"""
    assert ended(program, tmp_path) == (2, "", "error: interrupted; nothing was written")
