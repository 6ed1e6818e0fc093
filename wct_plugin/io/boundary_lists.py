"""Vertex and line cells without a tag that only list what the tets say already: they ask for nothing.

Many exporters write every point, or every edge, of the boundary as a cell. As cells of their own they would be held.
"""

import logging
from dataclasses import replace

import numpy as np

from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.triangle_surfaces import SIDES
from wct_plugin.types import Bools, Ints

_log = logging.getLogger(__name__)


def without_lists(mesh: TetMesh) -> TetMesh:
    """The mesh without untagged vertices and edges of the boundary and of interfaces, and without lists of all.

    How many there were is told to whoever listens to the log of this package.

    What lies inside stays, as do cells with a tag, in a set, or with data of their own.
    """
    bare_nodes, bare_edges = _bare(mesh.nodes), _bare(mesh.edges)
    if not bare_nodes.any() and not bare_edges.any():
        return mesh
    surface = np.concatenate([mesh.topology.boundary, mesh.topology.interfaces])
    points = np.arange(len(mesh.points))
    nodes = _listed(mesh.nodes, bare_nodes, np.unique(surface)[:, None], points[:, None], len(points))
    sides = np.sort(np.concatenate([surface[:, side] for side in SIDES]), axis=1)
    edges = _listed(mesh.edges, bare_edges, sides, mesh.topology.edges, len(points))
    for count, kind in ((int(nodes.sum()), "vertex"), (int(edges.sum()), "line")):
        if count:
            _log.info("%s: %d untagged %s cells only list the surface and are left out", mesh.source, count, kind)
    return replace(mesh, nodes=mesh.nodes.select(~nodes), edges=mesh.edges.select(~edges))


def _bare(cells: Cells) -> Bools:
    """Cells of which nothing is said but that they are there."""
    bare: Bools = cells.tags == 0
    for members in cells.sets.values():
        bare[members] = False
    return bare & (not cells.data)


def _listed(cells: Cells, bare: Bools, surface: Ints, every: Ints, count: int) -> Bools:
    """Which of the bare cells are of the surface; all of them where they list every one that there is."""
    rows = np.sort(cells.vertices, axis=1)
    if not bare.any():
        return bare
    if (find_rows(rows[bare], np.sort(every, axis=1), count) >= 0).all():
        return bare
    return bare & (find_rows(surface, rows, count) >= 0)
