"""Where a body is so thin that a surface within the tolerance may pass through itself."""

from typing import NamedTuple

import numpy as np

from wct_plugin.core import _core
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.triangle_surfaces import normals
from wct_plugin.types import Floats, Ints

#: Two facets are the sides of a wall where their planes make less than this angle, in degrees; edges are no walls.
_PARALLEL = 10.0
#: And where the one is this far aside of the other at most, as a fraction of the thickness.
_ASIDE = 0.2
#: How deep to look from, as fractions of half the thickness asked for: the nearest facet then is the far side.
_DEPTHS = (1.0, 0.25, 0.0625)


class Thin(NamedTuple):
    """The thinnest place that was found."""

    region: int  #: tag
    thickness: float  #: a length
    place: tuple[float, float, float]  #: in the middle between the two sides


def thinnest(mesh: TetMesh, below: float) -> Thin | None:
    """The thinnest place of a region of ``mesh`` that is less than ``below``, a length, from one side to the other.

    Looked for from the middle of every facet of the region's surface: none is found that is no wall there, but a wall
    narrower than the facets may be missed.
    """
    topology = mesh.topology
    pairs = topology.interface_pairs
    half_facets = np.concatenate([topology.boundary_half_facets, pairs[:, :2], pairs[:, 2:]])
    tags, triangles = mesh.regions[half_facets[:, 0]], topology.triangles_of(half_facets)
    found = [_of_region(mesh.points, triangles[tags == tag], int(tag), below) for tag in np.unique(tags)]
    return min((one for one in found if one), key=lambda one: one.thickness, default=None)


def _of_region(points: Floats, triangles: Ints, tag: int, below: float) -> Thin | None:
    outward = normals(points, triangles)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    middles = points[triangles].mean(axis=1)
    best: Thin | None = None
    for depth in _DEPTHS:
        feet, facing, _ = _core.closest_points(points, triangles, middles - outward * (depth * below / 2.0))
        across = middles - feet
        thickness = np.einsum("ij,ij->i", across, outward)
        aside = np.linalg.norm(across - thickness[:, None] * outward, axis=1)
        opposite = np.einsum("ij,ij->i", outward, outward[facing]) < -np.cos(np.radians(_PARALLEL))
        rows = np.flatnonzero(opposite & (thickness > 0.0) & (thickness < below) & (aside <= _ASIDE * thickness))
        if len(rows):
            row = rows[np.argmin(thickness[rows])]
            if best is None or thickness[row] < best.thickness:
                x, y, z = ((middles[row] + feet[row]) / 2.0).tolist()
                best = Thin(tag, float(thickness[row]), (x, y, z))
    return best
