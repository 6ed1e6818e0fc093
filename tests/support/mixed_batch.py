"""Surfaces of which some break TetGen: a stand-in on the PATH knows them by their number of points."""

import json
import os
import shutil
import sys
from pathlib import Path

import pytest
from support.builders import sphere_surface

import wct_plugin as wct

CRASHING, HANGING, GREEDY = 41, 42, 43
CHAIN = [{"type": "filters.generate_tetrahedralization", "mesher": "tetgen", "edge_length": 0.5}]

_STAND_IN = """#!/bin/sh
read points rest < surface.poly
case $points in
{crashing}) kill -SEGV $$ ;;
{hanging}) sleep 1000 & sleep 1000 & wait ;;
{greedy}) exec {python} -c "
hoard = []
while True: hoard.append(bytearray(1 << 24))" ;;
*) exec {tetgen} "$@" ;;
esac
"""


def break_tetgen(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Put a ``tetgen`` before the real one that crashes, hangs or eats memory for particular surfaces."""
    tetgen = shutil.which("tetgen")
    assert tetgen
    script = folder / "tetgen"
    script.parent.mkdir()
    text = _STAND_IN.format(crashing=CRASHING, hanging=HANGING, greedy=GREEDY, python=sys.executable, tetgen=tetgen)
    script.write_text(text)
    script.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")


def make(folder: Path, good: int, bad: int = 1) -> dict[str, str]:
    """Write ``good`` sound surfaces and ``bad`` of each broken kind; gives how each file's cause must begin."""
    folder.mkdir(parents=True)
    causes: dict[str, str] = {}
    for k in range(good):
        causes[f"good{k:02}.ply"] = ""
        wct.write(folder / f"good{k:02}.ply", sphere_surface(20 + k % 20))
    kinds = {
        "crashing": (CRASHING, "stage 2 of 3 (filters.generate_tetrahedralization): TetGen failed in"),
        "hanging": (HANGING, "was stopped after "),
        "greedy": (GREEDY, "was stopped when it used "),
    }
    for k in range(bad):
        for kind, (points, cause) in kinds.items():
            causes[f"{kind}{k}.ply"] = cause
            wct.write(folder / f"{kind}{k}.ply", sphere_surface(points))
        causes[f"corrupt{k}.ply"] = "cannot be read as PLY"
        (folder / f"corrupt{k}.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 9")
    (folder / "chain.json").write_text(json.dumps(CHAIN))
    return causes
