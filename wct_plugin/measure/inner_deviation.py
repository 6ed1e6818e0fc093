"""How far sheets and wires, tagged facets and edges inside a region, are from where they were."""

import numpy as np

from wct_plugin.core import _core
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.index_arrays import among
from wct_plugin.mesh.strata import tagged_inside
from wct_plugin.mesh.triangle_surfaces import SIDES
from wct_plugin.types import Floats, Ints

#: Samples per segment: its ends, and as many parts between.
_PARTS = 8


def measure_inner_deviation(old: TetMesh, new: TetMesh, diagonal: float) -> dict[str, float]:
    """The largest distance between old and new sheets, and wires, both ways and sampled, as fractions of a diagonal.

    By ``tagged facets inside`` and ``tagged edges inside``, where both meshes have such. Sheets are facets inside one
    region, wires edges of no facet of a surface or sheet.
    """
    out = {}
    (before, _), (after, _) = tagged_inside(old), tagged_inside(new)
    if len(before) and len(after):
        sheet, was = SurfaceMesh(new.points, after), SurfaceMesh(old.points, before)
        out["tagged facets inside"] = float(measure_deviation(sheet, was, compiled=True).max / diagonal)
    before, after = _wires(old, before), _wires(new, after)
    if len(before) and len(after):
        one, other = ((mesh.points / diagonal)[edges] for mesh, edges in ((old, before), (new, after)))
        out["tagged edges inside"] = max(_farthest(one, other), _farthest(other, one))
    return out


def _wires(mesh: TetMesh, sheets: Ints) -> Ints:
    """(k, 2) the tagged edges of no facet of the boundary, of an interface or of ``sheets`` (s, 3)."""
    facets = np.concatenate([mesh.topology.boundary, mesh.topology.interfaces, sheets])
    sides = facets[:, SIDES].reshape(-1, 2)
    edges: Ints = mesh.edges.vertices[~among(mesh.edges.vertices, sides, len(mesh.points))]
    return edges


def _farthest(segments: Floats, others: Floats) -> float:
    """The largest distance of a sample of segments (k, 2, 3) from other ones (m, 2, 3)."""
    share = np.linspace(0.0, 1.0, _PARTS + 1)[:, None, None]
    samples = (segments[:, 0] + share * (segments[:, 1] - segments[:, 0])).reshape(-1, 3)
    thin = np.arange(2 * len(others)).reshape(-1, 2)[:, [0, 1, 1]]  # a segment is a triangle with one corner twice
    _, _, distances = _core.closest_points(others.reshape(-1, 3), thin, samples)
    return float(distances.max())
