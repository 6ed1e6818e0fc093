"""What is plane comes back plane, whatever a file rounded; judged by NumPy alone."""

import numpy as np
import pytest
from support.builders import kuhn_cube

from wct_plugin import apply_filter
from wct_plugin.errors import WctWarning
from wct_plugin.mesh import SurfaceMesh, TetMesh


def turned_cube(n):
    axes, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    cube = kuhn_cube(n)
    return TetMesh((cube.points @ axes.T).astype(np.float32), cube.tets), axes


def heights(mesh, axes):
    """(6, b) distance of the boundary's vertices from the cube's faces."""
    local = mesh.points[np.unique(mesh.topology.boundary)] @ axes
    return np.concatenate([local.T, 1.0 - local.T])


def test_a_turned_cube_of_single_precision_keeps_its_planes():
    mesh, axes = turned_cube(3)
    better, found = apply_filter("meshing_well_centered", mesh)
    assert found["bad"] == 0
    assert found["planes"]["planes"] == 6
    off = np.abs(heights(better, axes))
    assert off.min(axis=0).max() < 3e-7  # as the file has them
    for face in off:
        own = better.points[np.unique(better.topology.boundary)][face < 3e-7]
        assert np.linalg.svd(own - own.mean(axis=0), full_matrices=False)[1][-1] < 3e-15 * np.sqrt(len(own))


def test_planes_can_be_left_as_they_came():
    mesh, axes = turned_cube(3)
    better, found = apply_filter("meshing_well_centered", mesh, planes="input", allow_released=True)
    assert found["planes"] is None
    assert np.abs(heights(better, axes)).min(axis=0).max() > 1e-6


def test_the_planes_of_a_reference_whose_seams_differ_by_rounding():
    cube = kuhn_cube(4)
    soup = cube.points[cube.topology.boundary].reshape(-1, 3)
    soup = soup + 1e-10 * np.random.default_rng(0).normal(size=soup.shape)
    surface = SurfaceMesh(soup, np.arange(len(soup)).reshape(-1, 3))
    with pytest.warns(WctWarning, match=r"points differ from others by rounding only; they are merged"):
        better, found = apply_filter("meshing_well_centered", cube, reference=surface)
    assert found["bad"] == 0
    assert found["planes"]["axis"] == 6
    own = better.points[np.unique(better.topology.boundary)]
    for k in range(3):
        for side in (0.0, 1.0):
            assert len(np.unique(own[np.abs(own[:, k] - side) < 1e-8, k])) == 1
    assert np.minimum(np.abs(own), np.abs(1.0 - own)).min(axis=1).max() < 1e-9
