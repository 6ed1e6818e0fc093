"""What was found once stays mended: all cases of ``tests/data/regressions``, see the README there."""

import json
import shutil
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wct_plugin as wct
from benchmarks.fuzz.judge import exact, read_mesh, result, said
from wct_plugin.cli import main
from wct_plugin.measure import quality

DATA = Path(__file__).parents[1] / "data"
CASES = sorted(path.parent.name for path in (DATA / "regressions").glob("*/case.json"))


def _reads(case: dict[str, Any], folder: Path) -> None:
    path = folder / case["read"]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", wct.WctWarning)
        if "said" in case:
            with pytest.raises(wct.InputError) as caught:
                wct.read(path)
            assert case["said"] in str(caught.value)
            assert said.faults_of_message(str(caught.value), f"{path}: ") == []
            return
        mesh = wct.read(path)
    assert {kind: len(getattr(mesh, kind)) for kind in case if kind != "read"} == {
        kind: count for kind, count in case.items() if kind != "read"
    }
    assert read_mesh.faults_of(mesh) == []


def _runs(case: dict[str, Any], folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main.run(case["command"]) == case["exit"]
    printed = "".join(capsys.readouterr())
    assert said.faults_of_output(printed) == []
    old, new = folder / case["mesh"], folder / case["out"]
    _as_good(old, new, printed)
    if case.get("planes"):
        assert result.faults_of_planes(result.load(old), result.load(new)) == []


def _as_good(before: Path, after: Path, printed: str) -> None:
    old, new = result.load(before), result.load(after)
    assert result.faults_of_mesh(new) == []
    faults = result.faults_of_regions(old, new, volumes=True) + result.faults_of_groups(old, new)
    assert not faults or "missed: " in printed, faults


def _stops(case: dict[str, Any], folder: Path) -> None:
    mesh = wct.read(folder / case["mesh"])
    calls = []

    def progress(_: Any) -> bool:
        calls.append(1)
        return len(calls) <= case["stop"]

    new, _ = wct.apply_filter(case["filter"], mesh, progress=progress, **case["options"])
    wct.write(folder / "out.vtu", new)
    assert result.faults_of_mesh(result.load(folder / "out.vtu")) == []


def _has_flags(case: dict[str, Any], folder: Path) -> None:
    for name in case["flags"]:
        with np.load(folder / name) as arrays:
            mesh = wct.TetMesh(arrays["P"], arrays["T"])
        measured = quality.measure(mesh)
        most = exact.count_flags(mesh.points, mesh.tets)
        least = exact.count_flags(mesh.points, mesh.tets, exact.TIE)
        for flag, values in (("3wc", measured.well_centered_3), ("2wc", measured.well_centered_2)):
            assert least[flag] <= int(values.sum()) <= most[flag]


@pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")
@pytest.mark.parametrize("name", CASES)
def test_it_stays_mended(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "regressions" / name  # as deep as in the data, whose files a case may name
    shutil.copytree(DATA / "regressions" / name, folder)
    for path in DATA.glob("*.vtu"):
        (tmp_path / path.name).symlink_to(path)
    monkeypatch.chdir(folder)
    case = json.loads((folder / "case.json").read_text())
    if "read" in case:
        _reads(case, folder)
    elif "command" in case:
        _runs(case, folder, capsys)
    elif "filter" in case:
        _stops(case, folder)
    else:
        _has_flags(case, folder)


def test_each_folder_is_a_case() -> None:
    folders = [path.name for path in (DATA / "regressions").iterdir() if path.is_dir()]
    assert sorted(folders) == CASES
