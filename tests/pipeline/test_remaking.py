"""The command on a page makes the same mesh again."""

import re
import shlex
from html import unescape

import numpy as np
import pytest
from support.builders import bcc, jittered_cube

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.pipeline.flow import Flow
from wct_plugin.pipeline.readers_writers import ReadMesh
from wct_plugin.pipeline.remaking import remaking
from wct_plugin.pipeline.stage import find_filter


def said(page):
    """What a page says makes the mesh again."""
    return unescape(re.search(r"<pre><code>(.*?)</code></pre>", page.read_text(encoding="utf-8"), re.DOTALL)[1])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--goal", "3wc", "--local-tolerance", "false"], "--goal 3wc --local-tolerance false"),
        (["--force", "--boundary", "*=fixed", "--seed", "3"], "--boundary '*=fixed' --seed 3 --force"),
        (["--filter", "apply_coord_well_centering", "--margin", "0.1"], "apply_coord_well_centering --margin 0.1"),
        (["--repair", "--input-format", "vtu"], "--repair"),
    ],
)  # fmt: skip
def test_the_command_on_the_page_makes_the_mesh_again(tmp_path, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    wct.write("the cube.vtu", jittered_cube(1 if "*=fixed" in options else 4))  # what takes no time
    folder = tmp_path / "made"
    folder.mkdir()
    main.run(["optimize", str(tmp_path / "the cube.vtu"), str(folder / "out.vtu"), "--html", "page.html", *options])
    command = said(tmp_path / "page.html")
    assert command.startswith("wct optimize 'the cube.vtu' out.vtu ")
    assert words in command
    main.run(shlex.split(command)[1:])
    once, again = wct.read(folder / "out.vtu"), wct.read(tmp_path / "out.vtu")
    assert (once.points == again.points).all()
    assert (once.tets == again.tets).all()


def test_regions_are_read_again(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mesh = bcc(2)
    halves = np.arange(len(mesh.tets)) % 2
    wct.write("halves.vtu", wct.TetMesh(mesh.points, mesh.tets, cell_data={"half": halves}))
    main.run(["optimize", "halves.vtu", "out.vtu", "--html", "page.html", "--regions", "half"])
    assert said(tmp_path / "page.html") == "wct optimize halves.vtu out.vtu --regions half"


def test_other_chains_are_pipelines(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    steps = wct.Filter.create_cube(variant="84") | wct.Filter.compute_power_weights()
    (steps | wct.Writer("out.vtu") | wct.Writer("page.html")).execute()
    command = said(tmp_path / "page.html")
    assert command.startswith("wct run - <<'END'\n[\n")
    assert '{"type": "filters.create_cube", "variant": "84"},' in command
    (tmp_path / "again.json").write_text(command.split("'END'\n")[1].removesuffix("END"))
    (tmp_path / "out.vtu").unlink()
    assert main.run(["run", "again.json"]) == 0
    assert len(wct.read("out.vtu").tets) == 84


def test_what_is_only_in_memory_has_no_command():
    mesh = bcc(2)
    flow = Flow.of(ReadMesh(filename=mesh), mesh, 0.0)
    assert remaking(flow.through(find_filter("meshing_well_centered")(), mesh, {})) == ""
