"""Finite volumes with two-point fluxes beside scikit-fem's linear elements: gmsh's mesh of a cube, and well-centered.

One unknown per tet, at its circumcenter; what flows through a facet is the difference of its two tets' values times
area over distance, which is 1 / *2. Consistent, because the line between circumcenters is perpendicular to the facet,
as long as it runs the right way: where a circumcenter lies beyond its neighbour's, the flux runs uphill. Linear
elements have some positive off-diagonal entries on either mesh (tets with obtuse dihedral angles); the two-point flux
has none on the well-centered one, so that no value exceeds the data. Run it: ``python examples/two_point_flux.py``.
"""

import numpy as np
from poisson_and_heat import SIZES, cube
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import spsolve
from skfem import Basis, BilinearForm, ElementTetP1, LinearForm, MeshTet, condense, solve
from skfem.helpers import dot, grad

import wct_plugin as wct
from wct_plugin.measure import quality
from wct_plugin.measure.duals import hodge_star
from wct_plugin.measure.exterior import exterior_derivative


def exact(points: np.ndarray) -> np.ndarray:
    """Solution at points (..., 3), zero on the cube's surface; its negative Laplacian is 3 pi^2 times itself."""
    return np.sin(np.pi * points).prod(axis=-1)


def two_point(mesh: wct.TetMesh) -> csr_array:
    """What flows out of each tet (m, m); through the cube's surface to the value zero there."""
    divergence = exterior_derivative(mesh, 2)
    return (divergence @ diags_array(1.0 / hodge_star(mesh, 2)) @ divergence.T).tocsr()


def two_point_error(mesh: wct.TetMesh) -> float:
    """Relative error in L2, at the circumcenters."""
    volumes, truth = quality.volumes(mesh.points, mesh.tets), exact(quality.circumcenters(mesh.points, mesh.tets))
    found = spsolve(two_point(mesh).tocsc(), 3.0 * np.pi**2 * volumes * truth)
    return float(np.sqrt((volumes * (found - truth) ** 2).sum() / (volumes * truth**2).sum()))


def elements(mesh: wct.TetMesh) -> tuple[csr_array, float]:
    """Linear elements' stiffness inside, and their relative error in L2, at the vertices."""
    basis = Basis(MeshTet(mesh.points.T.copy(), mesh.tets.T.copy()), ElementTetP1())
    stiffness = BilinearForm(lambda u, v, _: dot(grad(u), grad(v))).assemble(basis)
    load = LinearForm(lambda v, w: 3.0 * np.pi**2 * exact(np.moveaxis(np.asarray(w.x), 0, -1)) * v).assemble(basis)
    found = solve(*condense(stiffness, load, D=basis.get_dofs()))
    truth = exact(mesh.points)
    weights = np.bincount(mesh.tets.ravel(), np.repeat(quality.volumes(mesh.points, mesh.tets), 4))
    inside = ~mesh.topology.boundary_points
    error = np.sqrt((weights * (found - truth) ** 2).sum() / (weights * truth**2).sum())
    return csr_array(stiffness)[inside][:, inside], float(error)


def wrong_signs(matrix: csr_array) -> int:
    """Pairs with a positive off-diagonal entry: the one pulls the other away from itself."""
    entries = matrix.tocoo()
    return int(((entries.row < entries.col) & (entries.data > 1e-9 * np.median(abs(entries.data)))).sum())


def main() -> float:
    """Give the two-point flux's error over that of linear elements, on the finest well-centered mesh."""
    meshes = [cube(size) for size in SIZES]
    better = [wct.apply_filter("meshing_well_centered", mesh, goal="3wc")[0] for mesh in meshes]
    errors = [two_point_error(mesh) for mesh in better]
    order = float(np.polyfit(np.log([len(mesh.tets) ** (-1 / 3) for mesh in better]), np.log(errors), 1)[0])
    before, after = (wrong_signs(two_point(mesh)) for mesh in (meshes[-1], better[-1]))
    matrix, linear = elements(better[-1])
    print(
        f"fluxes that run uphill: {before} -> {after}, linear elements {wrong_signs(matrix)}; error "
        f"{two_point_error(meshes[-1]):.4f} -> {errors[-1]:.4f}, linear elements {linear:.4f}; order {order:.2f}"
    )
    assert before > 0 == after < wrong_signs(matrix)
    assert order > 1.9
    assert errors[-1] < linear
    return errors[-1] / linear


if __name__ == "__main__":
    main()
