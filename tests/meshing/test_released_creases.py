"""Creases that were given up: how many, how long, and in words."""

import numpy as np
import pytest
from support.builders import kuhn_cube, two_region_cube
from support.core_meshes import start

from wct_plugin import apply_filter
from wct_plugin.measure.released_creases import describe
from wct_plugin.meshing.reference import own_boundary
from wct_plugin.meshing.released_creases import measure_released, without
from wct_plugin.reports.report import make_report


def test_length_by_the_diagonal():
    mesh = kuhn_cube(3)
    own = own_boundary(mesh, 40.0)
    edges = np.unique(own.strata.curve)
    for some in (edges[:1], edges[[0, 4, 7]], edges[:0]):
        assert measure_released(own, some) == {"creases": len(some), "length": pytest.approx(len(some) / np.sqrt(3.0))}


def test_in_words():
    assert describe({"creases": 0, "length": 0.0}) == ""
    assert describe({"creases": 1, "length": 0.125}).startswith("1 crease (0.12 of the diagonal long together)")
    assert describe({"creases": 12, "length": 0.5}).startswith("12 creases (0.5 of the diagonal long together)")


def test_the_report_says_so():
    mesh = kuhn_cube(2)
    assert make_report(mesh, found={"released": {"creases": 0, "length": 0.0}}).notes == ()
    (note,) = make_report(mesh, found={"released": {"creases": 2, "length": 0.5}}).notes
    assert note == describe({"creases": 2, "length": 0.5})


def test_a_cube_keeps_its_creases():
    _, metrics = apply_filter("meshing_well_centered", kuhn_cube(3))
    assert metrics["released"] == {"creases": 0, "length": 0.0}


def test_the_surface_without_creases():
    mesh = kuhn_cube(3)
    own = own_boundary(mesh, 40.0)
    old = own.strata
    one = without(own, old.curve[:1], np.empty(0, dtype=np.int64))
    gone = old.curve == old.curve[0]
    joined = np.unique(old.patch[(np.isin(old.triangles, old.segments[gone]).sum(axis=1) == 2)])
    assert len(one.strata.segments) == len(old.segments) - gone.sum()
    assert len(np.unique(one.strata.patch)) == 5
    assert set(np.unique(one.strata.patch)) < set(np.unique(old.patch))
    assert len(joined) >= 2
    assert np.array_equal(one.corners, own.corners)  # two other creases meet at each end
    assert len(one.sides) == len(own.sides)
    inner = np.setdiff1d(old.segments[gone], own.corners)
    assert (one.strata.stratum[inner] == 1).all()
    assert np.isin(one.strata.label[inner], one.strata.patch).all()


def test_corners_without_creases_are_none_but_for_those_that_are_kept():
    mesh = kuhn_cube(3)
    own = own_boundary(mesh, 40.0)
    smooth = without(own, np.unique(own.strata.curve), own.corners[:2])
    assert np.array_equal(smooth.corners, own.corners[:2])
    assert np.unique(smooth.strata.patch).tolist() == [own.strata.patch.min()]
    assert without(own, own.strata.curve[:0], own.corners[:0]) is own


def test_bodies_with_interfaces_are_sampled_without_creases():
    mesh = two_region_cube(4)
    own = own_boundary(mesh, 40.0)
    strata = own.strata
    curves = np.unique(strata.curve)
    inside = np.unique(strata.triangles[(own.sides[strata.patch] >= 0).all(axis=1)])
    rims = np.unique(strata.curve[np.isin(strata.segments, inside).all(axis=1)])
    outer = np.setdiff1d(curves, rims)
    assert len(rims) >= 4 <= len(outer)
    for gone in outer[:2]:
        found = start(mesh, without(own, outer[outer == gone], np.empty(0, dtype=np.int64)))
        assert set(found.mesh.crease_curve.tolist()) == set(curves.tolist()) - {gone}
