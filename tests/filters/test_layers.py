"""Thin plates and shells: one row of tets goes through them, as in the tiling of a slab."""

import gmsh
import numpy as np
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


@pytest.mark.parametrize(("radius", "thickness", "unit"), [(0.5, 0.05, 1.0), (0.3, 0.018, 1e-6)])
def test_a_shell_takes_a_row_of_tets(tmp_path, radius, thickness, unit):
    """As a plate does; it took six times as many tets, as two rows with edges of .8 of the thickness."""

    def hollow_ball():
        balls = [(3, gmsh.model.occ.addSphere(0, 0, 0, r)) for r in (radius, radius - thickness)]
        gmsh.model.occ.cut(balls[:1], balls[1:])

    coarse = meshed(tmp_path, hollow_ball, 2 * thickness)
    mesh = TetMesh(unit * coarse.points, coarse.tets)
    made, metrics = wct.apply_filter("meshing_well_centered", mesh)
    assert quality.measure(made).completely_well_centered.all()
    assert metrics["losses"] == []
    area = 4 * np.pi * (radius - thickness / 2) ** 2
    assert len(made.tets) < 4.5 * area / thickness**2


def test_pipes_and_cups_take_a_row_of_tets(tmp_path):
    """Where a shell ends at a rim, too, and where a plane and a curved side are opposite ends of it."""

    def cup():
        outer = gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, 0.6, 0.3)
        inner = gmsh.model.occ.addCylinder(0, 0, 0.03, 0, 0, 0.6, 0.27)
        gmsh.model.occ.cut([(3, outer)], [(3, inner)])

    mesh = meshed(tmp_path, cup, 0.08)
    made, metrics = wct.apply_filter("meshing_well_centered", mesh)
    assert quality.measure(made).completely_well_centered.mean() > 0.998
    assert metrics["losses"] == []
    area = 2 * np.pi * 0.285 * 0.6 + np.pi * 0.285**2
    assert len(made.tets) < 4.5 * area / 0.03**2
