"""What ``wct`` says where a neighbour cannot do what it is asked: one line, exit code 2, nothing left behind."""

import json
import tempfile
import time

import numpy as np
import pytest
from support.builders import jittered_cube, kuhn_cube, sphere_surface
from support.processes import wait_until, working_in
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.adapters import child_process
from wct_plugin.cli import main
from wct_plugin.mesh import SurfaceMesh

CUBE = kuhn_cube(1).boundary_surface()
BALL = sphere_surface(60)
FILL = {"type": "filters.generate_tetrahedralization", "mesher": "tetgen"}
REPAIR = [
    {"type": "filters.meshlab", "filter": name}
    for name in (
        "meshing_remove_duplicate_vertices",
        "meshing_remove_duplicate_faces",
        "meshing_remove_null_faces",
        "meshing_remove_unreferenced_vertices",
        "meshing_close_holes",
    )
]


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A working directory, and beside it one for temporary files, that must both be as they were."""
    scratch, home = tmp_path / "scratch", tmp_path / "home"
    scratch.mkdir()
    home.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    monkeypatch.chdir(home)
    wct.write("ball.ply", BALL)
    wct.write("cube.vtu", jittered_cube(4, 0))
    return home


def refused_cleanly(place, capsys, *arguments):
    before = sorted(place.iterdir())
    said = refused(capsys, *arguments)
    assert sorted(place.iterdir()) == before
    wait_until(lambda: not working_in(place.parent / "scratch"), 2)
    assert list((place.parent / "scratch").iterdir()) == []
    return said


BAD_SURFACES = {
    "the surface encloses nothing, it is open: the edge from": SurfaceMesh(CUBE.points, CUBE.triangles[1:]),
    "the surface intersects itself: triangle": SurfaceMesh(
        np.vstack([CUBE.points, CUBE.points + 0.5]), np.vstack([CUBE.triangles, CUBE.triangles + len(CUBE.points)])
    ),
    "triangle 12 repeats triangle 3": SurfaceMesh(CUBE.points, np.vstack([CUBE.triangles, CUBE.triangles[3:4]])),
    "the surface is planar": SurfaceMesh(CUBE.points * [1, 1, 0], CUBE.triangles[:2]),
}


@pytest.mark.parametrize("reason", BAD_SURFACES)
def test_surfaces_that_tetgen_cannot_fill(reason, place, capsys):
    wct.write("bad.ply", BAD_SURFACES[reason])
    (place / "chain.json").write_text(json.dumps(["bad.ply", FILL, "out.vtu"]))
    for arguments, who in (
        (["optimize", "bad.ply", "out.vtu", "--mesher", "tetgen"], "filters.generate_tetrahedralization"),
        (["run", "chain.json"], "stage 2 of 3 (filters.generate_tetrahedralization)"),
    ):
        assert refused_cleanly(place, capsys, *arguments).startswith(f"{who}: bad.ply: {reason}")


def test_a_hang_of_tetgen_is_ended_with_its_children(place, capsys):
    endless = {**FILL, "radius_edge": 1.0, "min_dihedral": 60, "timeout": 1}
    (place / "chain.json").write_text(json.dumps(["ball.ply", endless, "out.vtu"]))
    start = time.monotonic()
    said = refused_cleanly(place, capsys, "run", "chain.json")
    assert said.startswith("stage 2 of 3 (filters.generate_tetrahedralization): TetGen was stopped after ")
    assert time.monotonic() - start < 15


@pytest.mark.parametrize(
    ("script", "reason"),
    [
        (None, "no.mlx: No such file or directory"),
        ("garbage", "is not XML: syntax error: line 1, column 0"),
        ('<FilterScript><filter name="Close Hoels"/></FilterScript>', "filter 1 ('Close Hoels'): MeshLab has no such"),
        (
            '<FilterScript><filter name="Close Holes"><Param name="MaxHoleSise" value="3"/></filter></FilterScript>',
            "filter 1 ('Close Holes'): argument 'MaxHoleSise' is unknown; did you mean 'maxholesize'?",
        ),
    ],
)
def test_scripts_of_meshlab(script, reason, place, capsys):
    if script:
        (place / "a.mlx").write_text(script)
    stage = {"type": "filters.meshlab", "script": "a.mlx" if script else "no.mlx"}
    (place / "chain.json").write_text(json.dumps(["ball.ply", stage, "out.ply"]))
    for mode in ([], ["--validate"]):
        said = refused_cleanly(place, capsys, "run", "chain.json", *mode)
        assert reason in said
        assert "stage 2 of 3 (filters.meshlab)" in said


@pytest.mark.parametrize(
    ("stages", "reason"),
    [
        (["ball.ply", {"type": "filters.meshlap", "filter": "a"}, "o.ply"], "unknown stage 'filters.meshlap'; did you"),
        (["ball.ply", {**FILL, "radius_egde": 2}, "o.vtu"], "unknown option 'radius_egde'; did you mean 'radius_edge'"),
        (["ball.ply", {**FILL, "mesher": "tetgn"}, "o.vtu"], "option 'mesher' is 'tetgn'; input should be 'ftetwild'"),
        (["bal.ply", FILL, "o.vtu"], "bal.ply: no such file"),
        (["ball.ply", FILL, "o.vtx"], "o.vtx: unknown suffix '.vtx'"),
        (
            ["ball.ply", {**REPAIR[0], "inputs": "b", "tag": "a"}, {**REPAIR[1], "inputs": "a", "tag": "b"}, "o.ply"],
            "cycle: ",
        ),
        (["cube.vtu", FILL, "o.vtu"], "needs a surface, here is a tet mesh"),
        (["ball.ply", FILL, REPAIR[0], "o.ply"], "needs a surface, here is a tet mesh; put filters.generate_boundary"),
        (["ball.ply", FILL, "o.stl"], "STL cannot carry a tetrahedral mesh"),
        (["ball.ply", {"type": "filters.meshlab", "filter": "meshing_close_hols"}, "o.ply"], "MeshLab has no such fil"),
    ],
)
def test_pipelines_through_neighbours_are_refused_before_any_runs(stages, reason, place, capsys, monkeypatch):
    (place / "chain.json").write_text(json.dumps(stages))
    monkeypatch.setattr("wct_plugin.adapters.tetgen.tetrahedralize", None)
    monkeypatch.setattr("wct_plugin.adapters.meshlab.run.run", None)
    for mode in ([], ["--validate"]):
        said = refused_cleanly(place, capsys, "run", "chain.json", *mode)
        assert reason in said


def test_meshlab_is_asked_once_for_all_stages(place, capsys, monkeypatch):
    started = []

    def counted(*arguments, **options):
        started.append(arguments)
        return run(*arguments, **options)

    run = child_process.run
    monkeypatch.setattr(child_process, "run", counted)
    (place / "chain.json").write_text(json.dumps(["ball.ply", *REPAIR, "out.ply"]))
    assert main.run(["run", "chain.json", "--validate"]) == 0
    assert len(started) == 1
    capsys.readouterr()
    wrong = {**REPAIR[-1], "arguments": {"maxholesise": 30}}
    (place / "chain.json").write_text(json.dumps(["ball.ply", *REPAIR[:-1], wrong, REPAIR[0], "out.ply"]))
    said = refused_cleanly(place, capsys, "run", "chain.json")
    assert said.startswith(
        "stage 6 of 8 (filters.meshlab): (meshing_close_holes): argument 'maxholesise' is unknown; did you mean"
    )
    assert len(started) == 2
