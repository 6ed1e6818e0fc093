"""``--save-case``: an internal error of a filter is saved with all that it takes to have it again."""

import json
import os
import shlex
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from support.builders import jittered_cube
from support.hostile import POINTS, xdmf
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main

WCT = Path(sys.executable).with_name("wct")
_BREAKING = '''
from wct_plugin.plugins import FilterStage, Options
from wct_plugin.mesh import TetMesh

class Breaking(FilterStage[Options]):
    """Divide by zero."""

    name = "compute_breaking"
    takes = TetMesh
    gives = TetMesh
    declaration = Options

    def run(self, mesh, progress):
        return 1 / (len(mesh.tets) - len(mesh.tets))
'''


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a mesh and a pipeline, and a package whose filter fails."""
    site = tmp_path / "site"
    info = site / "breaking-1.0.dist-info"
    info.mkdir(parents=True)
    (site / "breaking.py").write_text(_BREAKING)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: breaking\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[wct_plugin.filters]\ncompute_breaking = breaking:Breaking\n")
    monkeypatch.syspath_prepend(str(site))
    work = tmp_path / "work"
    work.mkdir()
    monkeypatch.chdir(work)
    wct.write("cube.vtu", jittered_cube(2, 0))
    (work / "chain.json").write_text('[{"type": "filters.compute_breaking"}]')
    return work


SAID = (
    "internal error in stage 2 of 3 (filters.compute_breaking), please report it: ZeroDivisionError: division by zero"
)


def test_without_it_the_line_asks_for_it(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    said = refused(capsys, "run", "chain.json", "cube.vtu", "out.vtu")
    assert said == f"{SAID}; --save-case FILE saves what is needed to find it (WCT_TRACEBACK=1 shows where)"
    assert sorted(os.listdir()) == ["chain.json", "cube.vtu"]


def test_a_case_is_replayed(place: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "elsewhere.vtu"
    said = refused(capsys, "run", "chain.json", place / "cube.vtu", out, "--save-case", "case.zip", "--max-bytes", "1G")
    assert said == f"{SAID}; its case is saved in case.zip: please send it (WCT_TRACEBACK=1 shows where)"
    case = tmp_path / "case"
    with zipfile.ZipFile("case.zip") as archive:
        archive.extractall(case)
    content = json.loads((case / "case.json").read_text())
    assert content["command"] == [
        "wct",
        "run",
        "files/0/chain.json",
        "files/0/cube.vtu",
        "elsewhere.vtu",
        "--max-bytes",
        "1G",
    ]
    assert content["versions"]["numpy"] == np.__version__
    assert content["error"] == SAID
    assert (case / "files/0/cube.vtu").read_bytes() == (place / "cube.vtu").read_bytes()
    assert "return 1 / (len(mesh.tets)" in (case / "traceback.txt").read_text()
    assert shlex.join(content["command"]) in (case / "replay.txt").read_text()
    env = dict(os.environ, PYTHONPATH=str(tmp_path / "site"))
    again = subprocess.run([WCT, *content["command"][1:]], cwd=case, capture_output=True, text=True, env=env)
    assert again.returncode == 2
    assert again.stderr.startswith(f"error: {SAID}; --save-case")


def test_files_beside_the_input_and_in_the_pipeline_are_in_it(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import h5py

    (place / "sub").mkdir()
    with h5py.File("sub/points.h5", "w") as file:
        file["p"] = POINTS
    xdmf(Path("a.xdmf"), "sub/points.h5:/p")
    chain = ["a.xdmf", {"type": "filters.compute_breaking"}, str(place / "out.vtu")]
    (place / "chain.json").write_text(json.dumps(chain))
    refused(capsys, "run", "chain.json", "--save-case=case.zip")
    with zipfile.ZipFile("case.zip") as archive:
        names = {name for name in archive.namelist() if name.startswith("files/")}
        assert names == {"files/0/chain.json", "files/0/a.xdmf", "files/0/sub/points.h5"}
        moved = json.loads(archive.read("files/0/chain.json"))
    assert moved == ["files/0/a.xdmf", {"type": "filters.compute_breaking"}, "out.vtu"]


def test_optimize_has_its_seed_in_it(
    place: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wct_plugin.filters.meshing_well_centered.MeshingWellCentered.run", lambda *_: 1 / 0)
    said = refused(capsys, "optimize", "cube.vtu", "out.vtu", "--seed", "7", "--save-case", "case.zip")
    assert "its case is saved in case.zip" in said
    with zipfile.ZipFile("case.zip") as archive:
        assert json.loads(archive.read("case.json"))["seed"] == "7"


def test_where_it_cannot_be_saved_is_found_before_the_work(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    said = refused(capsys, "run", "chain.json", "cube.vtu", "out.vtu", "--save-case", "none/case.zip")
    assert said == "none/case.zip: there is no directory none; create it first"
    assert main.run(["report", "cube.vtu", "--save-case", "case.zip"]) == 0
    assert not (place / "case.zip").exists()
