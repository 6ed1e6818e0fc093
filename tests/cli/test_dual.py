"""``wct dual``: what it prints, writes and refuses."""

from support.builders import kuhn_cube, sphere_surface
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main


def test_all_forms(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main.run(["create", "cube", "cube.vtu", "--variant", "84", "--quiet"]) == 0
    for target, *options in (("cells.vtu",), ("dec.npz",), ("case",), ("matrices", "--format", "matrix-market")):
        assert main.run(["dual", "cube.vtu", target, *options]) == 0
        out = capsys.readouterr().out
        cells = "35 cells, 148 faces between them, 180 on the boundary, volume 1"
        stars = "star0 of 35, star1 of 148, star2 of 198, star3 of 84"
        assert out == f"{target}: {cells if target in ('cells.vtu', 'case') else stars}\n"
    assert (tmp_path / "case/constant/polyMesh/boundary").exists()
    assert (tmp_path / "matrices/star1.mtx").exists()


def test_refusals(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wct.write("kuhn.vtu", kuhn_cube(2))
    wct.write("ball.ply", sphere_surface(30))
    assert refused(capsys, "dual", "kuhn.vtu", "cells.vtu").endswith("goal cwc of meshing_well_centered mends this")
    assert refused(capsys, "dual", "ball.ply", "cells.vtu").startswith("wct dual needs a tet mesh, here is a surface")
    assert refused(capsys, "dual", "none.vtu", "a.stl").startswith("a.stl: unknown suffix '.stl'")
    assert refused(capsys, "dual", "none.vtu", "a.vtu") == "none.vtu: there is no such file"
    assert {path.name for path in tmp_path.iterdir()} == {"kuhn.vtu", "ball.ply"}


def test_a_warning_of_stars_is_no_failure(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wct.write("kuhn.vtu", kuhn_cube(2))
    assert main.run(["dual", "kuhn.vtu", "dec.npz"]) == 0
    assert "entries of star1 are not positive" in capsys.readouterr().err
