"""Facets tagged inside a region, with a free border: they are carried, whatever of them may move."""

import warnings
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import wct_plugin as wct

DATA = Path(__file__).parents[1] / "data"


def edges_of(cells):
    return [tuple(sorted((int(a), int(b)))) for cell in cells for k, a in enumerate(cell) for b in cell[:k]]


def areas(mesh, cells):
    a, b, c = (mesh.points[cells[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def rim(mesh, cells):
    """Length of the edges that belong to one of these triangles only."""
    ends = np.array([edge for edge, count in Counter(edges_of(cells)).items() if count == 1])
    return np.linalg.norm(mesh.points[ends[:, 0]] - mesh.points[ends[:, 1]], axis=1).sum()


def in_tets(mesh):
    """How many tets have each facet."""
    return Counter(
        tuple(sorted(int(v) for v in np.delete(tet, opposite))) for tet in mesh.tets for opposite in range(4)
    )


@pytest.mark.parametrize(
    ("name", "goal", "boundary"),
    [
        *[("loose_facets", goal, boundary) for goal in ("cwc", "3wc") for boundary in ("move", "keep", "fixed")],
        ("scattered_facets", "cwc", "move"),
        ("scattered_facets", "cwc", "fixed"),
        *[("scattered_facets", goal, kind) for goal in ("delaunay", "one-sided") for kind in ("move", "keep", "fixed")],
    ],
)
def test_sheets_keep_their_tags_areas_and_rims(name, goal, boundary):
    old = wct.read(DATA / f"{name}.vtu")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that nothing better was found is no fault here
        new, metrics = wct.apply_filter("meshing_well_centered", old, goal=goal, boundary=boundary, tolerance=1e-3)
    assert not metrics["stopped"]
    tets_at = in_tets(new)
    assert set(new.facets.tags) == set(old.facets.tags)
    for tag in set(old.facets.tags):
        before, after = (mesh.facets.vertices[mesh.facets.tags == tag] for mesh in (old, new))
        strip = 1e-3 * old.diagonal * rim(old, before)  # the tolerance wide, along a rim that bends
        assert areas(new, after).sum() == pytest.approx(areas(old, before).sum(), abs=strip)
        assert rim(new, after) == pytest.approx(rim(old, before), rel=1e-2)
        assert {tets_at[tuple(sorted(facet))] for facet in after.tolist()} <= {1, 2}
    assert np.array_equal(new.points[new.nodes.vertices.ravel()], old.points[old.nodes.vertices.ravel()])
