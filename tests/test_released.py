"""Creases that were given up: how many, how long, and in words."""

import numpy as np
import pytest
from builders import kuhn_cube

from wct_plugin import apply_filter
from wct_plugin.reference import own_boundary
from wct_plugin.released import describe, released
from wct_plugin.report import make_report


def test_length_by_the_diagonal():
    mesh = kuhn_cube(3)
    own = own_boundary(mesh, 40.0)
    edges = np.unique(own.strata.curve)
    for some in (edges[:1], edges[[0, 4, 7]], edges[:0]):
        assert released(own, some) == {"creases": len(some), "length": pytest.approx(len(some) / np.sqrt(3.0))}


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
