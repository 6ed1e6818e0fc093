"""How far sheets and wires, tagged facets and edges inside a region, are from where they were."""

import numpy as np

from wct_plugin.core import _core
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.types import Bools, Floats, Ints

#: Samples per segment: its ends, and as many parts between.
_PARTS = 8


def measure_inner_deviation(old: TetMesh, new: TetMesh, diagonal: float) -> dict[str, float]:
    """The largest distance between old and new sheets, and wires, both ways and sampled, as fractions of a diagonal.

    By ``tagged facets inside`` and ``tagged edges inside``, where both meshes have such. Sheets are facets inside one
    region, wires edges of no facet of a surface or sheet.
    """
    out = {}
    before, after = _sheets(old), _sheets(new)
    if len(before) and len(after):
        sheet, was = SurfaceMesh(new.points, after), SurfaceMesh(old.points, before)
        out["tagged facets inside"] = float(measure_deviation(sheet, was, compiled=True).max / diagonal)
    before, after = _wires(old), _wires(new)
    if len(before) and len(after):
        one, other = ((mesh.points / diagonal)[edges] for mesh, edges in ((old, before), (new, after)))
        out["tagged edges inside"] = max(_farthest(one, other), _farthest(other, one))
    return out


def _sheets(mesh: TetMesh) -> Ints:
    """(k, 3) the tagged facets that are no interface and not on the boundary."""
    surface = np.concatenate([mesh.topology.boundary, mesh.topology.interfaces])
    facets: Ints = mesh.facets.vertices[~_among(mesh.facets.vertices, surface, len(mesh.points))]
    return facets


def _wires(mesh: TetMesh) -> Ints:
    """(k, 2) the tagged edges of no facet of the boundary, of an interface or that is tagged."""
    facets = np.concatenate([mesh.topology.boundary, mesh.topology.interfaces, mesh.facets.vertices])
    sides = facets[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    edges: Ints = mesh.edges.vertices[~_among(mesh.edges.vertices, sides, len(mesh.points))]
    return edges


def _among(rows: Ints, others: Ints, count: int) -> Bools:
    """Which rows of vertices, in whatever order, are among the others."""
    if not len(rows) or not len(others):
        return np.zeros(len(rows), dtype=bool)
    found: Bools = find_rows(np.sort(others, axis=1), np.sort(rows, axis=1), count) >= 0
    return found


def _farthest(segments: Floats, others: Floats) -> float:
    """The largest distance of a sample of segments (k, 2, 3) from other ones (m, 2, 3)."""
    share = np.linspace(0.0, 1.0, _PARTS + 1)[:, None, None]
    samples = (segments[:, 0] + share * (segments[:, 1] - segments[:, 0])).reshape(-1, 3)
    thin = np.arange(2 * len(others)).reshape(-1, 2)[:, [0, 1, 1]]  # a segment is a triangle with one corner twice
    _, _, distances = _core.closest_points(others.reshape(-1, 3), thin, samples)
    return float(distances.max())
