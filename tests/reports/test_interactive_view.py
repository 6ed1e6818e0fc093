"""The 3D view of a report, in a browser with WebGL by software: what it shows, and that its controls change it."""

import json
import re
import zlib
from base64 import b64decode
from dataclasses import replace

import numpy as np
import pytest
from support.builders import bcc, shaken_cube, two_region_cube
from support.devtools import NO_GL, tab

from wct_plugin.measure.quality import measure
from wct_plugin.mesh import SurfaceMesh
from wct_plugin.reports import interactive_view, view_data
from wct_plugin.reports.html_report import html
from wct_plugin.reports.report import make_report

SHAKEN = shaken_cube(3)
BEFORE = replace(SHAKEN, regions=(SHAKEN.points[SHAKEN.tets].mean(axis=1)[:, 2] > SHAKEN.points[:, 2].mean()) + 1)
LATTICE = bcc(3)
AFTER = replace(LATTICE, points=LATTICE.points / 3.0, reference=BEFORE.boundary_surface())
QUALITY = measure(BEFORE)


def page(folder):
    text = html([make_report(BEFORE), make_report(AFTER)], "t", names=["before", "after"], meshes=[BEFORE, AFTER])
    place = folder / "page.html"
    place.write_text(text, encoding="utf-8")
    return place


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("view")
    with tab(folder) as found:
        found.open(page(folder), 900, 700)
        found.wait_for("document.getElementById('view').dataset.state")
        assert found.run("document.getElementById('view').dataset.state") == "drawn", found.said
        found.scroll_to(".stage")
        yield found


def turn(tab, **controls):
    """Set controls, the others as they were at the start."""
    start = {"colour": "height", "clip": "", "place": 500, "flip": False, "threshold": "", "limit": 500, "alone": False}
    settings = json.dumps({**start, "edges": True, **controls})
    tab.run(
        f"""(() => {{ for (const [name, value] of Object.entries({settings})) {{
        const one = document.querySelector(`[name="${{name}}"]`);
        if (one.type === "checkbox") one.checked = value; else one.value = value; }}
        document.querySelector(".controls").dispatchEvent(new Event("input")); }})()"""
    )


def look(tab, **controls):
    """The picture of the first mesh with these controls, once it is drawn."""
    turn(tab, **controls)
    return still(tab)


def still(tab, element=".stage"):
    """A picture that no longer changes."""
    found = tab.picture(element)
    for _ in range(50):
        tab.run("new Promise(done => requestAnimationFrame(() => setTimeout(done, 60)))")
        found, last = tab.picture(element), found
        if (found == last).all():
            return found
    raise AssertionError("it goes on changing")


def counts(tab):
    """How many tets of each mesh are shown."""
    lines = tab.run("[...document.querySelectorAll('.stages output')].map(one => one.textContent)")
    return [int(line.split()[0]) for line in lines]


def changed(one, other):
    """The share of the picture that is not the same."""
    return (np.abs(one.astype(int) - other).max(axis=2) > 24).mean()


def test_it_draws_from_disk_and_loads_nothing(shown):
    whole = look(shown)
    assert counts(shown) == [len(BEFORE.tets), len(AFTER.tets)]
    assert len(np.unique(whole.reshape(-1, 3), axis=0)) > 100
    assert all(url.startswith(("data:", "blob:null", "file:///")) for url in shown.asked)
    assert sum(url.startswith("file:") for url in shown.asked) == 1  # the page itself
    assert not [line for line in shown.said if not line.startswith("K3D: ")]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_cut_takes_what_is_on_one_side(shown, axis):
    whole, halves = look(shown), []
    assert changed(look(shown, clip=str(axis)), whole) > 0.03
    halves.append(counts(shown))
    turn(shown, clip=str(axis), flip=True)
    halves.append(counts(shown))
    assert np.sum(halves, axis=0).tolist() == [len(BEFORE.tets), len(AFTER.tets)]
    middle = BEFORE.points[BEFORE.tets].mean(axis=1)[:, axis]
    box = np.concatenate([BEFORE.points, AFTER.points])[:, axis]
    assert halves[0][0] in [(middle <= (box.min() + box.max()) / 2).sum(), (middle > (box.min() + box.max()) / 2).sum()]
    at = shown.run("document.querySelector('[for=place]').textContent")
    assert at.startswith("xyz"[axis])
    assert float(at.split(" = ")[1]) == pytest.approx((box.min() + box.max()) / 2, abs=1e-3)


def test_a_threshold_takes_the_tets_beyond_it(shown):
    whole = look(shown)
    assert changed(look(shown, threshold="height most", limit=300), whole) > 0.03
    limit = -1.0 + 0.3 * 4.0 / 3.0
    assert counts(shown)[0] == (QUALITY.min_height <= limit).sum()
    turn(shown, threshold="height least", limit=300)
    assert counts(shown)[0] == (QUALITY.min_height > limit).sum()
    turn(shown, threshold="angle least", limit=500)
    assert counts(shown)[0] == (QUALITY.max_face_angle > 120.0).sum()
    turn(shown, threshold="angle most", limit=500)
    assert counts(shown)[0] == (QUALITY.max_face_angle <= 120.0).sum()


def test_bad_tets_alone(shown):
    whole = look(shown)
    assert changed(look(shown, alone=True), whole) > 0.03
    assert counts(shown) == [int((~QUALITY.completely_well_centered).sum()), 0]


def test_colours_are_told_apart(shown):
    pictures = {name: look(shown, colour=name) for name in ("height", "angle", "deviation", "region")}
    names = list(pictures)
    for k, name in enumerate(names):
        assert all(changed(pictures[name], pictures[other]) > 0.02 for other in names[:k])
    legend = shown.run("document.querySelector('.legend').textContent")
    assert legend == "region 0region 1region 2"
    assert changed(look(shown, colour="region", edges=False), pictures["region"]) > 0.01


def test_both_meshes_turn_and_come_back_together(shown):
    whole = look(shown)
    second = still(shown, "figure:nth-of-type(2) > .stage")
    shown.drag(".stage", 120, 30)
    assert changed(still(shown), whole) > 0.03
    assert changed(still(shown, "figure:nth-of-type(2) > .stage"), second) > 0.03
    shown.run("document.querySelector('[name=home]').click()")
    assert changed(still(shown), whole) < 0.01
    assert changed(still(shown, "figure:nth-of-type(2) > .stage"), second) < 0.01


def test_it_fits_a_phone(shown, tmp_path):
    shown.open(page(tmp_path), 375)
    shown.wait_for("document.getElementById('view').dataset.state")
    assert shown.run("document.documentElement.scrollWidth") == 375
    assert shown.run("document.querySelector('.stage canvas').clientWidth") > 300


def test_without_webgl_the_pictures_stay(tmp_path):
    with tab(tmp_path, NO_GL) as found:
        found.open(page(tmp_path))
        found.wait_for("document.getElementById('view').dataset.state")
        assert found.run("document.getElementById('view').dataset.state") == "stills"
        assert "WebGL" in found.run("document.querySelector('.off').innerText")
        assert found.run("document.querySelector('.stages').offsetHeight") == 0
        assert found.run("document.images.length") > 4


def test_without_the_extra_the_page_says_what_to_install(monkeypatch):
    monkeypatch.setattr(interactive_view, "library", lambda: None)
    text = html([make_report(AFTER)], "t", meshes=[AFTER])
    assert "pip install &#x27;.[view]&#x27; in a clone" in text
    assert "<script" not in text
    assert "data:image/png" in text


def unpacked(found):
    """The arrays of a mesh as the page's script takes them apart."""
    data, out, at = zlib.decompress(b64decode(found.text)), {}, 0
    for name, kind, count in found.about["arrays"]:
        out[name] = np.frombuffer(data, f"<{kind}", count, at)
        at += out[name].nbytes
    assert at == len(data)
    return out


def test_numbers_come_through():
    scales = {name: view_data.Scale(*ends) for name, ends in {"height": (-1.0, 1.0), "angle": (60.0, 180.0)}.items()}
    found = view_data.pack(BEFORE, view_data.Frame.of([BEFORE]), scales, np.array([0, 1, 2]), None)
    arrays = unpacked(found)
    assert not found.note
    assert (arrays["tets"].reshape(-1, 4) == BEFORE.tets).all()
    assert np.abs(arrays["height"] / 65534 * 2 - 1 - QUALITY.min_height).max() < 1e-4
    assert np.abs(arrays["angle"] / 65534 * 120 + 60 - QUALITY.max_face_angle).max() < 2e-3
    assert ((arrays["flags"] & 3 == 0) == QUALITY.completely_well_centered).all()
    assert (arrays["region"] == BEFORE.regions).all()
    skin = [bin(flags >> 2).count("1") for flags in arrays["flags"]]
    assert sum(skin) == len(BEFORE.topology.boundary)


def test_inner_tets_are_thinned_and_the_page_says_so(monkeypatch):
    monkeypatch.setattr(view_data, "MOST_INNER", 10)
    mesh = bcc(4)
    text = html([make_report(mesh)], "t", meshes=[mesh])
    inner = len(mesh.tets) - len(np.unique(mesh.topology.boundary_half_facets[:, 0]))
    assert f"In the page are 10 of {inner} good tets inside, those nearest to the middle planes." in text
    about = json.loads(re.search(r'id="view-settings">(.*?)</script>', text)[1])["meshes"][0]
    assert about["tets"] == len(mesh.tets)
    assert {name: count for name, _, count in about["arrays"]}["flags"] == len(mesh.tets) - inner + 10
    monkeypatch.setattr(view_data, "MOST", len(mesh.tets) - inner + 3)
    bad = shaken_cube(4)
    kind = np.full(len(bad.tets), 2)
    rows, note = view_data.chosen(bad, kind, np.arange(len(bad.tets), dtype=float))
    assert "bad tets inside, the worst" in note
    assert len(rows) < len(bad.tets)


def test_a_boundary_that_is_too_large_has_no_view(monkeypatch):
    monkeypatch.setattr(interactive_view, "MOST", 10)
    assert "more than 10 triangles" in interactive_view.view(["a"], [AFTER], None).html


def test_deviation_is_that_of_the_reference():
    from wct_plugin.reports.boundary_deviation import deviation_of_facets

    cube = two_region_cube(2)
    surface = cube.boundary_surface()
    assert deviation_of_facets(cube, surface).max() < 1e-12
    moved = SurfaceMesh(surface.points + np.array([0.1, 0.0, 0.0]), surface.triangles)
    found = deviation_of_facets(cube, moved) * surface.diagonal
    assert found.max() == pytest.approx(0.1)
    assert len(found) == len(cube.topology.boundary)
