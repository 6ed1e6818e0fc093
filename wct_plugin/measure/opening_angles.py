"""The angles that a mesh's surface leaves to its tets: between its sheets at an edge, on a patch at a corner."""

import numpy as np

from wct_plugin.measure import quality
from wct_plugin.mesh import TetMesh, unit_scaling
from wct_plugin.mesh.strata import Strata
from wct_plugin.mesh.topology import EDGES
from wct_plugin.types import Floats, Ints


def wedge_angles(mesh: TetMesh, tets: Ints) -> Floats:
    """(k, 6) sum, in degrees, of the dihedral angles at each edge of ``tets`` (k,) over all tets of its region there.

    At a surface edge that is how far the region opens (where it opens more than once, all that together), elsewhere
    360. Columns as :data:`wct_plugin.mesh.topology.EDGES`.
    """
    touched = np.zeros(len(mesh.points), dtype=bool)
    touched[mesh.tets[tets]] = True
    near = np.flatnonzero(touched[mesh.tets].sum(axis=1) >= 2)
    ends = np.sort(mesh.tets[near][:, EDGES], axis=2).reshape(-1, 2)
    edges = np.column_stack([ends, np.repeat(mesh.regions[near], len(EDGES))])
    _, edge = np.unique(edges, axis=0, return_inverse=True)
    edge = edge.reshape(-1, len(EDGES))
    total = np.zeros(int(edge.max(initial=-1)) + 1)
    np.add.at(total, edge, quality.dihedral_angles(mesh.points, mesh.tets[near]))
    return total[edge[np.searchsorted(near, tets)]]


def corner_angles(points: Floats, of: Strata) -> tuple[Ints, Floats]:
    """Corners (c,), one row per patch that meets there, and the angle in degrees the patch's triangles fill there."""
    corners = unit_scaling.normalized(points)[of.triangles]
    one, two = np.roll(corners, -1, axis=1) - corners, np.roll(corners, -2, axis=1) - corners
    sine = np.linalg.norm(np.cross(one, two), axis=2)
    angle = np.degrees(np.arctan2(sine, np.einsum("tij,tij->ti", one, two)))
    row, column = np.nonzero(of.stratum[of.triangles] == 3)
    vertex = of.triangles[row, column]
    pairs, place = np.unique(np.column_stack([vertex, of.patch[row]]), axis=0, return_inverse=True)
    total = np.zeros(len(pairs))
    np.add.at(total, place.reshape(-1), angle[row, column])
    return pairs[:, 0], total
