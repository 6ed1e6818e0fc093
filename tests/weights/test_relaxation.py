"""Rows against the weighted dual they stand for; descent for fewer misses, then for margin."""

import numpy as np
import pytest
from support.builders import jittered_cube, shaken_cube

from wct_plugin.measure.duals import compute_duals
from wct_plugin.weights.relaxation import relax, widen
from wct_plugin.weights.rows import contained, local_length, lowest, make_rows, rows_of


def test_rows_and_duals_are_those_of_the_weighted_dual():
    mesh = jittered_cube(3)
    rows = make_rows(mesh)
    weights = np.random.default_rng(0).uniform(0.0, 0.1, len(mesh.points))
    values = rows.at(weights)
    lengths = compute_duals(mesh, weights * rows.unit).lengths
    pairs = mesh.topology.interior_pairs
    mean = local_length(mesh)[pairs[:, [0, 2]]].mean(axis=1)
    facets = mesh.topology.tet_facets[pairs[:, 0], pairs[:, 1]]
    assert rows.duals @ values * mean == pytest.approx(lengths[facets])


def test_near_a_tet_is_what_is_reached_along_edges():
    mesh = jittered_cube(4)
    rows = make_rows(mesh)
    for tet, rings in ((0, 0), (100, 1), (200, 2)):
        reached = np.zeros(len(mesh.points), dtype=bool)
        reached[mesh.tets[tet]] = True
        for _ in range(rings):
            for a, b in mesh.topology.edges[reached[mesh.topology.edges].any(axis=1)]:
                reached[[a, b]] = True
        vertices, cells = rows.near(tet, rings)
        assert vertices.tolist() == np.flatnonzero(reached).tolist()
        assert cells.tolist() == np.flatnonzero(reached[mesh.tets].any(axis=1)).tolist()


def test_a_part_says_what_changing_a_few_weights_does():
    mesh = jittered_cube(3)
    rows = make_rows(mesh)
    free, cells = rows.near(50, 1)
    at = rows_of(cells)
    part, of_all = rows.part(at, free)
    weights = np.zeros(len(mesh.points))
    weights[free] = np.linspace(0.0, 0.1, len(free))
    before, after = rows.at(np.zeros(len(weights))), rows.at(weights)
    assert part @ weights[free] == pytest.approx(np.append((after - before)[at], of_all @ (after - before)))
    elsewhere = np.setdiff1d(np.arange(len(before)), at)
    assert np.array_equal(before[elsewhere], after[elsewhere])


def test_descent_leaves_fewer_without_and_widening_loses_none():
    mesh = shaken_cube(3)
    rows = make_rows(mesh)
    values = rows.at(np.zeros(len(mesh.points)))
    *_, weights = relax(rows, np.zeros(len(mesh.points)))
    relaxed = rows.at(weights)
    assert contained(relaxed).sum() > 1.5 * contained(values).sum()
    kept = contained(relaxed)
    for wider in widen(rows, weights, 0.1):
        assert contained(rows.at(wider))[kept].all()
        assert (lowest(rows.at(wider))[~kept] >= np.minimum(lowest(relaxed)[~kept], 0.0)).all()
    assert np.minimum(lowest(rows.at(wider))[kept], 0.1).sum() > np.minimum(lowest(relaxed)[kept], 0.1).sum()
