"""Fuzzed files: cases are what their numbers say, what dies or does not hold is noticed, and a few cases hold."""

import json
import random
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.fuzzing import TETS, read_as

from benchmarks.fuzz import changed_bytes, command_case, file_case, file_run, seed_files
from benchmarks.fuzz.findings import Finding, Findings


@pytest.fixture(scope="module")
def seeds(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("seeds")
    seed_files.made(folder / "all")
    return folder / "all"


def test_a_number_is_a_case(seeds: Path, tmp_path: Path) -> None:
    places = seed_files.made(seeds)
    for number in range(12):
        made = []
        for turn in "ab":
            folder = tmp_path / f"{number}{turn}"
            folder.mkdir()
            file_case.make(places, 5, number, folder)
            made.append({path.name: path.read_bytes() for path in folder.iterdir() if path.suffix != ".h5"})
            folder = tmp_path / f"{number}{turn}c"
            folder.mkdir()
            case = command_case.make(5, number, folder)
            made[-1] |= {path.name: path.read_bytes() for path in folder.iterdir()}
            made[-1]["arguments"] = repr(case.arguments).encode()
        assert made[0] == made[1]


def test_every_seed_file_is_read_or_refused_for_a_reason(seeds: Path) -> None:
    whole = [place for place in seed_files.made(seeds) if not place.name.startswith("data-")]
    assert len(whole) > 90
    for place in whole:
        outcome = file_case.read_and_judge(seed_files.main_file(place))
        assert outcome.what == "read", (place.name, outcome.said)
        assert outcome.faults == ()


def test_changes_change() -> None:
    data = b"1 2 3\n4 5 6\n" * 9
    made = {changed_bytes.changed(random.Random(number), data, b"") for number in range(300)}
    assert len(made) > 250


def test_readers_that_do_not_hold(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import wct_plugin as wct

    def slow(_: Any) -> None:
        while True:
            pass

    def warns(path: Path) -> Any:
        np.float16(1) * np.float16(60000) * np.float16(2)
        return read_as()

    path = tmp_path / "a.vtu"
    for reads, fault in (
        (_raise(KeyError("a")), "KeyError is raised"),
        (_raise(wct.InputError("of two\nlines")), "the message has several lines"),
        (slow, "reading took more than"),
        (warns, "RuntimeWarning is left"),
        (lambda _: bytearray(1 << 30) and read_as(), "reading took"),
        (lambda _: read_as(tets=TETS + 1), "tets have an index out of"),
    ):
        monkeypatch.setattr(wct, "read", reads)
        monkeypatch.setattr(file_case, "SECONDS", 0.2)
        assert any(fault in one for one in file_case.read_and_judge(path).faults), fault


def _raise(error: Exception) -> Callable[[Any], Any]:
    def raises(_: Any) -> Any:
        raise error

    return raises


def test_a_child_that_dies_is_a_finding(seeds: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    dies = tmp_path / "python"
    dies.write_text(
        '#!/bin/sh\nfor last; do :; done\nif [ "$last" = 3 ]; then echo 0; echo 1; kill -11 $$; fi\necho 2\n'
    )
    dies.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(dies))
    findings = Findings(tmp_path / "findings")
    assert file_run._child(seeds, seed_files.made(seeds), 0, 0, 3, findings) == 2
    told = json.loads((tmp_path / "findings/file-0-1/finding.json").read_text())
    assert told["faults"] == ["the process died of SIGSEGV"]
    assert told["again"] == "python -m benchmarks.fuzz --case file:0:1"
    assert any((tmp_path / "findings/file-0-1/files").iterdir())


def test_findings_of_one_kind_are_one_line(tmp_path: Path) -> None:
    findings = Findings(tmp_path)
    for number in range(5):
        findings.add(Finding("file", 0, number, "main.vtu", (f"tet {number} is bad",), "said"), None)
    assert findings.lines()[-1].split() == ["5", "file:0:0", "main.vtu:", "tet", "0", "is", "bad", "said"]
    assert len(list(tmp_path.iterdir())) == 2


def test_some_files(seeds: Path, tmp_path: Path) -> None:
    findings = Findings(tmp_path)
    file_run.run(seeds, 0, 0, 1500, findings)
    assert sum(findings.counts.values()) == 1500
    assert not findings.found, findings.lines()
