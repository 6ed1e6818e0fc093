"""The exterior derivative: exact sequence, Stokes, and the orders it shares with the Hodge stars."""

import numpy as np
import pytest
from scipy.sparse import diags_array
from support.builders import bcc, jittered_cube, shaken_cube, two_region_cube

from wct_plugin.measure.duals import hodge_star
from wct_plugin.measure.exterior import exterior_derivative


@pytest.mark.parametrize("mesh", [jittered_cube(2), bcc(2), two_region_cube(2)])
def test_the_sequence_is_exact_on_a_ball(mesh):
    d = [exterior_derivative(mesh, k) for k in range(3)]
    assert all((one != exterior_derivative(mesh, k)).nnz == 0 for k, one in enumerate(d))
    assert (d[1] @ d[0]).count_nonzero() == 0
    assert (d[2] @ d[1]).count_nonzero() == 0
    assert [one.shape[0] for one in d] == [len(hodge_star(mesh, k)) for k in (1, 2, 3)]
    assert d[0].shape[1] - d[0].shape[0] + d[1].shape[0] - d[2].shape[0] == 1  # Euler's number
    ranks = [np.linalg.matrix_rank(one.toarray()) for one in d]
    assert ranks == [len(mesh.points) - 1, d[0].shape[0] - ranks[0], len(mesh.tets)]


def test_gradient_circulation_and_flux_of_linear_fields():
    mesh = jittered_cube(3, 2)
    points, topology = mesh.points, mesh.topology
    slope, turn = np.array([1.0, 2.0, -3.0]), np.array([0.3, -1.0, 0.7])
    along = points[topology.edges[:, 1]] - points[topology.edges[:, 0]]
    assert exterior_derivative(mesh, 0) @ (points @ slope) == pytest.approx(along @ slope)
    # The field turn x X has the curl 2 turn; X has the divergence 3. Midpoints integrate linear fields exactly.
    circulation = np.einsum("ek,ek->e", np.cross(turn, points[topology.edges].mean(axis=1)), along)
    corners = points[topology.facets]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2.0
    assert exterior_derivative(mesh, 1) @ circulation == pytest.approx(areas @ (2.0 * turn), abs=1e-14)
    flux = np.einsum("fk,fk->f", corners.mean(axis=1), areas)
    assert exterior_derivative(mesh, 2) @ flux == pytest.approx(3.0 / hodge_star(mesh, 3))


def test_laplacian_of_linear_functions_is_zero_inside_whatever_the_signs_of_the_star():
    """The faces of a dual cell close, also where some are inside out: sum of area times normal is zero."""
    mesh = shaken_cube(3)
    d0 = exterior_derivative(mesh, 0)
    laplacian = d0.T @ diags_array(hodge_star(mesh, 1)) @ d0
    inner = ~mesh.topology.boundary_points
    assert (hodge_star(mesh, 1) < 0).any()
    assert np.abs((laplacian @ mesh.points)[inner]).max() < 1e-13


def test_there_are_three():
    with pytest.raises(ValueError, match="k is 3"):
        exterior_derivative(bcc(2), 3)
