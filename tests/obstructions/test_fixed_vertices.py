"""Held tets and angles: the lemma on random tets, and corners that no sliding makes well-centered."""

import numpy as np
import pytest
from support.builders import jittered_cube, kuhn_cube, single
from support.trying import clearance, improved

from wct_plugin.measure.quality import measure
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import find_strata
from wct_plugin.obstructions import find_reasons, fixed_vertices


def found(mesh, goal, boundary="slide"):
    every = np.arange(len(mesh.tets))
    return find_reasons(mesh, find_strata(mesh), every, goal=goal, boundary=boundary, connectivity="fixed")


def test_a_tet_that_contains_its_circumcenter_has_at_most_one_wide_angle_per_vertex():
    rng = np.random.default_rng(0)
    points = rng.normal(size=(100_000, 4, 3))
    points /= np.linalg.norm(points, axis=2)[..., None]
    mesh = TetMesh(points.reshape(-1, 3), np.arange(400_000).reshape(-1, 4))
    good = points[measure(mesh).min_height > 0]
    wide = 0
    for apex in range(4):
        edges = np.delete(good, apex, axis=1) - good[:, apex : apex + 1]
        count = sum(np.einsum("ij,ij->i", edges[:, a], edges[:, b]) <= 0 for a, b in ((0, 1), (0, 2), (1, 2)))
        assert count.max() == 1
        wide += (count == 1).sum()
    assert wide > 1000


@pytest.mark.parametrize(
    ("two", "three", "possible"),
    [
        ([0, 1, 0], [0, 0, 1], False),  # a box
        ([-1, 2, 0], [0, 0, 1], False),
        ([1, 2, 0], [0, 0, 1], False),  # an upright edge on an acute triangle
        ([1, 2, 0], [1, -2, 3], True),  # one angle above 90 degrees
        ([1, 4, 0], [1, 0, 4], True),  # three of 76 degrees or more
    ],
)
def test_a_corner_tet_with_two_wide_angles_is_never_3wc_however_long_its_edges_are(two, three, possible):
    """One edge along x, the others given; their ends slide: lengths over four orders of magnitude."""
    edges = np.array([[1.0, 0, 0], two, three])
    lengths = 10.0 ** np.random.default_rng(0).uniform(-2, 2, (40000, 3))
    tets = np.zeros((40000, 4, 3))
    tets[:, 1:] = edges * lengths[..., None]
    best = measure(TetMesh(tets.reshape(-1, 3), np.arange(160_000).reshape(-1, 4))).min_height.max()
    assert (best > 1e-3) if possible else (best < 0.0)
    blamed = [one for one in found(cut_in_eight(edges), "3wc") if one.why == fixed_vertices.TWO_HELD_ANGLES]
    assert (((0,), (0, 1, 2, 3)) in [one.cells for one in blamed]) == (not possible)


def cut_in_eight(edges):
    """A tet on three edges from the origin, cut in eight: that at the origin has its other vertices on creases."""
    middles = [edges[0] + edges[1], edges[0] + edges[2], edges[1] + edges[2]]
    points = np.concatenate([np.zeros((1, 3)), edges, 2.0 * edges, middles])
    tets = [
        [0, 1, 2, 3],
        [1, 4, 7, 8],
        [2, 7, 5, 9],
        [3, 8, 9, 6],
        [1, 2, 3, 9],
        [1, 7, 2, 9],
        [1, 8, 7, 9],
        [1, 3, 8, 9],
    ]
    mesh = TetMesh(points, np.array(tets))
    assert (measure(mesh).volume > 0).all()
    return mesh


def test_a_tet_that_stays_is_named_where_its_circumcenter_is_outside():
    flat = single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    assert [one.why for one in found(flat, "3wc", "fixed") if len(one.cells[0]) == 4] == [fixed_vertices.HELD_TET]
    assert {one.why for one in found(flat, "2wc", "fixed")} == {fixed_vertices.HELD_ANGLE}
    regular = single([[1, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1.0]])
    for goal in ("3wc", "2wc", "cwc"):
        assert found(regular, goal, "fixed") == []


@pytest.mark.parametrize("goal", ["3wc", "2wc"])
def test_no_tet_that_is_blamed_alone_is_ever_well_centered(goal):
    """Inner vertices of a cube anywhere, surface ones along their faces: those blamed alone always miss the goal."""
    mesh = jittered_cube(3)
    alone = {one.tets[0] for one in found(mesh, goal) if len(one.tets) == 1}
    assert alone
    for seed, tet in enumerate(sorted(alone)):
        points = mesh.points[mesh.tets[tet]]
        free = (points > 0.0) & (points < 1.0)
        points = points + np.random.default_rng(seed).uniform(-0.12, 0.12, points.shape) * free
        cell = np.arange(4)[None]
        if clearance(points, cell, goal) > -1.0:
            assert clearance(improved(points, cell, free, goal), cell, goal) < 1e-12


def test_fixed_vertices_hold_all_of_kuhns_boundary():
    mesh = kuhn_cube(2)
    said = found(mesh, "2wc", "fixed")
    facets = {one.cells[0] for one in said if one.why == fixed_vertices.HELD_ANGLE}
    assert {tuple(row) for row in np.sort(mesh.topology.boundary, axis=1).tolist()} <= facets
    assert found(mesh, "2wc", "slide") != said
