"""A crease that fades out on a smooth surface has that surface on both of its sides, and is a crease all the same."""

import numpy as np
import pytest
from support.builders import kuhn_grid
from support.core_meshes import start

from wct_plugin.mesh import TetMesh
from wct_plugin.meshing.reference import own_boundary

BENT = 1 - np.tan(np.radians(20.0))  # up to here the ridge bends by more than 40 degrees


def roof(n: int) -> TetMesh:
    """A unit cube whose top falls to both sides of a ridge above y = 1/2: by 45 degrees at x = 0, by none at x = 1."""
    grid = kuhn_grid((n, n, n // 2))
    x, y, z = (grid.points / grid.points.max(axis=0)).T
    return TetMesh(np.stack([x, y, z * (1.0 - (1.0 - x) * np.abs(y - 0.5))], axis=1), grid.tets)


def on_ridge(points, segments):
    return (np.abs(points[segments] - [0.0, 0.5, 1.0])[:, :, 1:] < 1e-9).all(axis=(1, 2))


@pytest.fixture(scope="module")
def mesh():
    return roof(12)


@pytest.fixture(scope="module")
def own(mesh):
    return own_boundary(mesh, 40.0)


def test_it_has_one_patch_on_both_sides(own):
    segments = own.strata.segments[on_ridge(own.points, own.strata.segments)]
    assert len(segments) == np.ceil(12 * BENT)
    for a, b in segments:
        beside = (own.strata.triangles == a).any(axis=1) & (own.strata.triangles == b).any(axis=1)
        assert len(np.unique(own.strata.patch[beside])) == 1


@pytest.fixture(scope="module")
def found(mesh, own):
    return start(mesh, own)


def test_its_edges_are_creases_of_the_new_mesh_without_a_gap(found):
    mesh = found.mesh
    along = np.sort(mesh.points[mesh.creases[on_ridge(mesh.points, mesh.creases)]][:, :, 0], axis=1)
    along = along[np.argsort(along[:, 0])]
    assert along[0, 0] == 0.0
    assert along[-1, 1] == np.ceil(12 * BENT) / 12
    assert np.array_equal(along[1:, 0], along[:-1, 1])


def test_it_does_not_count_as_a_bend_of_the_surface(found):
    # The top is a saddle, z = 1 - (1 - x) |1/2 - y|, of curvatures below 1: at the tolerance it needs no finer edges.
    # Past its end the ridge is a bend, and sizes shrink towards there.
    on = np.unique(found.mesh.creases[on_ridge(found.mesh.points, found.mesh.creases)])
    on = on[found.mesh.points[on, 0] < 0.3]
    assert found.mesh.size[on].min() > 0.8 * np.median(found.mesh.size)
