"""How meshes show themselves in notebooks and by pyvista."""

import sys

import numpy as np
import pytest
import pyvista as pv
from support.builders import bcc, two_region_cube

import wct_plugin as wct
from wct_plugin.errors import OptionError, WctError

CUBE = two_region_cube(2)


def test_a_notebook_shows_a_card():
    card = wct.TetMesh(
        CUBE.points, CUBE.tets, CUBE.regions, names={"<b>in</b>": (1, 3)}, source="a&b.msh"
    )._repr_html_()
    assert "<b>TetMesh a&amp;b.msh</b>" in card
    assert "&lt;b&gt;in&lt;/b&gt;" in card
    for said in ("points", str(len(CUBE.points)), "tets", str(len(CUBE.tets)), "regions", "0 … 1"):
        assert f">{said}" in card
    assert len(card) < 1500
    assert f">{len(CUBE.topology.boundary)}<" in CUBE.boundary_surface()._repr_html_()


@pytest.mark.parametrize(("mesh", "scalars"), [(CUBE, None), (CUBE, "region"), (CUBE.boundary_surface(), None)])
def test_plot_draws_the_mesh(tmp_path, mesh, scalars):
    picture = tmp_path / "mesh.png"
    mesh.plot(scalars, off_screen=True, screenshot=str(picture), window_size=(200, 200))
    seen = pv.read(picture).point_data.active_scalars
    assert len(np.unique(seen.reshape(len(seen), -1), axis=0)) > 10


def test_plot_colours_by_data(monkeypatch):
    asked = {}
    monkeypatch.setattr(pv.UnstructuredGrid, "plot", lambda grid, **options: asked.update(options, grid=grid))
    mesh = wct.TetMesh(CUBE.points, CUBE.tets, point_data={"heat": CUBE.points[:, 0]})
    mesh.plot("heat", show_edges=False)
    assert (asked["scalars"], asked["show_edges"]) == ("heat", False)
    assert (asked["grid"].point_data["heat"] == CUBE.points[:, 0]).all()
    assert (asked["grid"].cells.reshape(-1, 5)[:, 1:] == CUBE.tets).all()
    CUBE.plot()
    assert asked["scalars"] == "region"
    bcc(2).plot()
    assert asked["scalars"] is None


def test_plot_refuses_in_one_line(monkeypatch):
    with pytest.raises(OptionError, match=r"scalars is 'cold'; allowed are 'region'$"):
        CUBE.plot("cold")
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(WctError, match=r"pip install '\.\[pyvista\]' in a clone"):
        CUBE.plot()
