"""Distances from straight segments."""

import numpy as np

from wct_plugin.types import Floats


def farthest(places: Floats, starts: Floats, ends: Floats) -> float:
    """How far the places (n, 3) are from the segments (m, 3) at most."""
    ways = ends - starts
    along = np.einsum("nmi,mi->nm", places[:, None] - starts, ways) / np.einsum("mi,mi->m", ways, ways)
    feet = starts + np.clip(along, 0.0, 1.0)[..., None] * ways
    return float(np.linalg.norm(places[:, None] - feet, axis=2).min(axis=1).max())
