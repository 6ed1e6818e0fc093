"""Where a search is stuck: places at which the next start has shorter edges."""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Edges there, as a share of those of the tets that are stuck.
_SHARE = 0.8


def middles(corners: Floats) -> tuple[Floats, Floats]:
    """Centroids (n, 3) and mean edge lengths (n,) of tets, whose ``corners`` are (n, 4, 3)."""
    edges = corners[:, [0, 0, 0, 1, 1, 2]] - corners[:, [1, 2, 3, 2, 3, 3]]
    return corners.mean(axis=1), np.linalg.norm(edges, axis=2).mean(axis=1)


class Finer(NamedTuple):
    """Edges are no longer than ``size`` (k,) round the places ``at`` (k, 3)."""

    at: Floats
    size: Floats

    @classmethod
    def nowhere(cls) -> Self:
        """No place."""
        return cls(np.empty((0, 3)), np.empty(0))

    def about(self, corners: Floats) -> "Finer":
        """These places and the middles of tets, whose ``corners`` (n, 4, 3) are too far apart to come right."""
        at, edge = middles(corners)
        return Finer(np.vstack([self.at, at]), np.concatenate([self.size, _SHARE * edge]))
