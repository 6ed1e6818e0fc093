"""What a mesh itself says must stay: the facets and edges in the sets that mmg calls required."""

import warnings

import numpy as np

from wct_plugin.errors import WctWarning
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.required_sets import REQUIRED_EDGES, REQUIRED_TRIANGLES
from wct_plugin.mesh.strata import Strata
from wct_plugin.meshing import per_group
from wct_plugin.meshing.boundary_choice import Boundary
from wct_plugin.types import Bools, Ints


def boundary_of(wanted: Boundary, mesh: TetMesh) -> Boundary:
    """What is wanted of the boundary, with the required facets fixed unless something else is said of their set."""
    if wanted == "fixed" or not len(mesh.facets.sets.get(REQUIRED_TRIANGLES, ())):
        return wanted
    return {REQUIRED_TRIANGLES: "fixed", **({per_group.REST: wanted} if isinstance(wanted, str) else wanted)}


def curves_of(mesh: TetMesh, of: Strata) -> Ints:
    """The curves of the surfaces of a mesh that are made of required edges."""
    row = find_rows(of.segments, np.sort(_edges(mesh), axis=1), len(mesh.points))
    return np.unique(of.curve[row[row >= 0]])


def vertices_of(mesh: TetMesh) -> Bools:
    """(n,) the points of required facets and edges."""
    found = np.zeros(len(mesh.points), dtype=bool)
    found[mesh.facets.vertices[mesh.facets.sets.get(REQUIRED_TRIANGLES, np.empty(0, dtype=np.int64))]] = True
    found[_edges(mesh)] = True
    return found


def check_edges(old: TetMesh, new: TetMesh) -> None:
    """Warn of required edges of the old mesh that the new one does not have to the bit."""
    edges = np.sort(_edges(old), axis=1)
    if new is old or not len(edges):
        return
    edges = edges[find_rows(old.topology.edges, edges, len(old.points)) >= 0]
    both = np.unique(np.vstack([old.points, new.points]), axis=0, return_inverse=True)[1].reshape(-1)
    before, after = both[: len(old.points)], both[len(old.points) :]
    rows = find_rows(np.sort(after[new.topology.edges], axis=1), np.sort(before[edges], axis=1), len(both))
    lost = int((rows < 0).sum())
    if lost:
        said = f"{lost} of {len(edges)} edges of the set {REQUIRED_EDGES!r} are not edges of the new mesh"
        warnings.warn(said, WctWarning, stacklevel=4)


def _edges(mesh: TetMesh) -> Ints:
    return mesh.edges.vertices[mesh.edges.sets.get(REQUIRED_EDGES, np.empty(0, dtype=np.int64))]
