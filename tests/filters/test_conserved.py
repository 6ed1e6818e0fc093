"""Volumes of regions and areas of groups stay within half a percent of the surface that is followed."""

import numpy as np
import pytest
from support.builders import ball, cylinder
from support.gmsh_bodies import crossing_balls

from wct_plugin import apply_filter
from wct_plugin.measure.quality import measure
from wct_plugin.mesh import Cells, TetMesh


def drum(sides, rings, layers):
    """A cylinder of radius 1 and height 1 whose lower half is region 2; a disc of radius 1/2 on top is tagged."""
    from scipy.spatial import Delaunay

    flat = [(0.0, 0.0)]
    for ring in range(1, rings + 1):
        count = sides if ring in (rings // 2, rings) else max(6, sides * ring // rings)
        turn = 2.0 * np.pi * (np.arange(count) + 0.5 * (ring % 2)) / count
        flat += list(zip(ring / rings * np.cos(turn), ring / rings * np.sin(turn), strict=True))
    points = np.array([(x, y, z) for z in np.linspace(0.0, 1.0, layers + 1) for x, y in flat])
    triangles = Delaunay(np.array(flat)).simplices
    tets = []
    for layer in range(layers):
        low, high = layer * len(flat), (layer + 1) * len(flat)
        for a, b, c in np.sort(triangles, axis=1):
            tets += [[a + low, b + low, c + low, c + high], [a + low, b + low, b + high, c + high]]
            tets += [[a + low, a + high, b + high, c + high]]
    mesh = TetMesh(points, tets)
    middle = mesh.points[mesh.tets].mean(axis=1)[:, 2]
    facets = mesh.topology.boundary
    corners = mesh.points[facets]
    top = facets[(corners[:, :, 2] == 1.0).all(axis=1) & (np.hypot(*corners.mean(axis=1)[:, :2].T) < 0.5)]
    return TetMesh(mesh.points, mesh.tets, np.where(middle < 0.5, 2, 1), facets=Cells(top, np.full(len(top), 5)))


def area(points, triangles):
    a, b, c = points[triangles].swapaxes(0, 1)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0


def volumes(mesh):
    a, b, c, d = mesh.points[mesh.tets].swapaxes(0, 1)
    each = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6.0
    return np.array([each[mesh.regions == tag].sum() for tag in np.unique(mesh.regions)])


def between(mesh, one, other):
    """The facets between two regions."""
    facets = []
    for region in (one, other):
        tets = np.sort(mesh.tets[mesh.regions == region], axis=1)
        facets.append({tuple(tet[[k for k in range(4) if k != out]].tolist()) for tet in tets for out in range(4)})
    return np.array(sorted(facets[0] & facets[1])).reshape(-1, 3)


def test_a_round_contact_keeps_its_area_and_both_regions_their_volume():
    mesh = drum(24, 4, 4)
    better, found = apply_filter("meshing_well_centered", mesh, goal="3wc")
    old, new = (area(one.points, one.facets.vertices) for one in (mesh, better))
    assert new == pytest.approx(old, rel=5e-3)
    assert volumes(better) == pytest.approx(volumes(mesh), rel=5e-3)
    assert found["groups"]["5"]["change"] == pytest.approx(new / old - 1.0, abs=1e-9)
    assert not found["bad"]
    assert not found["losses"]


def test_an_interface_through_a_coarse_cylinder_keeps_its_area():
    whole = cylinder(12, 4)
    mesh = TetMesh(whole.points, whole.tets, np.where(whole.points[whole.tets].mean(axis=1)[:, 2] < 1.0, 1, 2))
    better, found = apply_filter("meshing_well_centered", mesh, seed=3)
    assert len(np.unique(better.points[better.topology.interfaces][..., 2])) == 1
    assert area(better.points, better.topology.interfaces) == pytest.approx(3.0, rel=5e-3)  # a polygon of 12 corners
    assert not found["bad"]
    assert not found["losses"]


def test_a_coarse_ball_keeps_its_volume():
    mesh = ball(3)
    better, _ = apply_filter("meshing_well_centered", mesh)
    assert volumes(better) == pytest.approx(volumes(mesh), rel=5e-3)


@pytest.mark.parametrize("seed", range(3))
def test_coarse_curved_interfaces_keep_their_areas_and_regions_their_volumes(seed, tmp_path):
    # Hardly a vertex of so coarse a mesh may move without making some tet bad: several have to, and others to give way.
    old = crossing_balls(tmp_path, 0.4)
    new, metrics = apply_filter("meshing_well_centered", old, seed=seed)
    assert measure(new).completely_well_centered.all()
    assert not metrics["losses"]
    assert volumes(new) == pytest.approx(volumes(old), rel=5e-3)
    for pair in ((1, 2), (1, 3)):  # the lens, and the crescents
        areas = [area(mesh.points, between(mesh, *pair)) for mesh in (old, new)]
        assert areas[1] == pytest.approx(areas[0], rel=5e-3)
