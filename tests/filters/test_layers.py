"""Thin plates: one row of tets goes through them, as in the tiling of a slab."""

import gmsh
import pytest
from support.builders import rotation
from support.gmsh_bodies import meshed

import wct_plugin as wct
from wct_plugin.measure import quality
from wct_plugin.mesh import TetMesh


def test_a_plate_takes_a_row_of_tets(tmp_path):
    """The slab's tiling has 3.3 tets per square of the thickness; rims and corners take more."""
    sides, thickness, unit = (0.5, 0.4), 0.02, 1e-6
    flat = meshed(tmp_path, lambda: gmsh.model.occ.addBox(0, 0, 0, *sides, thickness), 2.5 * thickness)
    mesh = TetMesh(unit * flat.points @ rotation(5).T, flat.tets)
    made, metrics = wct.apply_filter("meshing_well_centered", mesh)
    assert quality.measure(made).completely_well_centered.mean() > 0.998  # one tet at a corner may be left
    assert metrics["losses"] == []
    assert len(made.tets) < 4.5 * sides[0] * sides[1] / thickness**2
    volumes = [quality.volumes(m.points, m.tets).sum() for m in (made, mesh)]
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-9)
    assert metrics["planes"]["planes"] == 6
