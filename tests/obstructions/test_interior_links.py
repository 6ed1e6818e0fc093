"""Inner vertices: too few edges never do, however hard one tries; a few more do."""

import numpy as np
import pytest
from support.builders import bcc
from support.trying import clearance, improved, star

from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import find_strata
from wct_plugin.obstructions import find_reasons, interior_links


def found(points, tets, goal, connectivity="fixed"):
    mesh = TetMesh(points, tets)
    every = np.arange(len(tets))
    said = find_reasons(mesh, find_strata(mesh), every, goal=goal, boundary="slide", connectivity=connectivity)
    return [one for one in said if one.cells[0] == (0,)]


def best_of(count, goal, seeds):
    """The largest clearance that stars of ``count`` edges come to when all their vertices move."""
    best = -1.0
    for seed in seeds:
        points, tets = star(count, seed)
        free = np.ones_like(points, dtype=bool)
        free[0] = False
        best = max(best, clearance(improved(points, tets, free, goal), tets, goal))
    return best


@pytest.mark.parametrize(("goal", "needed"), [("3wc", 6), ("2wc", 9), ("cwc", 9)])
def test_too_few_edges_are_named_with_their_vertex(goal, needed):
    for count in range(4, 12):
        points, tets = star(count, 0)
        said = [
            one
            for one in found(points, tets, goal)
            if one.why in (interior_links.FEW_FOR_3WC, interior_links.FEW_FOR_ACUTE)
        ]
        assert [one.cells for one in said] == ([((0,),)] if count < needed else [])
        assert all(one.tets == tuple(range(len(tets))) for one in said)
        assert found(points, tets, goal, connectivity="free") == []


@pytest.mark.parametrize(("count", "goal"), [(4, "3wc"), (5, "3wc"), (4, "2wc"), (6, "2wc"), (7, "2wc"), (8, "2wc")])
def test_too_few_edges_never_meet_the_goal(count, goal):
    assert best_of(count, goal, range(6)) < 1e-12


@pytest.mark.parametrize(("count", "goal"), [(8, "3wc"), (9, "2wc"), (12, "cwc")])
def test_a_few_more_edges_do(count, goal):
    assert any(best_of(count, goal, [seed]) > 0.03 for seed in range(8))


def test_an_edge_that_nearly_all_neighbours_surround_is_named():
    """A double pyramid of 8 sides has 10 edges, and 8 tets at each of the two long ones: one neighbour is elsewhere."""
    angle = np.arange(8) * np.pi / 4
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(8)])
    points = np.concatenate([np.zeros((1, 3)), ring, [[0, 0, 1.0], [0, 0, -1.0]]])
    tets = [[0, k + 1, (k + 1) % 8 + 1, 9] for k in range(8)] + [[0, (k + 1) % 8 + 1, k + 1, 10] for k in range(8)]
    crowded = [one for one in found(points, np.array(tets), "cwc") if one.why == interior_links.CROWDED]
    assert [one.cells for one in crowded] in ([((0,), (0, 9))], [((0,), (0, 10))])
    rng = np.random.default_rng(0)
    free = np.ones_like(points, dtype=bool)
    free[0] = False
    start = points + rng.normal(0, 0.1, points.shape) * free
    assert clearance(improved(start, np.array(tets), free, "2wc"), np.array(tets), "2wc") < 1e-12
    assert [one for one in found(points, np.array(tets), "3wc") if one.why == interior_links.CROWDED] == []


@pytest.mark.parametrize("goal", ["3wc", "2wc", "cwc"])
def test_nothing_is_said_about_the_inside_of_a_well_centered_mesh(goal):
    mesh = bcc(3)
    every = np.arange(len(mesh.tets))
    said = find_reasons(mesh, find_strata(mesh), every, goal=goal, boundary="slide", connectivity="fixed")
    inside = {(v,) for v in np.flatnonzero(~mesh.topology.boundary_points).tolist()}
    assert inside
    assert not inside & {one.cells[0] for one in said}
