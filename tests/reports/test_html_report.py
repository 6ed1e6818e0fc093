"""The report's HTML page: what it says, that it is whole by itself, and how a browser lays it out."""

import re
import sys
from base64 import b64encode
from dataclasses import replace
from hashlib import sha256
from html.parser import HTMLParser
from itertools import pairwise

import numpy as np
import pytest
from support.browser import SCREENS, laid_out
from support.builders import ball, bcc, jittered_cube, shaken_cube, single, two_region_cube

import wct_plugin as wct
from wct_plugin.errors import WctError
from wct_plugin.measure.quality import measure
from wct_plugin.mesh.strata import find_strata
from wct_plugin.obstructions.remaining_tets import list_remaining
from wct_plugin.pipeline.flow import Flow
from wct_plugin.pipeline.readers_writers import ReadMesh
from wct_plugin.pipeline.remaking import provenance, remaking
from wct_plugin.pipeline.stage import find_filter
from wct_plugin.reports import interactive_view
from wct_plugin.reports.html_report import html
from wct_plugin.reports.report import BINS, make_report

NASTY = "/data/<img src=x onerror=parent.ran=1>&amp;\"'$x$_a_name_without_end_or_a_place_to_break_it.vtu"
BEFORE = replace(jittered_cube(3), source=NASTY)
AFTER = replace(bcc(2), source="/data/out.vtu")


def left_in(mesh):
    """A report that says what is left."""
    left = list_remaining(
        mesh, find_strata(mesh), measure(mesh), goal="cwc", boundary="fixed", crease_angle=40.0, stopped=False
    )
    volumes = {tag: {"before": 1.0, "after": 1.1, "change": 0.1} for tag in "12"}
    return make_report(mesh, found={"remaining": left, "volumes": volumes, "interfaces": {"1|2": None}})


def made(mesh):
    """How a mesh was made, with options of every kind."""
    read = Flow.of(ReadMesh(filename=NASTY), mesh, 0.25)
    flow = read.through(find_filter("meshing_well_centered")(boundary="keep"), mesh, {}, 1.25)
    return provenance(flow) | {"again": remaking(flow)}


class Page(HTMLParser):
    """Checks that tags balance; collects text, attributes, headings and tables."""

    def __init__(self, text):
        super().__init__()
        self.open, self.text, self.attributes, self.tags = [], [], [], []
        self.feed(re.sub(r'<wbr>|<span class="long">(.*?)</span>', r"\1", text))  # places where words may break
        self.close()
        assert self.open == []
        self.shown = " ".join(" ".join(self.text).split())

    def handle_starttag(self, tag, attrs):
        self.attributes += [(tag, *pair) for pair in attrs]
        self.tags.append((tag, dict(attrs)))
        if tag not in ("meta", "br", "img", "input", "wbr"):
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.attributes += [(tag, *pair) for pair in attrs]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1:] not in (["style"], ["script"]):
            self.text.append(data)


def test_page_is_whole_and_needs_nothing_else():
    reports = [make_report(BEFORE, worst=3), make_report(AFTER, worst=2)]
    text = whole = html(reports, "a <b> & c", meshes=[BEFORE, AFTER], made=made(BEFORE))
    page = Page(text)
    assert "a <b> & c" in page.shown
    assert "<b>" not in text
    code = interactive_view.view(["a"], [AFTER], None).script.code
    scripts = re.findall(r"<script([^>]*)>(.*?)</script>", text, re.DOTALL)
    assert [script for kind, script in scripts if "text/plain" not in kind] == [code]
    assert [kind for kind, _ in scripts if "text/plain" in kind] == [
        f' type="text/plain" id="view-{name}"' for name in ("library", "settings", "mesh-0", "mesh-1")
    ]
    text = re.sub(r"<script.*?</script>", "", text, flags=re.DOTALL)
    assert "1: <img src=x onerror=parent.ran=1>&amp;" in page.shown
    assert "2: out.vtu" in page.shown
    assert "data/" not in re.sub(r"data:image/png;base64,[^\"]*", "", text)  # names only, no folders
    for expected in ("3WC", "one-sided", "100 %", "0.316", "Where the bad tets are", "corner", "min", "not CWC"):
        assert expected in page.shown
    for tag, name, value in page.attributes:
        if name in ("src", "href", "srcset", "action", "data"):
            assert (tag, name) == ("img", "src")
            assert value.startswith("data:image/png;base64,")
        assert name[:2] != "on"
    assert not re.search(r"url\((?!#)|@import|<link|https?://", text)
    policy = next(attrs["content"] for _, attrs in page.tags if attrs.get("http-equiv") == "Content-Security-Policy")
    digest = b64encode(sha256(code.encode()).digest()).decode()
    assert policy == (
        "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
        f"; script-src 'sha256-{digest}' blob:; font-src data:"
    )
    assert whole == html(reports, "a <b> & c", meshes=[BEFORE, AFTER], made=made(BEFORE))  # the same in, the same out


def test_page_without_meshes_runs_nothing():
    page = Page(html([make_report(AFTER)], "t"))
    assert "script" not in {tag for tag, _ in page.tags}
    policy = next(attrs["content"] for _, attrs in page.tags if attrs.get("http-equiv") == "Content-Security-Policy")
    assert policy == "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


def test_page_can_be_read_without_seeing_it():
    page = Page(html([left_in(BEFORE), make_report(AFTER)], "t", meshes=[BEFORE, AFTER], made=made(BEFORE)))
    levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch(r"h\d", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))
    tables = sum(tag == "table" for tag, _ in page.tags)
    assert sum(tag == "caption" for tag, _ in page.tags) == tables > 8
    assert {attrs.get("scope") for tag, attrs in page.tags if tag == "th"} == {"col", "row", "colgroup"}
    images = [attrs for tag, attrs in page.tags if tag == "img"]
    assert len(images) == 6  # from two sides: both boundaries, the inside of the one that has bad tets
    bad = int((~measure(BEFORE).well_centered_3).sum())
    assert sum(f"{bad} tets do not contain" in attrs["alt"] for attrs in images) == 2
    assert all(attrs.get("aria-label") for tag, attrs in page.tags if tag == "svg")
    ids = [value for _, name, value in page.attributes if name == "id"]
    assert len(ids) == len(set(ids))


def test_the_answer_stands_first():
    page = Page(html([make_report(AFTER)], "t")).shown
    assert page.startswith("t t All 48 tets contain their circumcenter, and all their triangles are acute.")
    assert "Boundary to reference not measured" in page
    kept = replace(make_report(AFTER), deviation={"fraction_of_diagonal": 9.87e-4}, tolerance=1e-3)
    assert "Boundary kept 9.87e-4 of the diagonal" in Page(html([kept], "t")).shown
    assert "within the tolerance of 1.00e-3" in Page(html([kept], "t")).shown
    moved = replace(kept, tolerance=5e-4)
    assert "Boundary not kept 9.87e-4" in Page(html([moved], "t")).shown
    assert "beyond the tolerance of 5.00e-4" in Page(html([moved], "t")).shown
    left = left_in(BEFORE)
    page = Page(html([make_report(AFTER), left], "t", names=["before", "after"], made=made(BEFORE))).shown
    assert left.notes[-1] in page
    count, outside = left.remaining["count"], left.tets - left.flags["3wc"]
    assert page.index(f"{outside} of {left.tets} tets do not") < page.index(f"Miss the goal {count} tets")
    assert "before: 100.000 %" in page.replace("\N{NO-BREAK SPACE}", " ")
    assert "boundary=keep or move" in page
    assert "meshing_well_centered 1.25 s" in page
    assert "boundary keep given" in page
    assert "goal cwc default" in page
    assert "numpy " + np.__version__ in page


def test_what_is_left_is_counted_by_what_would_free_it():
    mesh = jittered_cube(5, 1)
    report = left_in(mesh)
    page = Page(html([report], "t"))
    rows = re.findall(r"(interior|patch|crease|corner) (\d+) ((?:[23]WC(?:, )?)+) (?!-|\d)", page.shown)
    assert sum(int(count) for _, count, _ in rows) == report.remaining["count"] > 100
    assert "The next 90" in page.shown


@pytest.mark.parametrize("meshes", [[BEFORE], [BEFORE, AFTER, ball(3)]])
def test_histograms_count_every_tet_once(meshes):
    reports = [make_report(mesh) for mesh in meshes]
    text = html(reports, "t")
    for name, bins in BINS.items():
        kind = "angles" if name == "dihedral_angle" else "tets"
        assert reports[0].histograms[name].sum() == len(meshes[0].tets) * (6 if kind == "angles" else 1)
        assert len(bins) == len(reports[0].histograms[name]) + 1
    drawn = re.findall(r"<title>[^<:]*: (\d+) (tets|angles) \(", text)
    total = sum(report.tets for report in reports)
    assert sum(int(count) for count, kind in drawn if kind == "tets") == 3 * total
    assert sum(int(count) for count, kind in drawn if kind == "angles") == 6 * total


def test_flat_tets_count_too():
    flat = single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 1e-9]])
    report = make_report(flat)
    assert [int(counts.sum()) for counts in report.histograms.values()] == [1, 1, 6, 1]
    assert report.histograms["R/l"][-1] == 1
    assert "2.95 or more: 1 tets" in html([report], "t", meshes=[flat])


def test_what_is_proven_stands_in_the_page():
    proven, open_ = (make_report(mesh, exact=True) for mesh in (AFTER, BEFORE))
    page = Page(html([proven, open_], "t")).shown
    assert "Exact certificate, 2: " in page
    for report in (proven, open_):
        assert report.certificate.headline() in page
        assert all(line in page for line in report.certificate.lines())
    assert "Exact certificate" not in Page(html([make_report(AFTER)], "t")).shown


@pytest.mark.parametrize("meshes", [[shaken_cube(3)], [shaken_cube(3), AFTER, ball(3)]])
def test_negative_duals_stand_in_the_page(meshes):
    reports = [make_report(mesh) for mesh in meshes]
    text = html(reports, "t")
    captions = ["Negative duals inside", "Negative duals on the boundary", "Duals that are zero"]
    shown = []
    for caption in captions if len(meshes) > 1 else ["Negative duals"]:
        table = next(part for part in text.split("<table") if f"<caption>{caption}</caption>" in part)
        rows = table.split("<tbody>")[1].split("</tr>")[:3]
        shown.append([re.findall(r"<t[hd][^>]*>([^<]*)</t[hd]>", row) for row in rows])
    for k, found in enumerate(zip(*(one.negative_duals.rows() for one in reports), strict=True)):
        names, *cells = zip(*found, strict=True)
        assert {table[k][0] for table in shown} == set(names)
        assert [cell for table in shown for cell in table[k][1:]] == [cell for column in cells for cell in column]
    assert reports[0].negative_duals.interior[2].negative > 10
    assert "Hodge stars" in Page(text).shown


def test_what_solvers_see_stands_in_the_page_by_region():
    one, two = make_report(shaken_cube(3)), make_report(two_region_cube(3))
    shown = Page(html([one, two], "t")).shown
    assert shown.count("What solvers see: ") == 1
    for cells in (*one.rows_summary(), *two.rows_summary(), *two.solver_view.rows()):
        assert all(cell in shown for cell in cells)


@pytest.mark.parametrize("count", [1, 3])
def test_any_number_of_reports(count):
    page = Page(html([make_report(bcc(2), worst=0) for _ in range(count)], "t"))
    heads = [data for data in page.text if re.fullmatch(r"\d: mesh", data)]
    assert {f"{k + 1}: mesh" for k in range(count)} == set(heads)
    assert "Worst tets" not in page.shown


def test_page_of_nothing_and_without_matplotlib(monkeypatch):
    with pytest.raises(ValueError, match="at least one"):
        html([], "t")
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(WctError, match=r"pip install '\.\[report\]' in a clone"):
        html([make_report(bcc(2))], "t")


# --- in a browser -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def screens(tmp_path_factory):
    """Every page on every screen."""
    left = jittered_cube(5, 1)
    pages = {
        "optimized": html(
            [make_report(BEFORE), left_in(left)], f"{NASTY} → out", names=["before", "after"], meshes=[BEFORE, left],
            made=made(left),
        ),
        "beside": html([make_report(mesh, exact=True) for mesh in (BEFORE, AFTER)], NASTY, meshes=[BEFORE, AFTER]),
        "many": html([make_report(replace(ball(3), source=f"{k}.vtu")) for k in range(4)], "four"),
    }  # fmt: skip
    return laid_out(pages, tmp_path_factory.mktemp("browser"))


@pytest.mark.parametrize("screen", SCREENS)
@pytest.mark.parametrize("page", ["optimized", "beside", "many"])
def test_nothing_is_cut_off_or_hard_to_read(screens, page, screen):
    found = screens[page, screen]
    assert found["client"] == SCREENS[screen][0]
    assert found["scroll"] <= found["client"]
    assert found["wide"] == []
    assert found["cut"] == []
    assert found["low"] == []  # text of less contrast than 4.5 to 1, WCAG's AA
    if page == "optimized":  # only tables of many meshes scroll by themselves
        assert found["scrolling"] == 0


def test_names_are_names_and_pictures_are_there(screens):
    for (page, screen), found in screens.items():
        assert not found["ran"]
        assert found["loaded"] == []
        assert (found["ground"] < 0.1) == (screen == "dark")
        assert all(width > 500 for width in found["pictures"])
        assert len(found["pictures"]) == {"optimized": 8, "beside": 6, "many": 0}[page]
    assert screens["beside", "phone"]["heading"] == NASTY


def test_a_page_without_style_is_seen_to_be_cut_off(tmp_path):
    """The measure itself: what it must find, it finds."""
    wide = '<!DOCTYPE html><h1>x</h1><p style="width:900px;color:#ccc">wide</p><svg width="50" height="20">'
    found = laid_out({"bad": wide + '<text x="40" y="15">cut off</text></svg>'}, tmp_path)["bad", "phone"]
    assert found["scroll"] > found["client"]
    assert len(found["wide"]) == 1
    assert len(found["low"]) == 1
    assert found["cut"] == ["cut off"]


def test_wct_report_writes_the_page(tmp_path, monkeypatch):
    from wct_plugin.cli import main

    monkeypatch.chdir(tmp_path)
    wct.write("a.vtu", BEFORE)
    wct.write("b.vtu", AFTER)
    assert main.run(["report", "a.vtu", "b.vtu", "--html", "both.html"]) == 0
    page = Page((tmp_path / "both.html").read_text())
    assert sum(tag == "img" for tag, _ in page.tags) == 6
    assert "1: a.vtu" in page.shown
