"""Points in the same place: of bodies meshed apart, of the two sides of a crack, of each facet of an STL file."""

import numpy as np

from wct_plugin.types import Floats, Ints

#: Odd factors that make one number, modulo 2 ** 64, of the bits of three coordinates.
_MIX = np.array([0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB], dtype=np.uint64)


def distinct_points(points: Floats) -> tuple[Floats, Ints]:
    """The points that differ, in the order they come first in, and for each given one (n, 3) its row among these."""
    if not len(points):
        return points, np.empty(0, dtype=np.int64)
    points = np.ascontiguousarray(points, dtype=np.float64) + 0.0  # minus zero is zero
    bits = points.view(np.uint64)
    keys = (bits ^ (bits >> np.uint64(32))) @ _MIX
    order = np.argsort(keys)
    keys = keys[order]
    starts = np.flatnonzero(np.concatenate([[True], keys[1:] != keys[:-1]]))
    first = np.minimum.reduceat(order, starts)
    place = np.empty(len(points), dtype=np.int64)
    place[order] = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, len(points))))
    if not np.array_equal(points[first][place], points):  # two points with one number, or one that is no number
        _, first, place = np.unique(points, axis=0, return_index=True, return_inverse=True)
    ranked = np.argsort(first)
    rank = np.empty(len(first), dtype=np.int64)
    rank[ranked] = np.arange(len(first))
    return points[first[ranked]], rank[place.reshape(-1)]


def places(points: Floats) -> Ints:
    """(n,) a number per point, equal where points coincide exactly, in the order of their first points."""
    return distinct_points(points)[1]
