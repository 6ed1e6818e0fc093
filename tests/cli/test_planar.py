"""Triangles in a plane: reported by their acute share, and not optimised."""

import json
from pathlib import Path

import meshio
import numpy as np
import pytest
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.measure import planar

FLAT = Path(__file__).parents[1] / "data/flat.msh"


def acute_by_angles(points, triangles):
    corners = points[triangles]
    sides = [corners[:, (k + 1) % 3] - corners[:, k] for k in range(3)]
    dots = [-np.einsum("kx,kx->k", sides[k - 1], sides[k]) for k in range(3)]
    return int((np.array(dots) > 0).all(axis=0).sum())


def test_the_report_says_how_many_are_acute(tmp_path, capsys):
    given = meshio.read(FLAT)
    triangles = given.cells_dict["triangle"]
    assert main.run(["report", str(FLAT), "--json", str(tmp_path / "a.json")]) == 0
    printed = " ".join(capsys.readouterr().out.split())  # a line with a long path is broken where it fits
    assert f"2D, {len(triangles)} triangles, 98 points, 99.383 % acute" in printed
    assert "2D meshes are not optimised" in printed
    found = json.loads((tmp_path / "a.json").read_text())
    assert found["acute"]["count"] == acute_by_angles(given.points, triangles) == 161
    assert found["area"] == pytest.approx(1.0, rel=1e-12)
    assert found["dimension"] == 2
    assert found["angles"]["max"] == pytest.approx(94.39, abs=0.01)


def test_goals(capsys):
    assert main.run(["report", str(FLAT), "--goal", "cwc"]) == 1
    capsys.readouterr()
    assert "--goal delaunay is for tets" in refused_at_the_end(capsys, "report", FLAT, "--goal", "delaunay")
    assert "--html is for tets" in refused_at_the_end(capsys, "report", FLAT, "--html", "x.html")


def refused_at_the_end(capsys, *arguments):
    """The error, after the warning that the file's lines are left out."""
    assert main.run([str(argument) for argument in arguments]) == 2
    return capsys.readouterr().err.splitlines()[-1]


def test_beside_a_tet_mesh(tmp_path, capsys):
    cube, _ = wct.apply_filter("create_cube", variant="84")
    wct.write(tmp_path / "a.vtu", cube)
    assert main.run(["report", str(FLAT), str(tmp_path / "a.vtu"), "--json", str(tmp_path / "a.json")]) == 0
    assert [len(one) > 12 for one in json.loads((tmp_path / "a.json").read_text())] == [False, True]


def test_optimize_refuses_by_name(tmp_path, capsys):
    said = refused_at_the_end(capsys, "optimize", FLAT, tmp_path / "out.msh")
    assert "the surface is planar, so that it has no inside; 2D meshes are not optimised" in said
    assert str(FLAT) in said
    assert not list(tmp_path.iterdir())


def test_two_coordinates_and_any_plane(tmp_path):
    given = meshio.read(FLAT)
    meshio.xdmf.write(
        tmp_path / "a.xdmf", meshio.Mesh(given.points[:, :2], [("triangle", given.cells_dict["triangle"])])
    )
    surface = wct.read(tmp_path / "a.xdmf")
    assert planar.is_planar(surface)
    turn = np.linalg.qr(np.random.default_rng(0).random((3, 3)))[0]
    tilted = wct.SurfaceMesh((surface.points @ turn + 5).astype(np.float32) * 1e-9, surface.triangles)
    assert planar.is_planar(tilted)
    assert planar.measure(tilted).acute == 161
    bent = np.array(surface.points)
    bent[0, 2] += 1e-3
    assert not planar.is_planar(wct.SurfaceMesh(bent, surface.triangles))


def test_right_angles_are_counted_exactly():
    found = planar.measure(wct.SurfaceMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [3, 2, 1]]))
    assert (found.acute, found.right, found.triangles) == (0, 2, 2)


def test_a_curved_surface_is_still_one_that_needs_filling(tmp_path, capsys):
    cube, _ = wct.apply_filter("create_cube", variant="84")
    wct.write(tmp_path / "a.ply", cube.boundary_surface())
    assert "needs a tet mesh, here is a surface" in refused(capsys, "report", tmp_path / "a.ply")
