"""Counts of negative duals, against the slow definition and on grids that are exactly in between."""

import numpy as np
import pytest
from builders import bcc, jittered_cube, kuhn_cube, rotation, shaken_cube
from flags import signed_duals

from wct_plugin.duals import duals
from wct_plugin.mesh import TetMesh
from wct_plugin.negative_duals import CELLS, HEAD, negative_duals


@pytest.mark.parametrize("seed", range(2))
def test_counts_are_those_of_the_definition(seed):
    mesh = shaken_cube(3, seed)
    found = negative_duals(mesh, duals(mesh))
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
    found = negative_duals(mesh, of=duals(turned := TetMesh(mesh.points @ turn.T, mesh.tets)))
    assert [one.negative for one in found.interior + found.boundary] == [0] * 6
    lattice = 3 * 3 * 4 * 4
    edges, facets = len(turned.topology.edges), len(turned.topology.facets)
    assert sum(one.zero for one in (found.interior[1], found.boundary[1])) == edges - lattice  # all the diagonals
    through_cubes = 6 * 27  # interior facets of the cubes; the others lie between two cubes or on the boundary
    border = len(turned.topology.boundary)
    assert sum(one.zero for one in (found.interior[2], found.boundary[2])) == through_cubes
    assert found.boundary[2].count + found.interior[2].count == facets == through_cubes + 2 * 54 + border


def test_none_where_all_tets_contain_their_circumcenter():
    for mesh in (bcc(3), jittered_cube(3)):
        found = negative_duals(mesh, duals(mesh))
        assert (found.interior[0].count, found.boundary[0].count) == tuple(np.bincount(mesh.topology.boundary_points))
    found = negative_duals(bcc(3), duals(bcc(3)))
    assert [one.negative + one.zero for one in found.interior + found.boundary] == [0] * 6
