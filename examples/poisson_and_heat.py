"""Poisson's equation and heat with diagonal Hodge stars: gmsh's mesh of a cube, and the same made well-centered.

The stiffness is d0' *1 d0, the mass *0, both from circumcentric duals. Where a dual area is negative, an off-diagonal
entry of the stiffness is positive, and one step of the heat equation, from heat at one vertex, makes its neighbour
colder than anything was: the maximum principle is lost. Where every tet contains its circumcenter it holds, and the
solution of Poisson's equation is of second order. Run it: ``python examples/poisson_and_heat.py``.
"""

from collections.abc import Callable

import gmsh
import numpy as np
from scipy.sparse import diags_array
from scipy.sparse.linalg import spsolve

import wct_plugin as wct
from wct_plugin.measure import quality
from wct_plugin.measure.duals import compute_duals, hodge_star
from wct_plugin.measure.exterior import exterior_derivative

SIZES = (0.2, 0.14, 0.1)


def cube(size: float) -> wct.TetMesh:
    """The unit cube as gmsh fills it with edges of about ``size``."""
    return from_gmsh(lambda: gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1), size)


def from_gmsh(draw: Callable[[], object], size: float) -> wct.TetMesh:
    """What gmsh makes of the solid that ``draw`` adds to its model."""
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    draw()
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.model.mesh.generate(3)
    tags, points, _ = gmsh.model.mesh.getNodes()
    _, corners = gmsh.model.mesh.getElementsByType(4)
    gmsh.finalize()
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    return wct.TetMesh(points.reshape(-1, 3), place[corners.astype(np.int64).reshape(-1, 4)])


def operators(mesh: wct.TetMesh):
    """Stiffness (n, n) and lumped mass (n,) on the vertices."""
    dual = compute_duals(mesh)
    d0 = exterior_derivative(mesh, 0)
    return (d0.T @ diags_array(hodge_star(mesh, 1, dual)) @ d0).tocsr(), hodge_star(mesh, 0, dual)


def poisson_error(mesh: wct.TetMesh) -> float:
    """Relative error in L2 for a solution that oscillates once over the mesh, its values given at the boundary."""
    stiffness, mass = operators(mesh)
    waves = np.pi / np.ptp(mesh.points, axis=0).max()
    exact = np.sin(waves * (mesh.points - mesh.points.min(axis=0)) + 0.1).prod(axis=1)
    inside, border = np.flatnonzero(~mesh.topology.boundary_points), np.flatnonzero(mesh.topology.boundary_points)
    source = (3.0 * waves**2 * mass * exact)[inside] - stiffness[inside][:, border] @ exact[border]
    wrong = spsolve(stiffness[inside][:, inside].tocsc(), source) - exact[inside]
    # The norm weighs a vertex with a quarter of each of its tets, whatever the duals are like.
    quarters = np.repeat(quality.volumes(mesh.points, mesh.tets) / 4.0, 4)
    weights = np.bincount(mesh.tets.ravel(), quarters)
    return float(np.sqrt((weights[inside] * wrong**2).sum() / (weights * exact**2).sum()))


def coldest(mesh: wct.TetMesh) -> float:
    """The lowest temperature, over the highest, after a short implicit step from heat at one end of the worst edge."""
    stiffness, mass = operators(mesh)
    edge = np.argmin(hodge_star(mesh, 1))
    heat = np.zeros(len(mass))
    heat[mesh.topology.edges[edge, 0]] = 1.0
    step = 1e-2 * float(np.median(mass) / np.median(stiffness.diagonal()))
    after = spsolve((diags_array(mass) + step * stiffness).tocsc(), mass * heat)
    return float(after.min() / after.max())


def main() -> float:
    """Give the order of the error in the mesh size on the well-centered meshes."""
    meshes = [cube(size) for size in SIZES]
    better = [wct.apply_filter("meshing_well_centered", mesh, goal="3wc")[0] for mesh in meshes]
    duals_of = [compute_duals(mesh) for mesh in (meshes[-1], better[-1])]
    negative = [int((of.areas < -of.area_errors).sum()) for of in duals_of]
    lowest = [coldest(mesh) for mesh in (meshes[-1], better[-1])]
    sizes = [len(mesh.tets) ** (-1 / 3) for mesh in better]
    errors = [poisson_error(mesh) for mesh in better]
    order = float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])
    print(
        f"negative dual areas: {negative[0]} -> {negative[1]}; coldest after a step of heat: {lowest[0]:.1e} -> "
        f"{lowest[1]:.1e}; Poisson's error {errors[0]:.4f} -> {errors[-1]:.4f}, order {order:.2f}"
    )
    assert negative[0] > 0 == negative[1]
    assert lowest[0] < -1e-5
    assert lowest[1] > -1e-15
    assert order > 1.9
    return order


if __name__ == "__main__":
    main()
