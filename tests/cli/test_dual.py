"""``wct dual``: what it prints, writes and refuses."""

from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
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
    assert "a folder, of OpenFOAM or with format matrix-market" in refused(capsys, "dual", "kuhn.vtu", "a.mtx")
    for target in ("-", ""):
        assert (
            refused(capsys, "dual", "kuhn.vtu", target)
            == f"{target!r} is no name of a file or folder, which a dual needs"
        )
    assert refused(capsys, "dual", "kuhn.vtu", "./kuhn.vtu") == (
        "'./kuhn.vtu' is given twice; an output needs a name of its own"
    )
    assert {path.name for path in tmp_path.iterdir()} == {"kuhn.vtu", "ball.ply"}


def test_a_warning_of_stars_is_no_failure(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wct.write("kuhn.vtu", kuhn_cube(2))
    assert main.run(["dual", "kuhn.vtu", "dec.npz"]) == 0
    assert "entries of star1 are not positive" in capsys.readouterr().err


def test_regions_and_standard_input(tmp_path, capsys, monkeypatch):
    """The regions of an array are cells of their own: each has its volume, here of two cubes of tets by their sides."""
    monkeypatch.chdir(tmp_path)
    mesh, _ = wct.apply_filter("create_cube", variant="84")
    grid = wct.to_pyvista(mesh)
    half = grid.cell_centers().points[:, 0] > 0.5
    grid["zone"] = half.astype(int)
    grid.save("cube.vtu")
    volumes = np.asarray(grid.compute_cell_sizes()["Volume"])
    with Path("cube.vtu").open() as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        assert main.run(["dual", "-", "cells.vtu", "--input-format", "vtu", "--regions", "zone"]) == 0
    assert capsys.readouterr().out.startswith("cells.vtu: 50 cells, ")
    cells = pv.read("cells.vtu")
    for tag in (0, 1):
        of = volumes[: len(mesh.tets)][half[: len(mesh.tets)] == tag].sum()
        assert cells["volume"][cells["region"] == tag].sum() == pytest.approx(of, rel=1e-12)
