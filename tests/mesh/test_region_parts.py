"""Regions taken apart: the same tets, and interfaces that are boundary twice."""

import numpy as np
from support.builders import kuhn_cube, two_region_cube

from wct_plugin.mesh.region_parts import apart


def test_the_tets_stay_and_interfaces_are_boundary_on_both_sides():
    mesh = two_region_cube(3)
    parts = apart(mesh)
    assert np.array_equal(parts.points[parts.tets], mesh.points[mesh.tets])
    assert np.array_equal(parts.regions, mesh.regions)
    interfaces = len(mesh.topology.interface_pairs)
    assert interfaces > 0
    assert len(parts.topology.boundary) == len(mesh.topology.boundary) + 2 * interfaces
    assert len(parts.topology.interface_pairs) == 0
    assert len(parts.points) == len(mesh.points) + len(np.unique(mesh.topology.interfaces))


def test_one_region_is_the_mesh_itself():
    cube = kuhn_cube(2)
    assert apart(cube) is cube
