"""Tets are improved up to the cells beside them, and these stay to the bit."""

from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from support.builders import jittered_cube

import wct_plugin as wct
from wct_plugin.errors import InputError
from wct_plugin.measure import quality
from wct_plugin.mesh import Cells
from wct_plugin.mesh.other_cells import find_contact

DATA = Path(__file__).parents[1] / "data"
pytestmark = pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")


@pytest.fixture(scope="module")
def layer():
    return wct.read(DATA / "prismlayer.msh")


def contact_places(mesh):
    """The facets of tets that other cells have, by coordinates."""
    boundary = mesh.topology.boundary
    rows = boundary[find_contact(boundary, mesh.others, len(mesh.points)).facets]
    return np.unique(np.sort(mesh.points[rows].reshape(-1, 9).view("V72").ravel()))


def check_stays(before, after):
    for kind, cells in before.others.cells.items():
        made = after.others.cells[kind]
        assert np.array_equal(after.others.points[made.vertices], before.others.points[cells.vertices])
        assert np.array_equal(made.tags, cells.tags)
    one, other = (find_contact(m.topology.boundary, m.others, len(m.points)).facets.sum() for m in (before, after))
    assert one == other
    shared = after.others.shared
    assert np.array_equal(after.points[shared[shared >= 0]], after.others.points[shared >= 0])
    assert (shared >= 0).sum() == (before.others.shared >= 0).sum()


@pytest.mark.parametrize(
    "options", [{}, {"boundary": {"*": "keep"}}, {"goal": "delaunay"}, {"goal": "3wc", "tolerance": 0.01}]
)
def test_the_layer_of_prisms_stays(layer, options):
    made, metrics = wct.apply_filter("meshing_well_centered", layer, **options)
    check_stays(layer, made)
    assert made.names == layer.names
    assert len(made.tets) != len(layer.tets) or options.get("goal") == "delaunay"
    assert quality.volumes(made.points, made.tets).sum() == pytest.approx(1.0, rel=1e-12)
    assert metrics["groups"] == {
        "beside other cells": pytest.approx({"before": 1.0, "after": 1.0, "change": 0.0}, abs=1e-12)
    }
    assert not len(made.facets)  # nothing is tagged that was not
    if options.get("goal") != "delaunay":
        assert metrics["bad"] == 0


def test_tags_sets_and_point_data_of_both_come_along(layer):
    boundary = layer.topology.boundary
    facets = Cells(boundary, 1 + np.ptp(layer.points[boundary], axis=1).argmin(axis=1), {}, {"low": np.arange(4)})
    others = replace(layer.others, point_data={"u": layer.others.points[:, 2].copy()})
    given = replace(layer, facets=facets, point_data={"u": layer.points[:, 2].copy()}, others=others)
    made, _ = wct.apply_filter("meshing_well_centered", given)
    assert sorted(np.unique(made.facets.tags)) == sorted(np.unique(facets.tags))
    assert list(made.facets.sets) == ["low"]
    assert np.allclose(made.point_data["u"], made.points[:, 2], atol=1e-12)
    assert np.array_equal(made.others.point_data["u"], made.others.points[:, 2])


def test_what_meets_the_goal_stays_as_it_is(layer):
    made, _ = wct.apply_filter("meshing_well_centered", layer)
    again, metrics = wct.apply_filter("meshing_well_centered", made)
    assert again is made
    assert metrics["kept"]


def test_moving_vertices_leaves_shared_ones(layer):
    made, _ = wct.apply_filter("apply_coord_well_centering", layer, boundary="slide")
    check_stays(layer, made)
    assert not np.array_equal(made.points, layer.points)


def test_cells_that_touch_along_an_edge_or_a_vertex_stay_there(tmp_path):
    """A row of tets in a box, a hexahedron at one of its edges, another at one of its corners."""
    box = jittered_cube(2)
    points = box.points
    low = points.min(axis=0)
    edge = np.flatnonzero((points[:, :2] == low[:2]).all(axis=1))
    edge = edge[np.argsort(points[edge, 2])][:2]
    top = int(np.argmax(points.sum(axis=1)))
    a, b = points[edge]
    wall = [a + np.array(move) for move in ([-1, 0, 0], [-1, -1, 0], [0, -1, 0])]
    far = [
        points[top] + np.array(move)
        for move in ([1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1])
    ]
    count = len(points)
    more = [*wall, *(one + b - a for one in wall), *far]
    first = [edge[0], count, count + 1, count + 2, edge[1], count + 3, count + 4, count + 5]
    second = [top, *range(count + 6, count + 13)]
    cells = [("tetra", box.tets), ("hexahedron", np.array([first, second]))]
    meshio.Mesh(np.vstack([points, more]), cells).write(tmp_path / "a.vtu")
    given = wct.read(tmp_path / "a.vtu")
    contact = find_contact(given.topology.boundary, given.others, len(given.points))
    assert (contact.facets.sum(), contact.halves.sum(), contact.beside.sum()) == (0, 0, 2)
    made, _ = wct.apply_filter("meshing_well_centered", given, goal="3wc")
    assert len(made.tets) != len(given.tets)
    check_stays(given, made)
    joined = np.sort(made.others.shared[made.others.cells["hexahedron"].vertices[0]])[-2:]
    assert (made.topology.edges == joined).all(axis=1).any()  # still one edge


def test_two_points_in_one_place_beside_other_cells_are_refused(layer):
    shared = layer.others.shared[layer.others.shared >= 0]
    twin = len(layer.points)
    points = np.vstack([layer.points, layer.points[shared[0]]])
    tets = np.array(layer.tets)
    row = int(np.flatnonzero((tets == shared[0]).any(axis=1))[0])
    tets[row][tets[row] == shared[0]] = twin
    at = np.array(layer.others.shared)
    loose = np.flatnonzero(at == shared[0])
    others = replace(
        layer.others,
        points=np.vstack([layer.others.points, layer.points[shared[0]]]),
        shared=np.append(at, twin),
        cells={"wedge": _with_twin(layer.others.cells["wedge"], int(loose[0]), len(at))},
    )
    broken = replace(layer, points=points, tets=tets, regions=layer.regions, others=others)
    with pytest.raises(InputError, match=r"two points of tets beside other cells are both at \(.*\); allowed is one"):
        wct.apply_filter("meshing_well_centered", broken)


def _with_twin(wedges, one, twin):
    """One of the wedges on the other point of two in one place."""
    vertices = np.array(wedges.vertices)
    row = int(np.flatnonzero((vertices == one).any(axis=1))[0])
    vertices[row][vertices[row] == one] = twin
    return Cells(vertices, wedges.tags)


def test_tagged_facets_beside_other_cells_are_counted_once(layer):
    """They are held as a set and keep the tag that they have themselves."""
    boundary = layer.topology.boundary
    contact = boundary[find_contact(boundary, layer.others, len(layer.points)).all]
    tagged = replace(layer, facets=Cells(contact, np.full(len(contact), 5)), names=dict(layer.names) | {"mid": (5, 2)})
    made, metrics = wct.apply_filter("meshing_well_centered", tagged)
    assert metrics["losses"] == []
    for name in ("mid", "beside other cells"):
        assert metrics["groups"][name] == pytest.approx({"before": 1.0, "after": 1.0, "change": 0.0}, abs=1e-12)
    assert len(made.facets) == len(contact)
    assert set(made.facets.tags) == {5}
