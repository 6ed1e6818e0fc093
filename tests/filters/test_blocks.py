"""Bodies made of boxes, where interfaces meet each other and the outside at right angles: all come right, whole."""

from itertools import product

import numpy as np
import pytest
from support.builders import rotation
from support.gmsh_bodies import boxes

import wct_plugin as wct
from wct_plugin.measure import quality

EIGHT = [(*low, *(edge + 1 for edge in low)) for low in product((0, 1), repeat=3)]
INSIDE = [(0, 0, 0, 1, 1, 1), (0.3, 0.3, 0.3, 0.7, 0.7, 0.7)]


@pytest.mark.parametrize(
    ("corners", "size", "turned"),
    [(EIGHT, 0.34, False), (EIGHT, 0.3, True), (INSIDE, 0.15, False)],
    ids=["eight", "eight turned", "one inside"],
)
def test_blocks_come_right(tmp_path, corners, size, turned):
    mesh = boxes(tmp_path, corners, size)
    if turned:
        mesh = mesh.altered(points=mesh.points @ rotation(1).T)
    out, metrics = wct.apply_filter("meshing_well_centered", mesh)
    measured = quality.measure(out)
    assert measured.completely_well_centered.all()
    assert metrics["losses"] == []
    before = np.bincount(mesh.regions, quality.measure(mesh).volume)
    assert np.bincount(out.regions, measured.volume) == pytest.approx(before, rel=1e-9)
    assert len(out.tets) < 2.5 * len(mesh.tets)
