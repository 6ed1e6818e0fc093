"""Broken tets: what is found of them, and what repair makes of it, volume by volume."""

import numpy as np
import pytest
from support.builders import jittered_cube

from wct_plugin.errors import NoMeshError
from wct_plugin.mesh import TetMesh, faults
from wct_plugin.mesh.repair import mend
from wct_plugin.mesh.repairs import Repairs

#: A square with a point above and one below, one inside the half of corners 0, 1, 3, one on the side 0 1.
POINTS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1], [0.5, 0.5, -1], [0.25, 0.25, 0], [0.5, 0, 0]], float
)
UPPER = [[0, 1, 2, 4], [0, 2, 3, 4]]  # cut along the diagonal 0 2
LOWER = [[1, 0, 3, 5], [2, 1, 3, 5]]  # along the other
SQUARE = [0, 1, 2, 3]


def volume(points, tets):
    corners = points[tets]
    return abs(np.linalg.det(corners[:, 1:] - corners[:, :1])).sum() / 6


def mended(tets, points=POINTS, others=()):
    done = mend(points, np.array(tets), others)
    mesh = TetMesh(done.points, done.tets.cells)
    assert len(mesh.topology.adjacency) == len(mesh.tets)
    assert done.volumes[1] == pytest.approx(volume(done.points, done.tets.cells), rel=1e-14)
    return done, mesh


def test_faults_are_told_apart():
    cube = jittered_cube(2, 0)
    flat = [*cube.tets[4, :3], len(cube.points)]
    points = np.vstack([cube.points, cube.points[cube.tets[4, :3]].mean(axis=0), [np.nan, 0, 0]])
    points[-2] = points[cube.tets[4, 0]] + 0.5 * (points[cube.tets[4, 1]] - points[cube.tets[4, 0]])
    tets = np.vstack([cube.tets, cube.tets[3, ::-1], [0, 0, 1, 2], flat, [len(points) - 1, 0, 1, 2]])
    found = faults.find(points, tets)
    count = len(cube.tets)
    assert found.repeated.tolist() == [[count, 3]]
    assert found.degenerate.tolist() == [count + 1]
    assert found.not_finite.tolist() == [count + 3]
    assert not len(found.crowded)
    assert str(found).startswith(f"1 tet with coordinates that are no numbers: {count + 3}; 1 tet with a vertex twice")
    assert not faults.find(cube.points, cube.tets)


def test_repeated_and_degenerate_tets_go():
    done, mesh = mended([*UPPER, UPPER[0], [0, 1, 1, 4], [4, 2, 1, 0]])
    assert done.repairs == Repairs(repeated=2, degenerate=1)
    assert done.tets.origin.tolist() == [0, 1]
    assert done.volumes == pytest.approx((4 / 6, 2 / 6), rel=1e-14)
    assert len(mesh.topology.boundary) == 6


def test_a_flat_tet_on_the_outside_goes():
    done, mesh = mended([*UPPER, SQUARE])
    assert done.repairs == Repairs(flat=1)
    assert len(mesh.tets) == 2


def test_flat_tets_on_top_of_each_other_go_together():
    done, _ = mended([*UPPER, SQUARE, [0, 1, 3, 6]])
    assert done.repairs == Repairs(flat=2)


@pytest.mark.parametrize(
    ("tets", "count", "added", "expected"),
    [
        ([*UPPER, SQUARE, *LOWER], 8, 1, 2 / 3),  # two diagonals: a point where they cross
        ([[0, 1, 3, 4], [0, 1, 3, 6], [1, 0, 6, 5], [3, 1, 6, 5], [0, 3, 6, 5]], 6, 0, 1 / 3),  # a point in a facet
        ([[0, 1, 2, 4], [0, 1, 7, 2], [7, 0, 2, 5], [1, 7, 2, 5]], 4, 0, 1 / 3),  # a point on an edge
    ],
)
def test_a_flat_tet_inside_is_cut_away(tets, count, added, expected):
    done, mesh = mended(tets)
    assert done.repairs == Repairs(mended=1, added_points=added)
    assert len(mesh.tets) == count
    assert volume(mesh.points, mesh.tets) == pytest.approx(expected, rel=1e-14)
    # The two sides match: nothing of the plane between them is on the boundary.
    assert not (mesh.points[mesh.topology.boundary][:, :, 2] == 0).all(axis=1).any()
    if added:
        assert done.points[-1].tolist() == [0.5, 0.5, 0]
        assert sorted(done.ends[0].tolist()) == [0, 1, 2, 3]


def test_coincident_points_of_a_flat_tet_are_joined():
    points = np.vstack([POINTS, POINTS[4]])
    done, mesh = mended([UPPER[0], [0, 2, 3, 8], [0, 2, 4, 8]], points)
    assert done.repairs == Repairs(mended=1)
    assert len(mesh.topology.interior_pairs) == 1


def test_tagged_facets_and_edges_are_cut_along():
    facets, edges = np.array([[0, 2, 4], [0, 1, 4]]), np.array([[0, 2], [1, 4]])
    done, _ = mended([*UPPER, SQUARE, *LOWER], others=(facets, edges))
    cut, whole = done.others
    new = len(POINTS)
    assert {tuple(sorted(row)) for row in cut.cells.tolist()} == {(0, 4, new), (2, 4, new), (0, 1, 4)}
    assert sorted(cut.origin.tolist()) == [0, 0, 1]
    assert {tuple(sorted(row)) for row in whole.cells.tolist()} == {(0, new), (2, new), (1, 4)}


@pytest.mark.parametrize("turned", [False, True])
def test_a_tet_that_is_all_but_flat_and_one_too_many_goes(turned):
    cube = jittered_cube(2, 0)
    facet = cube.topology.triangles_of(cube.topology.interior_pairs[:1, :2])[0]
    apex = cube.points[facet].mean(axis=0) + 1e-13 * np.ptp(cube.points)
    extra = [*facet, len(cube.points)]
    if turned:
        extra[:2] = extra[1::-1]
    points, tets = np.vstack([cube.points, apex]), np.vstack([cube.tets, extra])
    assert faults.find(points, tets)
    done, mesh = mended(tets, points)
    assert done.repairs == Repairs(folded=1)
    assert len(mesh.tets) == len(cube.tets)


def test_what_cannot_be_mended_is_listed():
    inside = np.vstack([POINTS, [[0.5, 0.4, 0.5]]])
    tets = np.array([*UPPER, [0, 2, 4, 8]])  # of three tets at a facet, two overlap
    with pytest.raises(
        NoMeshError, match=r"cannot be repaired, for there stay 1 facet of three or more tets: \(0, 2, 4\)"
    ):
        mend(inside, tets)
    points = np.vstack([POINTS, [[np.nan, 0, 0]]])
    with pytest.raises(NoMeshError, match="tet 2 has coordinates that are no numbers, which cannot be repaired"):
        mend(points, np.array([*UPPER, [0, 1, 2, 8]]))
    with pytest.raises(NoMeshError, match="no tet is left"):
        mend(POINTS, np.array([SQUARE]))


def test_a_mesh_listed_the_other_way_round_is_whole():
    cube = jittered_cube(2, 0)
    for tets in (
        cube.tets[:, ::-1],
        np.where(np.arange(len(cube.tets))[:, None] % 3 == 0, cube.tets[:, ::-1], cube.tets),
    ):
        assert not faults.find(cube.points, tets)
