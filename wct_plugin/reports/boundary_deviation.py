"""How far each triangle of a boundary is from the reference, for pictures that are coloured by it."""

import numpy as np

from wct_plugin.core import _core
from wct_plugin.mesh import SurfaceMesh, TetMesh, unit_scaling
from wct_plugin.types import Floats


def deviation_of_facets(mesh: TetMesh, reference: SurfaceMesh) -> Floats:
    """(b,) per boundary facet the largest distance of its corners and its middle, as a fraction of the diagonal."""
    unit = unit_scaling.exponent(np.concatenate([mesh.points, reference.points]))
    mesh, reference = unit_scaling.scaled(mesh, -unit), unit_scaling.scaled(reference, -unit)
    facets = mesh.topology.boundary
    used, corner = np.unique(facets, return_inverse=True)
    queries = np.concatenate([mesh.points[used], mesh.points[facets].mean(axis=1)])
    apart = np.asarray(_core.closest_points(reference.points, reference.triangles, queries)[2])
    of_corners = apart[: len(used)][corner.reshape(-1, 3)].max(axis=1)
    out: Floats = np.maximum(of_corners, apart[len(used) :]) / reference.diagonal
    return out
