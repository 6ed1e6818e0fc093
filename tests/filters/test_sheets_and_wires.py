"""Sheets and wires, tagged facets and edges inside a region: new meshes on both sides, of all shapes."""

from collections import Counter
from dataclasses import replace
from itertools import combinations
from math import pi
from pathlib import Path

import gmsh
import numpy as np
import pytest
from support.gmsh_bodies import embedded
from support.segments import farthest

import wct_plugin as wct
from wct_plugin.measure import quality

DATA = Path(__file__).parents[1] / "data"
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def square():
    return [(2, gmsh.model.occ.addRectangle(0.25, 0.25, 0.5, 0.5, 0.5))]


def disc():
    return [(2, gmsh.model.occ.addDisk(0.5, 0.5, 0.45, 0.3, 0.3))]


def ring():
    outer, inner = ((2, gmsh.model.occ.addDisk(0.5, 0.5, 0.5, r, r)) for r in (0.35, 0.15))
    return gmsh.model.occ.cut([outer], [inner])[0]


def from_the_wall():
    return [(2, gmsh.model.occ.addRectangle(0.0, 0.25, 0.5, 0.6, 0.5))]


def across():
    return [(2, gmsh.model.occ.addRectangle(0.0, 0.0, 0.5, 1.0, 1.0))]


def half_tube():
    arc = gmsh.model.occ.addCircle(0.5, 0.5, 0.25, 0.25, angle1=0.0, angle2=pi)
    return [part for part in gmsh.model.occ.extrude([(1, arc)], 0.0, 0.0, 0.5) if part[0] == 2]


def lines(points, ends):
    at = [gmsh.model.occ.addPoint(*point) for point in points]
    return [(1, gmsh.model.occ.addLine(at[i], at[k])) for i, k in ends]


def straight():
    return lines([(0.3, 0.4, 0.2), (0.6, 0.5, 0.8)], [(0, 1)])


def bent():
    return lines([(0.3, 0.3, 0.3), (0.7, 0.3, 0.3), (0.7, 0.7, 0.3), (0.7, 0.7, 0.7)], [(0, 1), (1, 2), (2, 3)])


def three_from_one_point():
    return lines([(0.5, 0.5, 0.5), (0.2, 0.5, 0.5), (0.8, 0.5, 0.5), (0.5, 0.5, 0.85)], [(0, 1), (0, 2), (0, 3)])


def circle():
    return [(1, gmsh.model.occ.addCircle(0.5, 0.5, 0.5, 0.3))]


def corners_in_tets(mesh, count):
    """How many tets have each set of so many of their corners."""
    return Counter(tuple(sorted(map(int, some))) for tet in mesh.tets for some in combinations(tet, count))


def made_well_centered(mesh):
    better, metrics = wct.apply_filter("meshing_well_centered", mesh)
    assert quality.measure(better).completely_well_centered.all()
    assert not metrics["losses"]
    return better


@pytest.mark.parametrize(
    ("build", "size"),
    [
        (square, 0.14),
        (disc, 0.14),
        (ring, 0.14),
        (from_the_wall, 0.14),
        (across, 0.14),
        (half_tube, 0.14),
        (half_tube, 0.15),
        (half_tube, 0.17),
    ],
)
def test_a_sheet_has_tets_on_both_sides(build, size, tmp_path):
    old = embedded(tmp_path, build, size)
    old = replace(old, points=1e-6 * old.points @ TURN.T)  # in another unit, along no axis
    new = made_well_centered(old)
    assert set(new.facets.tags) == {2}
    tets = corners_in_tets(new, 3)
    assert {tets[tuple(sorted(map(int, facet)))] for facet in new.facets.vertices} == {2}
    areas = []
    for mesh in (old, new):
        a, b, c = (mesh.points[mesh.facets.vertices[:, k]] for k in range(3))
        areas.append(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
    assert areas[1] == pytest.approx(areas[0], rel=5e-3)
    if build is not half_tube:  # flat
        heights = new.points[np.unique(new.facets.vertices)] @ TURN[:, 2]
        assert np.ptp(heights) < 1e-14 * new.diagonal


@pytest.mark.parametrize("build", [straight, bent, three_from_one_point, circle])
def test_a_wire_keeps_its_course(build, tmp_path):
    old = embedded(tmp_path, build, 0.14)
    old = replace(old, points=1e3 * old.points @ TURN.T)
    new = made_well_centered(old)
    assert set(new.edges.tags) == {2}
    tets = corners_in_tets(new, 2)
    assert all(tets[tuple(sorted(map(int, edge)))] for edge in new.edges.vertices)
    ends = [mesh.points[mesh.edges.vertices] for mesh in (old, new)]
    lengths = [np.linalg.norm(np.diff(one, axis=1), axis=-1).sum() for one in ends]
    assert lengths[1] == pytest.approx(lengths[0], rel=5e-3)
    starts, stops = ends[1][:, 0], ends[1][:, 1]
    for share in np.linspace(0.0, 1.0, 9):  # of the new edges, all along
        on = (1.0 - share) * starts + share * stops
        assert farthest(on, ends[0][:, 0], ends[0][:, 1]) < 1e-3 * old.diagonal  # the default tolerance of a cube


@pytest.mark.parametrize("name", ["sheet", "wire"])
def test_a_sheet_and_a_wire_in_small_cubes(name):
    old = wct.read(DATA / f"{name}.msh")
    new = made_well_centered(old)
    assert new.names == old.names
