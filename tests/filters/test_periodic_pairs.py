"""Sides of a box that are translates of each other come back as such, vertex for vertex."""

import warnings

import numpy as np
import pytest
from support.builders import kuhn_cube

import wct_plugin as wct
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.periodic import find_periodic
from wct_plugin.meshing import local_search, periodic_pairs


@pytest.fixture
def hasty(monkeypatch):
    """The search gives up soon: pairs match however many tets miss the goal."""
    monkeypatch.setattr(local_search, "_WORTH", dict.fromkeys(local_search._WORTH, 300.0))
    monkeypatch.setattr(local_search, "_FINER", 0)
    monkeypatch.setattr(local_search, "_FINER_HELD", 0)
    monkeypatch.setattr(local_search, "_KICKS", 100)
    monkeypatch.setattr(periodic_pairs, "_ATTEMPTS", 1)


def box(axes, turn=None, regions=None):
    """A cube of bricks whose sides match along ``axes`` only: along the others, vertices of one side are moved."""
    mesh = kuhn_cube(3)
    points = mesh.points.copy()
    rims = ((mesh.points == 0) | (mesh.points == 1)).sum(axis=1) > 1
    for axis in sorted({0, 1, 2} - set(axes)):
        points[(mesh.points[:, axis] == 1) & ~rims] += np.roll([0.0, 0.05, 0.03], axis)
    return TetMesh(points if turn is None else points @ turn.T, mesh.tets, regions)


def pairs_of(mesh):
    """All pairs, each from the side with the smaller coordinates to the other."""
    out = []
    for pair in find_periodic(mesh):
        back = pair.translation[np.abs(pair.translation).argmax()] < 0
        out.append(
            pair._replace(
                master=pair.slave, slave=pair.master, vertices=pair.vertices[:, ::-1], translation=-pair.translation
            )
            if back
            else pair
        )
    return out


def along(pairs):
    """The pairs by the axis they are translated along."""
    return {int(np.abs(pair.translation).argmax()): pair for pair in pairs}


def optimize(mesh, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("error", wct.WctWarning)
        return wct.apply_filter(
            "meshing_well_centered", mesh, **{"goal": "3wc", "force": True, "periodic": True, **options}
        )


@pytest.mark.parametrize("axes", [[0], [0, 1], [0, 1, 2]])
def test_pairs_of_a_box_match_to_the_bit(axes, hasty):
    mesh = box(axes)
    assert sorted(along(pairs_of(mesh))) == axes
    out, _ = optimize(mesh)
    pairs = along(pairs_of(out))
    assert sorted(pairs) == axes
    for axis, pair in pairs.items():
        one, other = out.points[pair.vertices.T]
        step = np.zeros(3)
        step[axis] = 1.0
        assert np.array_equal(other, one + step)
        on = out.points[out.topology.boundary]
        for value, side in ((0.0, pair.master), (1.0, pair.slave)):
            assert len(side) == (on[:, :, axis] == value).all(axis=1).sum()  # all of the side


def test_a_box_with_one_pair_meets_the_goal():
    _, found = optimize(box([0]))
    assert found["bad"] == 0


def test_pairs_of_a_turned_box_match():
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    mesh = box([1], turn * np.linalg.det(turn))
    out, _ = optimize(mesh)
    (pair,) = pairs_of(out)
    one, other = out.points[pair.vertices.T]
    assert np.abs(other - one - pair.translation).max() < 1e-15
    assert np.allclose(pair.translation, pairs_of(mesh)[0].translation, atol=1e-12)


def test_sides_cut_by_regions_match_region_by_region(hasty):
    plain = box([0])
    mesh = box([0], regions=1 + (plain.points[plain.tets].mean(axis=1)[:, 2] > 1 / 3))
    assert len(pairs_of(mesh)) == 2
    with warnings.catch_warnings():  # what stops so soon may leave the interface off
        warnings.filterwarnings("ignore", message="the interface", category=wct.WctWarning)
        out, _ = wct.apply_filter("meshing_well_centered", mesh, goal="3wc", force=True, periodic=True)
    pairs = pairs_of(out)
    assert len(pairs) == 2
    for pair in pairs:
        one, other = out.points[pair.vertices.T]
        assert np.array_equal(other, one + np.array([1.0, 0.0, 0.0]))


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
    found = periodic_pairs.PeriodicSurface(named, find_periodic(named), {"5": "fixed"}, 40.0)
    strata = found.own.strata
    sides = mesh.points[strata.triangles[found.choices.fixed[strata.patch]]][:, :, 0]
    assert np.array_equal(np.unique(sides), [0.0, 1.0])
    assert len(sides) == 2 * low.sum()


def test_without_being_asked_pairs_are_counted():
    _, found = wct.apply_filter("meshing_well_centered", box([0]), goal="3wc")
    assert found["periodic"]["before"] == 1
    assert found["periodic"]["after"] in (0, 1)
