"""Counts of negative duals, against the slow definition and on grids that are exactly in between."""

import numpy as np
import pytest
from support.builders import bcc, kuhn_cube, rotation, shaken_cube, single
from support.flags import signed_duals

from wct_plugin.measure.duals import compute_duals, tiers
from wct_plugin.measure.negative_duals import CELLS, HEAD, count_negative_duals
from wct_plugin.mesh import TetMesh


@pytest.mark.parametrize("seed", range(2))
def test_counts_are_those_of_the_definition(seed):
    mesh = shaken_cube(3, seed)
    found = count_negative_duals(mesh, compute_duals(mesh))
    border = [tuple(sorted(facet)) for facet in mesh.topology.boundary.tolist()]
    faces = {face for facet in border for face in [facet, *((v,) for v in facet)]}
    faces |= {(a, b) for f in border for a in f for b in f if a < b}
    for k, by_definition in enumerate(signed_duals(mesh)):
        for place, outside in ((found.interior[k], False), (found.boundary[k], True)):
            values = [value for face, value in by_definition.items() if (face in faces) == outside]
            assert (place.count, place.negative, place.zero) == (len(values), sum(v < 0 for v in values), 0)
    assert sum(one.negative for one in found.interior + found.boundary) > 20
    assert found.to_dict()["star1"]["boundary"] == vars(found.boundary[1])
    assert all(len(row) == len(HEAD) for row in found.rows())
    assert found.rows()[2][:2] == (f"★2: {CELLS[2]}", f"{found.interior[2].negative} of {found.interior[2].count}")


@pytest.mark.parametrize("turn", [np.eye(3), 1e-3 * rotation(1)])
def test_zero_is_neither_sign(turn):
    """Kuhn's grid: six cospherical tets per cube, so the duals of diagonals are zero, however the grid was rounded."""
    mesh = kuhn_cube(3)
    found = count_negative_duals(mesh, of=compute_duals(turned := TetMesh(mesh.points @ turn.T, mesh.tets)))
    assert [one.negative for one in found.interior + found.boundary] == [0] * 6
    lattice = 3 * 3 * 4 * 4
    edges, facets = len(turned.topology.edges), len(turned.topology.facets)
    assert sum(one.zero for one in (found.interior[1], found.boundary[1])) == edges - lattice  # all the diagonals
    through_cubes = 6 * 27  # interior facets of the cubes; the others lie between two cubes or on the boundary
    border = len(turned.topology.boundary)
    assert sum(one.zero for one in (found.interior[2], found.boundary[2])) == through_cubes
    assert found.boundary[2].count + found.interior[2].count == facets == through_cubes + 2 * 54 + border


def test_none_where_all_tets_are_completely_well_centered():
    found = count_negative_duals(bcc(3), compute_duals(bcc(3)))
    assert found.none
    assert (found.interior[0].count, found.boundary[0].count) == tuple(np.bincount(bcc(3).topology.boundary_points))
    assert not count_negative_duals(kuhn_cube(2), compute_duals(kuhn_cube(2))).none


def test_3wc_is_not_enough_at_an_obtuse_boundary_triangle():
    """Inside all duals are positive then; on the boundary they are only where its triangles are acute."""
    obtuse = single([[-0.88, 0.42, -0.22], [-0.51, 0.74, -0.45], [-0.06, 0.97, -0.23], [0.67, -0.67, 0.32]])
    assert tiers(obtuse).name == "3WC"
    found = count_negative_duals(obtuse, compute_duals(obtuse))
    assert [one.negative for one in found.boundary] == [sum(v < 0 for v in of.values()) for of in signed_duals(obtuse)]
    assert (found.none, found.boundary[1].negative, found.boundary[2].negative) == (False, 2, 0)
    assert compute_duals(obtuse).areas.min() == pytest.approx(-0.129, abs=1e-3)
