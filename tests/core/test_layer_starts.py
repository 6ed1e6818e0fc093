"""New starts of stacked layers: every plane is made of facets, and edges at a rim are as short as in the layer."""

import numpy as np
import pytest
from support.builders import kuhn_grid, rotation
from support.core_meshes import start

from wct_plugin.mesh import TetMesh
from wct_plugin.meshing.reference import own_boundary


def stack(heights, cells, seed):
    """Boxes of 1 by .8 on each other, a region each, meshed coarsely, in a general position."""
    grid = kuhn_grid((*cells, len(heights)))
    levels = np.concatenate([[0.0], np.cumsum(heights)])
    points = np.column_stack([grid.points[:, :2] * np.array([1.0, 0.8]) / cells, levels[grid.points[:, 2].astype(int)]])
    region = np.floor(grid.points[grid.tets][:, :, 2].mean(axis=1)).astype(np.int64)
    turn = rotation(seed).T
    return TetMesh(points @ turn, grid.tets, regions=region + 1), turn


def heights_off(found, own, turn):
    """How far the corners of each facet are from the plane of its patch."""
    at = own.points @ turn.T
    new = found.mesh.points @ turn.T
    off = []
    for patch in np.unique(found.mesh.facet_patch):
        corners = at[np.unique(own.strata.triangles[own.strata.patch == patch])]
        axis = np.ptp(corners, axis=0).argmin()
        off.append(np.abs(new[found.mesh.facets[found.mesh.facet_patch == patch]][..., axis] - corners[0, axis]).max())
    return np.array(off)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("heights", [(0.3, 0.05, 0.05, 0.3), (0.04, 0.6), (0.3, 0.04, 0.3)], ids=["two", "top", "one"])
def test_planes_of_layers_are_made_of_facets(heights, seed):
    mesh, turn = stack(heights, (6, 5), seed)
    own = own_boundary(mesh, 40.0)
    found = start(mesh, own, seed=seed)
    assert found.intact
    assert heights_off(found, own, turn).max() < 1e-12


def test_edges_at_the_rim_of_a_layer_are_as_short_as_in_it():
    """The walls beside it are long, and most of what is round a vertex of the rim is theirs."""
    thickness = 0.04
    mesh, turn = stack((thickness, 0.6), (6, 5), 1)
    found = start(mesh, own_boundary(mesh, 40.0))
    points = found.mesh.points @ turn.T
    rim = (np.abs(points[:, 2] - thickness) < 1e-12) & (found.mesh.stratum == 2)
    assert found.mesh.size[rim].max() < 1.5 * thickness
    creases = found.mesh.creases[rim[found.mesh.creases].all(axis=1)]
    assert np.linalg.norm(np.diff(points[creases], axis=1), axis=-1).max() < 2.0 * thickness
