"""Circumcenters outside the mesh: where a dual edge leaves the domain, or its region, before it ends."""

import numpy as np

from wct_plugin.measure import compiled_quality, quality
from wct_plugin.mesh import TetMesh, unit_scaling
from wct_plugin.mesh.topology import FACETS
from wct_plugin.types import Bools, Floats, Ints

#: A circumcenter on the boundary but for this part of its way from the centroid is not outside.
_ROUNDING = 1e-9
#: Tets that are looked at together, so that it takes little memory beside the mesh.
_BLOCK = 1 << 17


def stray_circumcenters(mesh: TetMesh) -> Bools:
    """(m,) the tets from whose centroid the straight way to their circumcenter crosses the boundary.

    Of a convex domain these are exactly the tets with their circumcenter outside. For each region by itself pass what
    :func:`wct_plugin.mesh.region_parts.apart` gives. The ways of many tets are followed at once, from tet to tet.
    """
    points, tets = unit_scaling.normalized(mesh.points), mesh.tets
    stray = np.zeros(len(tets), dtype=bool)
    for start in range(0, len(tets), _BLOCK):
        block = slice(start, start + _BLOCK)
        heights, errors = compiled_quality.heights(points, tets[block])
        beyond_facet: Bools = np.any(heights < -errors, axis=1)
        flat: Bools = np.any(np.isinf(errors), axis=1)
        away = start + np.flatnonzero(beyond_facet | flat)
        starts = points[tets[away]].mean(axis=1)
        ways = quality.circumcenters(points, tets[away]) - starts
        endless = ~np.isfinite(ways).all(axis=1)
        stray[away[endless]] = True
        on = beyond_facet[away - start] & ~endless
        stray[away[on]] = _leaving(mesh, points, away[on], starts[on], ways[on])
    return stray


def _leaving(mesh: TetMesh, points: Floats, first: Ints, starts: Floats, ways: Floats) -> Bools:
    """(k,) the ``ways`` (k, 3) from ``starts`` in the tets ``first`` that cross the boundary."""
    tets, adjacency = mesh.tets, mesh.topology.adjacency
    leaving = np.zeros(len(first), dtype=bool)
    way, here, came_from = np.arange(len(first)), first, np.full(len(first), -1)
    for _ in range(len(tets)):  # a straight line crosses a tet once
        if not len(way):
            break
        entered = (adjacency[here] == came_from[:, None]) & (came_from[:, None] >= 0)
        facet, part = _way_out(points[tets[here]], starts[way], ways[way], entered)
        beyond = adjacency[here, facet]
        on = part < 1.0 - _ROUNDING
        leaving[way[on & (beyond < 0)]] = True
        on &= beyond >= 0
        way, here, came_from = way[on], beyond[on], here[on]
    return leaving


def _way_out(corners: Floats, starts: Floats, ways: Floats, entered: Bools) -> tuple[Ints, Floats]:
    """Through which facet (k,) lines leave tets with ``corners`` (k, 4, 3), and at which part of their ``ways`` (k,).

    ``entered`` (k, 4): the facets that they came in by.
    """
    first, second, third = (corners[:, FACETS[:, k]] for k in range(3))
    outward = np.cross(second - first, third - first)
    speed = np.einsum("kfi,ki->kf", outward, ways)
    distance = np.einsum("kfi,kfi->kf", outward, first - starts[:, None])
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where((speed > 0.0) & ~entered, distance / speed, np.inf)
    facet = part.argmin(axis=1)
    return facet, part[np.arange(len(part)), facet]
