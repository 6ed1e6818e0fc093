"""The ready-made pipelines that go through MeshLab and TetGen."""

import json

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from support.builders import sphere_surface, two_region_cube

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.measure import quality
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline import presets
from wct_plugin.pipeline.json_schema import schema
from wct_plugin.pipeline.pipeline import Pipeline


@pytest.mark.parametrize("name", presets.names())
def test_every_ready_made_pipeline_is_valid(name):
    content = json.loads(presets.read(name))
    Draft202012Validator(schema()).validate(content)
    pipeline = Pipeline.from_json(content)
    pipeline.check([TetMesh, SurfaceMesh])
    assert pipeline.is_open
    assert Pipeline.from_json(pipeline.to_json()).to_json() == pipeline.to_json()


def test_repair_ftetwild_mends_what_it_is_given(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ball = sphere_surface(200)
    soup = SurfaceMesh(ball.points[ball.triangles].reshape(-1, 3), np.arange(3 * len(ball.triangles)).reshape(-1, 3))
    wct.write("soup.ply", SurfaceMesh(soup.points, soup.triangles[1:]))  # every corner its own point, and a hole
    settings = ["edge_length=0.2", "epsilon=0.01", "stop_energy=50"]
    sets = [part for one in settings for part in ("--set", f"filters.generate_tetrahedralization.{one}")]
    sets += ["--set", "filters.meshing_well_centered.tolerance=0.03", "--set", "filters.meshing_well_centered.goal=3wc"]
    code = main.run(["run", "repair-ftetwild", "soup.ply", "ball.vtu", "ball.html", *sets, "--metadata", "m.json"])
    stages = json.loads((tmp_path / "m.json").read_text())["stages"]
    repaired = [stage["mesh"] for stage in stages if stage.get("tag")]
    assert repaired == [f"{count} triangles, 200 points" for count in (395, 395, 396)]
    mesh = wct.read("ball.vtu")
    measured = quality.measure(mesh)
    assert code == (0 if measured.well_centered_3.all() else 1)
    assert measured.volume.sum() == pytest.approx(4.0 / 3.0 * np.pi, rel=0.1)
    assert stages[-1]["type"] == "writers.report"
    assert next(s for s in stages if s["type"] == "filters.get_quality")["metrics"]["tets"] == len(mesh.tets)
    assert "ball.vtu" in (tmp_path / "ball.html").read_text()


def test_tetgen_regions_keeps_the_two_sides_of_a_wall(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    two = two_region_cube(2)
    wct.write("walls.ply", SurfaceMesh(two.points, np.vstack([two.topology.boundary, two.topology.interfaces])))
    sets = ["--set", "filters.meshing_well_centered.goal=3wc"]
    sets += ["--set", "filters.generate_tetrahedralization.edge_length=0.3"]
    assert main.run(["run", "tetgen-regions", "walls.ply", "out.vtu", *sets]) == 0
    mesh = wct.read("out.vtu")
    volumes = quality.measure(mesh).volume
    assert len(np.unique(mesh.regions)) == 2
    halves = [volumes[mesh.regions == region].sum() for region in np.unique(mesh.regions)]
    assert halves == pytest.approx([0.5, 0.5], abs=1e-3)  # the wall may move by the tolerance
