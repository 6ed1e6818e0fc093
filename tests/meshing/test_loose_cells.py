"""Tagged cells that no tet has are left out before the work, and named."""

import warnings

import numpy as np
import pytest

import wct_plugin as wct
from wct_plugin.errors import WctWarning
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.meshing import loose_cells


@pytest.fixture(scope="module")
def cube():
    return wct.apply_filter("create_cube", variant="84")[0]


def test_a_mesh_without_any_stays_as_it_is(cube):
    mesh = TetMesh(cube.points, cube.tets, facets=Cells(cube.topology.facets, None), edges=Cells(cube.topology.edges))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert loose_cells.without(mesh) is mesh


def test_they_are_named_and_left_out_with_their_sets(cube):
    far = int(np.argmax(np.linalg.norm(cube.points - cube.points[0], axis=1)))
    other = cube.tets[-1][cube.tets[-1] != far][0]
    facets = np.vstack([cube.topology.boundary[:3], [[0, other, far]]])
    mesh = TetMesh(
        cube.points,
        cube.tets,
        facets=Cells(facets, [1, 2, 3, 9], sets={"odd": [2, 3]}),
        edges=Cells([[0, far], cube.topology.edges[0]], [4, 5], sets={"diagonal": [0]}),
    )
    with pytest.warns(WctWarning) as said:
        kept = loose_cells.without(mesh)
    assert [str(one.message) for one in said] == [
        f"the mesh: no tet has triangle 3, vertices (0, {other}, {far}), nor line 0, vertices (0, {far}): not kept"
    ]
    assert np.array_equal(kept.facets.vertices, facets[:3])
    assert kept.facets.tags.tolist() == [1, 2, 3]
    assert kept.facets.sets["odd"].tolist() == [2]
    assert kept.edges.tags.tolist() == [5]
    assert not len(kept.edges.sets["diagonal"])


def test_the_optimiser_says_so_and_counts_no_group_as_lost(cube):
    far = int(np.argmax(np.linalg.norm(cube.points - cube.points[0], axis=1)))
    mesh = TetMesh(cube.points, cube.tets, edges=Cells([[0, far]], [4], sets={"diagonal": [0]}))
    with pytest.warns(WctWarning, match="line 0, vertices"):
        made, metrics = wct.apply_filter("meshing_well_centered", mesh)
    assert metrics["losses"] == []
    assert metrics["pinned"]["edges"] == 0
    assert not len(made.edges)
