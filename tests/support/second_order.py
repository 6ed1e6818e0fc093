"""Meshes of second order, made by gmsh, and their volumes by a rule that shares no line with the package."""

from collections.abc import Callable
from itertools import product
from pathlib import Path

import gmsh
import meshio
import numpy as np
from numpy.typing import NDArray
from support.gmsh_session import gmsh_session

#: Ends of the edges with mid nodes, as VTK has them.
EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))


def made(path: Path, build: Callable[[], None], size: float, order: int = 2) -> Path:
    """Mesh what ``build`` makes with OpenCASCADE, all volumes and surfaces in groups."""
    with gmsh_session():
        build()
        gmsh.model.occ.synchronize()
        for dimension, tag in gmsh.model.getEntities():
            if dimension == 3:
                gmsh.model.addPhysicalGroup(3, [tag], tag, name=f"body {tag}")
        gmsh.model.addPhysicalGroup(2, [tag for _, tag in gmsh.model.getEntities(2)], 100, name="skin")
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        gmsh.write(str(path))
    return path


def cylinder() -> None:
    """Half a unit of radius, one high."""
    gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, 1, 0.5)


def tens(mesh: meshio.Mesh) -> NDArray[np.float64]:
    """(m, 10, 3) the nodes of all tets with ten."""
    return np.concatenate([mesh.points[block.data] for block in mesh.cells if block.type == "tetra10"])


def volumes(nodes: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """(m,) volumes of tets with nodes (m, 10, 3), and the smallest Jacobian at the points of the rule."""
    at, weight = np.polynomial.legendre.leggauss(4)
    at, weight = (at + 1) / 2, weight / 2
    total, least = np.zeros(len(nodes)), np.inf
    slopes = np.array([[-1, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    for (a, wa), (b, wb), (c, wc) in product(zip(at, weight, strict=True), repeat=3):
        r, s, t = a, b * (1 - a), c * (1 - a) * (1 - b)
        share = np.array([1 - r - s - t, r, s, t])
        change = [(4 * share[i] - 1) * slopes[i] for i in range(4)]
        change += [4 * (share[i] * slopes[j] + share[j] * slopes[i]) for i, j in EDGES]
        jacobian = np.linalg.det(np.einsum("mkx,kd->mxd", nodes, np.array(change)))
        total += jacobian * wa * wb * wc * (1 - a) ** 2 * (1 - b)
        least = min(least, float(jacobian.min()))
    return total, least
