"""How long edges of the surface may be, by the input's own."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import kuhn_cube, two_region_cube

from wct_plugin import apply_filter
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.meshing.reference import own_boundary
from wct_plugin.meshing.surface_edges import longest_edges


def mean_edge(points, triangles):
    ends = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    return np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1).mean()


def on_face(mesh, axis, value):
    facets = mesh.topology.boundary
    return facets[(mesh.points[facets][:, :, axis] == value).all(axis=1)]


def test_edges_of_one_length_times_the_factor():
    mesh = kuhn_cube(4)
    own = own_boundary(mesh, 40.0)
    # 2/3 of the edges of a face cut into squares by diagonals are sides, but for those of the rim: 40 of 56.
    expected = np.exp((40 * np.log(0.25) + 16 * np.log(0.25 * np.sqrt(2.0))) / 56)
    used = np.unique(own.strata.triangles)
    for factor in (1.0, 1.25):
        found = longest_edges(mesh, own, own, factor)
        assert found[used] == pytest.approx(factor / 1.05 * expected)


def test_groups_and_interfaces_are_kept_finer():
    mesh = two_region_cube(4)
    top = on_face(mesh, 2, 1.0)
    mesh = replace(mesh, facets=Cells(top, np.full(len(top), 7)))
    own = own_boundary(mesh, 40.0)
    found = longest_edges(mesh, own, own, 1.25)
    z, y = mesh.points[:, 2], mesh.points[:, 1]
    inner = (y > 0.0) & (y < 1.0) & (mesh.points[:, 0] > 0.0) & (mesh.points[:, 0] < 1.0)
    bottom = found[inner & (z == 0.0)]
    assert found[z == 1.0] == pytest.approx(0.82 * bottom[0])
    assert found[inner & (z == 0.5)] == pytest.approx(0.82 * bottom[0])


def test_another_surface_takes_the_lengths_of_the_facets_nearby():
    mesh, coarse = (TetMesh(cube.points * [1.0, 1.0, 4.0], cube.tets) for cube in (kuhn_cube(4), kuhn_cube(1)))
    own = own_boundary(mesh, 40.0)
    coarse = own_boundary(coarse, 40.0)
    found = longest_edges(mesh, own, coarse, 1.0)
    used = np.unique(own.strata.triangles)
    lengths = longest_edges(mesh, own, own, 1.0)[used]
    assert (found >= lengths.min()).all()
    assert (found <= lengths.max()).all()


@pytest.mark.parametrize("factor", [0.9, 1.25])
def test_the_surface_keeps_its_edges_and_a_contact_more_so(factor):
    mesh = kuhn_cube(8)
    contact = on_face(mesh, 0, 0.0)
    mesh = replace(mesh, facets=Cells(contact, np.full(len(contact), 3)))
    better, found = apply_filter("meshing_well_centered", mesh, surface_edges=factor)
    assert found["bad"] == 0
    everywhere = mean_edge(better.points, better.topology.boundary) / mean_edge(mesh.points, mesh.topology.boundary)
    assert 0.85 * factor < everywhere <= factor
    assert mean_edge(better.points, better.facets.vertices) / mean_edge(mesh.points, contact) <= 0.88 * factor
