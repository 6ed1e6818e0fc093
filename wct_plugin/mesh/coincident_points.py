"""Points of a mesh that are in the same place, as between bodies meshed apart and on the two sides of a crack."""

import numpy as np

from wct_plugin.types import Floats, Ints


def places(points: Floats) -> Ints:
    """(n,) a number per point, equal where points coincide exactly, in the order of their first points."""
    order = np.lexsort(points.T)
    new = np.ones(len(points), dtype=bool)
    new[1:] = (points[order[1:]] != points[order[:-1]]).any(axis=1)
    first = order[new]  # of each place: lexsort is stable
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    place = np.empty(len(points), dtype=np.int64)
    place[order] = rank[np.cumsum(new) - 1]
    return place
