"""Sides of a box that are translates of each other come back as such, vertex for vertex."""

import warnings

import numpy as np
import pytest
from support.builders import jittered_cube, two_region_cube

import wct_plugin as wct
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.periodic import find_periodic


def box(axes, turn=None, shift=(0.0, 0.0, 0.0)):
    """A jittered cube whose sides match along ``axes`` only: along the others the vertices of one side are moved."""
    mesh = jittered_cube(3)
    points = mesh.points.copy()
    for axis in sorted({0, 1, 2} - set(axes)):
        side = mesh.topology.boundary_points & (mesh.points[:, axis] == 1)
        inner = side & ((mesh.points == 0) | (mesh.points == 1)).sum(axis=1).__eq__(1)
        points[inner] += 0.05 * np.roll([0.0, 1.0, 0.5], axis)
    if turn is not None:
        points = points @ turn.T
    return TetMesh(points + shift, mesh.tets)


def along(pairs):
    """The pairs by the axis they are translated along."""
    return {int(np.abs(pair.translation).argmax()): pair for pair in pairs}


def optimize(mesh, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("error", wct.WctWarning)
        return wct.apply_filter("meshing_well_centered", mesh, **{"goal": "3wc", "force": True, **options})


@pytest.mark.parametrize("axes", [[0], [0, 1], [0, 1, 2]])
def test_pairs_of_a_box_match_to_the_bit(axes):
    mesh = box(axes)
    assert sorted(along(find_periodic(mesh))) == axes
    out, found = optimize(mesh)
    assert found["bad"] == 0
    pairs = along(find_periodic(out))
    assert sorted(pairs) == axes
    for axis, pair in pairs.items():
        one, other = out.points[pair.vertices.T]
        step = np.zeros(3)
        step[axis] = 1.0
        assert np.array_equal(other, one + step)
        on = out.points[out.topology.boundary]
        for value, side in ((0.0, pair.master), (1.0, pair.slave)):
            assert len(side) == (on[:, :, axis] == value).all(axis=1).sum()  # all of the side


def test_pairs_of_a_turned_box_match():
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    mesh = box([1], turn * np.linalg.det(turn), (3.0, -1.0, 2.0))
    out, _ = optimize(mesh)
    (pair,) = find_periodic(out)
    one, other = out.points[pair.vertices.T]
    assert np.abs(other - one - pair.translation).max() < 1e-15 * np.abs(out.points).max() * 8
    assert np.allclose(pair.translation, find_periodic(mesh)[0].translation, atol=1e-12)


def test_sides_cut_by_regions_match_region_by_region():
    mesh = two_region_cube(4)
    before = find_periodic(mesh)
    assert len(before) > 3  # the sides along the interface are two each
    out, _ = optimize(mesh)
    assert len(find_periodic(out)) == len(before)


def test_tags_and_names_come_out_as_they_were():
    mesh = box([0])
    boundary = mesh.topology.boundary
    low = (mesh.points[boundary][:, :, 0] == 0).all(axis=1)
    named = TetMesh(mesh.points, mesh.tets, facets=Cells(boundary[low], np.full(low.sum(), 5)), names={"in": (5, 2)})
    out, _ = optimize(named)
    assert set(out.facets.tags.tolist()) == {5}
    assert list(out.facets.sets) == []
    assert (out.points[out.facets.vertices][:, :, 0] == 0).all()
    assert len(out.nodes) == 0


def test_a_fixed_side_fixes_its_translate():
    mesh = box([0])
    boundary = mesh.topology.boundary
    low = (mesh.points[boundary][:, :, 0] == 0).all(axis=1)
    named = TetMesh(mesh.points, mesh.tets, facets=Cells(boundary[low], np.full(low.sum(), 5)))
    out, _ = optimize(named, boundary={"5": "fixed"})
    (before,), (after,) = find_periodic(mesh), find_periodic(out)
    for side in ("master", "slave"):
        old, new = (
            {tuple(sorted(map(tuple, one))) for one in m.points[getattr(pair, side)].tolist()}
            for m, pair in ((mesh, before), (out, after))
        )
        assert old == new


def test_lost_pairs_are_a_warning():
    with pytest.warns(wct.WctWarning, match="1 of 1 periodic pairs of facets are lost"):
        wct.apply_filter("meshing_well_centered", box([0]), boundary="keep", goal="cwc")
