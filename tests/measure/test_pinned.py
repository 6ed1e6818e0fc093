"""What tagged cells hold is counted and said."""

from dataclasses import replace

import numpy as np
from support.builders import kuhn_cube

import wct_plugin as wct
from wct_plugin.measure.pinned import describe, measure_pinned
from wct_plugin.mesh import Cells
from wct_plugin.reports.report import make_report


def test_what_is_held() -> None:
    cube = kuhn_cube(2)
    inner = cube.topology.triangles_of(cube.topology.interior_pairs[:3, :2])
    facets = Cells(np.concatenate([cube.topology.boundary, inner]))
    edges = Cells(np.array([[0, 1], [1, 0], [1, 2]]), np.array([1, 2, 1]))
    mesh = replace(cube, facets=facets, edges=edges, nodes=Cells(np.array([[5], [5]]), np.array([1, 2])))
    assert measure_pinned(mesh) == {"vertices": 1, "edges": 2, "facets": 3}
    assert describe(measure_pinned(mesh)) == (
        "held as the input lists them: 1 vertex cell stays in its place, 2 line cells stay edges, "
        "3 triangles inside a region stay sheets"
    )
    assert describe(measure_pinned(cube)) == ""


def test_the_optimizer_says_it() -> None:
    cube = kuhn_cube(2)
    mesh = replace(cube, nodes=Cells(np.array([[13]]), np.array([1])))
    better, metrics = wct.apply_filter("meshing_well_centered", mesh, goal="3wc")
    assert metrics["pinned"] == {"vertices": 1, "edges": 0, "facets": 0}
    line = "held as the input lists them: 1 vertex cell stays in its place"
    assert line in make_report(better, found=metrics).notes
