"""Names of files, and names in files, do nothing to a terminal, a page or a spreadsheet."""

import csv
import os
import re
import shutil
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import pytest
from support.builders import jittered_cube

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.reports.printable import cell, printable

ACTING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
VIEW = files("wct_plugin.reports").joinpath("view.js").read_text("utf-8")
#: What the 3D view has of scripts in a page: what it reads, in which nothing ends the element, and what it runs.
OURS = re.compile(rf'<script type="text/plain" id="view-[\w-]+">[^<]*</script>|<script>{re.escape(VIEW)}</script>')
NAMES = [
    b"\x1b]0;owned\x07\x1b[31mred.vtu",
    "\x9b31m.vtu".encode(),
    "\u202egnp.vtu".encode(),
    b"\xff\xfe.vtu",
    b"[bold]x[link=a].vtu",
    b"=cmd|calc!A0.vtu",
    b"+1.vtu",
    b"@SUM(1).vtu",
    b"<script>alert(1)<script>.vtu",
    b":smile: $x^$.vtu",
    b"a\nb\r.vtu",
]


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    hostile = "\x1b[31m<b>[/x]=1\u202e"
    mesh = jittered_cube(2, 0)
    wct.write("a.msh", replace(mesh, names={hostile: (1, 3)}, point_data={hostile: mesh.points[:, 0]}))
    with pytest.warns(wct.WctWarning, match=r"VTU cannot carry, so dropped: point data '.x1b"):  # no XML has such names
        wct.write("a.vtu", wct.read("a.msh"))
    for name in NAMES:
        shutil.copy("a.vtu", os.fsdecode(name))
    return tmp_path


@pytest.mark.parametrize("name", NAMES)
def test_reports(name: bytes, place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = f"./{os.fsdecode(name)}"
    for arguments in (
        ["report", given, "a.vtu", "--html", "out.html", "--json", "out.json"],
        ["optimize", "a.msh", "out.inp", "--goal", "delaunay", "--html", "out.html"],
        ["report", f"{given}.vtk"],
    ):
        assert main.run(arguments) in (0, 1, 2)
        printed = capsys.readouterr()
        assert not ACTING.search(printed.out + printed.err)
        assert "internal error" not in printed.err
        if "out.html" in arguments:
            page = Path("out.html").read_text("utf-8")
            assert not ACTING.search(page)
            page = OURS.sub("", page)
            assert "<script" not in page
            assert "<b>" not in page
    assert not ACTING.search(Path("out.json").read_text())


def test_markup_stays_as_it_is(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (place / "[bold][").mkdir()
    shutil.copy("a.vtu", "[bold][/red]:smile:.vtu")
    assert main.run(["optimize", "[bold][/red]:smile:.vtu", "out.vtu", "--goal", "delaunay"]) == 0
    assert "[bold][/red]:smile:.vtu -> out.vtu" in capsys.readouterr().out


def test_batches(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (place / "chain.json").write_text('[{"type": "filters.get_quality"}]')
    assert main.run(["batch", "chain.json", "*.vtu", "-o", "out", "--jobs", "2"]) in (0, 1)
    printed = capsys.readouterr()
    assert not ACTING.search(printed.out + printed.err)
    assert printed.err.count("[12/12]") == 1
    for name in ("manifest.jsonl", "summary.csv", "summary.html"):
        assert not ACTING.search((place / "out" / name).read_text("utf-8"))
    with (place / "out/summary.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    assert len(rows) == 1 + len(NAMES) + 1
    assert not [one for row in rows for one in row if one.startswith(("=", "+", "@"))]
    assert "'=cmd|calc!A0.vtu" in [row[0] for row in rows]


def test_texts() -> None:
    assert printable("a\tb\nc é 中 😀") == "a\tb\nc é 中 😀"
    assert printable("\x1b[31m\x07\x9b\u202e\udcff") == "�[31m����"
    assert [cell(one) for one in ("=1", " -1", "@a", "+a", "\ta", "a=1", "", -1.5, None)] == [
        "'=1",
        "' -1",
        "'@a",
        "'+a",
        "'\ta",
        "a=1",
        "",
        -1.5,
        None,
    ]
