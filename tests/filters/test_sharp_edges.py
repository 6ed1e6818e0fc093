"""Wedges and notches: at a sharp edge every tet is as sharp, and sizes must not follow the thickness to nothing; in a
notch facets of one side must not reach across to the other."""

import numpy as np
import pytest
from support.builders import ball, kuhn_cube, rotation

from wct_plugin import apply_filter
from wct_plugin.core import _core
from wct_plugin.measure import quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import TetMesh


def wedge(degrees, n):
    """A right prism over a triangle with this angle between its sides through the origin, in a general position."""
    cube = kuhn_cube(n)
    centers = cube.points[cube.tets].mean(axis=1)
    turned = cube.points * [1.0, np.tan(np.radians(degrees)), 1.0] @ rotation(3).T
    return TetMesh(turned, cube.tets[centers[:, 1] < centers[:, 0]])


def notch(degrees, n):
    """A block with a cut from above that is opened by this angle, in a general position."""
    cube = kuhn_cube(n)  # n even: a layer of its vertices is where the cut runs
    parts, tets = [], []
    right = cube.points[cube.tets].mean(axis=1)[:, 0] > 0.5
    for side, own in ((1.0, right), (-1.0, ~right)):
        points = cube.points * [2.0, 1.0, 0.6] - [1.0, 0.0, 0.0]
        open_by = np.tan(np.radians(degrees / 2)) * np.maximum(0.0, points[:, 1] - 0.25)
        points[:, 0] += side * open_by * (1.0 - side * points[:, 0])
        tets.append(cube.tets[own] + len(cube.points) * len(parts))
        parts.append(points)
    points, tets = np.concatenate(parts), np.concatenate(tets)
    _, first, same = np.unique(points.round(9), axis=0, return_index=True, return_inverse=True)
    return TetMesh(points[first] @ rotation(3).T, same.ravel()[tets])


def _volume(mesh):
    return quality.volumes(mesh.points, mesh.tets).sum()


@pytest.mark.parametrize(("degrees", "left"), [(25, 0.01), (30, 0.0), (32, 0.0), (45, 0.0)])
def test_a_wedge_becomes_well_centered_without_many_more_tets(degrees, left):
    """At 25 degrees rounding decides whether all tets do: of twelve runs eight, in the others up to four do not."""
    mesh = wedge(degrees, 9)
    better, metrics = apply_filter("meshing_well_centered", mesh, surface_edges=3.0)  # not for shorter edges' sake
    assert metrics["bad"] <= left * len(better.tets)
    assert quality.measure(better).completely_well_centered.mean() >= 1.0 - left
    assert measure_deviation(better.boundary_surface(), mesh.boundary_surface()).max < 1e-12
    assert _volume(better) == pytest.approx(_volume(mesh), rel=1e-12)
    assert len(better.tets) <= 1.6 * len(mesh.tets)


def test_a_finer_reference_hardly_makes_finer_tets_at_a_sharp_edge():
    mesh = wedge(32, 6)
    coarse, fine = (
        apply_filter("meshing_well_centered", mesh, reference=wedge(32, n).boundary_surface(), tolerance=1e-3)[0]
        for n in (6, 36)
    )
    assert len(fine.tets) <= 1.6 * len(coarse.tets)


@pytest.mark.parametrize("degrees", [20, 32, 40])
def test_facets_do_not_reach_across_a_notch(degrees, monkeypatch):
    """A start with such facets is none: from the mesh as it came in, the search takes ten times as long."""
    intact, resample = [], _core.resample

    def listened(*domain, **asked):
        found = resample(*domain, **asked)
        intact.append(found.intact)
        return found

    monkeypatch.setattr(_core, "resample", listened)
    mesh = notch(degrees, 8)
    better, _ = apply_filter("meshing_well_centered", mesh)
    assert intact[0]
    assert quality.measure(better).completely_well_centered.all()
    assert measure_deviation(better.boundary_surface(), mesh.boundary_surface()).max < 1e-12
    assert _volume(better) == pytest.approx(_volume(mesh), rel=1e-12)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_wide_tolerance_makes_no_creases_on_a_ball(seed):
    """It leaves room for facets that bend by more than the crease angle; the surface bends by 10 degrees."""
    _, metrics = apply_filter("meshing_well_centered", ball(6), tolerance=5e-2, seed=seed)
    assert metrics["bad"] == 0
    assert metrics["sharp_edges"]["after"] == 0.0
