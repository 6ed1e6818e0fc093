"""How long edges of the surface may be, by those that the mesh's own surface has there."""

from typing import NamedTuple

import numpy as np

from wct_plugin.core import _core
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.index_arrays import averaged, distinct_rows, find_rows
from wct_plugin.mesh.triangle_surfaces import surface_edges
from wct_plugin.meshing.grouped_lengths import AVERAGED
from wct_plugin.meshing.reference import Reference
from wct_plugin.types import Bools, Floats

#: Of tagged groups and interfaces, in what the rest may be: so they come out below 1.1 where that is 1.25.
_GROUPS = 0.82
#: Meshes come out so much coarser than asked for, on average.
_COARSER = 1.05
#: The range up to which lengths are one length but for scatter.
_UNIFORM = 1.5


class Lengths(NamedTuple):
    """Edge lengths wanted."""

    inside: Floats | None = None  #: (n,) per point of the mesh, None: its own
    surface: Floats | None = None  #: (s,) the longest per point of the surface, None: as inside
    one_row: bool = True  #: of tets through layers at interfaces where these are long; else three


def longest_edges(mesh: TetMesh, own: Reference, on: Reference, factor: float) -> Floats:
    """(s,) per point of the surface ``on``: ``factor`` times the edges of the mesh's own surface nearby, a length.

    On tagged groups and interfaces the factor is .82 of that; a point of several patches gets the least of theirs.
    """
    triangles, patch = own.strata.triangles, own.strata.patch
    lengths = _own_edges(own) * np.where(_grouped(mesh, own), _GROUPS, 1.0)[patch][:, None] * (factor / _COARSER)
    at_points = np.full(len(own.points), np.inf)
    np.minimum.at(at_points, triangles, lengths)
    if on.points is own.points:
        _limit_wires(at_points, own, factor)
        return np.where(np.isinf(at_points), lengths.max(), at_points)
    nearest = _core.closest_points(own.points, triangles, on.points)[1]
    found: Floats = lengths[nearest].min(axis=1)
    return found


def _limit_wires(at_points: Floats, own: Reference, factor: float) -> None:
    """Give points on segments off every surface ``factor`` times the mean edge of their curve, in place."""
    count, strata = len(own.points), own.strata
    off = find_rows(surface_edges(strata.triangles, count)[0], strata.segments, count) < 0
    segments, curve = strata.segments[off], strata.curve[off]
    if not len(segments):
        return
    edge = np.linalg.norm(own.points[segments[:, 1]] - own.points[segments[:, 0]], axis=1)
    mean = np.bincount(curve, edge) / np.maximum(np.bincount(curve), 1)
    np.minimum.at(at_points, segments, factor * mean[curve][:, None])


def _own_edges(own: Reference) -> Floats:
    """(t, 3) per corner of the surface's triangles: mean length of the edges of its patch there, smoothed."""
    triangles, patch = own.strata.triangles, own.strata.patch
    wedge = distinct_rows(np.column_stack([triangles.ravel(), np.repeat(patch, 3)])).reshape(-1, 3)
    count = int(wedge.max()) + 1
    at, of = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    at[wedge], of[wedge] = triangles, patch[:, None]
    i, k = surface_edges(wedge, count)[0].T
    edge = np.linalg.norm(own.points[at[i]] - own.points[at[k]], axis=1)
    edge = np.log(np.maximum(edge, np.finfo(np.float64).tiny))
    ends = np.bincount(i, minlength=count) + np.bincount(k, minlength=count)
    lengths = (np.bincount(i, edge, count) + np.bincount(k, edge, count)) / ends
    lengths = averaged(lengths, i, k, AVERAGED)
    patches = int(patch.max()) + 1
    least, most = np.full(patches, np.inf), np.full(patches, -np.inf)
    np.minimum.at(least, of, lengths)
    np.maximum.at(most, of, lengths)
    even = most - least < np.log(_UNIFORM)
    mean = np.bincount(of[i], edge, patches) / np.bincount(of[i], minlength=patches)
    found: Floats = np.exp(np.where(even[of], mean[of], lengths))[wedge]
    return found


def _grouped(mesh: TetMesh, own: Reference) -> Bools:
    """(patches,) which are interfaces or of a tagged group."""
    found: Bools = np.all(own.sides >= 0, axis=1)
    facets = mesh.facets
    member = facets.tags != 0
    for rows in facets.sets.values():
        member[rows] = True
    row = find_rows(np.sort(own.strata.triangles, axis=1), np.sort(facets.vertices[member], axis=1), len(mesh.points))
    found[own.strata.patch[row[row >= 0]]] = True
    return found
