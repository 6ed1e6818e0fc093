"""Where and how the next start of a search differs: shorter edges round stuck tets, or only a part made anew."""

from typing import NamedTuple, Self

import numpy as np

from wct_plugin.core.requests import KeptPoints
from wct_plugin.core.results import SearchResult
from wct_plugin.types import Bools, Floats, Ints


def middles(corners: Floats) -> tuple[Floats, Floats]:
    """Centroids (n, 3) and mean edge lengths (n,) of tets, whose ``corners`` are (n, 4, 3)."""
    edges = corners[:, [0, 0, 0, 1, 1, 2]] - corners[:, [1, 2, 3, 2, 3, 3]]
    return corners.mean(axis=1), np.linalg.norm(edges, axis=2).mean(axis=1)


class ShorterEdges(NamedTuple):
    """Edges are no longer than ``size`` (k,) round the places ``at`` (k, 3), for some lengths of them."""

    at: Floats
    size: Floats

    @classmethod
    def nowhere(cls) -> Self:
        """No place."""
        return cls(np.empty((0, 3)), np.empty(0))

    def about(self, at: Floats, wanted: Floats) -> "ShorterEdges":
        """These places and others (n, 3), where edges of a length (n,) are ``wanted``."""
        return ShorterEdges(np.vstack([self.at, at]), np.concatenate([self.size, wanted]))


#: Radius within which points are new, in edges of the tet that is stuck: more would undo what came right round it. It
#: grows each time in vain.
_RADIUS = 1.4
_GROWTH = 1.4
#: Share of stuck tets up to which the rest is worth keeping: more beside facets that are held, with which shorter edges
#: do not go.
_FEW = 0.012
_FEW_HELD = 0.02


class PartialRestart(NamedTuple):
    """Points (k, 3) with stratum and label (k,) stay, but for those within ``radius`` (z,) of ``at`` (z, 3)."""

    points: Floats
    stratum: Ints
    label: Ints
    at: Floats
    radius: Floats
    old: SearchResult  #: where they are from

    @classmethod
    def of(cls, found: SearchResult, vain: int, *, held: bool = False) -> Self | None:
        """A search's result, to be made anew where it is stuck; None where too much of it is.

        ``vain``: how often that has brought nothing. ``held``: whether facets of the surface are.
        """
        mesh, stuck = found.mesh, found.stuck
        if len(stuck) > (_FEW_HELD if held else _FEW) * len(mesh.tets):
            return None
        at, edge = middles(mesh.points[mesh.tets[stuck]])
        return cls.around(found, at, _GROWTH**vain * edge)

    @classmethod
    def around(cls, found: SearchResult, at: Floats, edge: Floats) -> Self:
        """A search's result, to be made anew round some places ``at`` (z, 3), where edges are so long (z,)."""
        mesh = found.mesh
        region = np.empty(len(mesh.points), dtype=np.int64)
        region[mesh.tets.ravel()] = np.repeat(mesh.regions, 4)
        keep = (mesh.stratum < 3) | (mesh.label >= 0)  # but for corners that do not move anyway
        return cls(
            mesh.points[keep],
            mesh.stratum[keep].astype(np.int64),
            np.where(mesh.stratum > 0, mesh.label, region)[keep],
            at,
            _RADIUS * edge,
            found,
        )

    @property
    def request(self) -> KeptPoints:
        """What the core is asked to keep."""
        return KeptPoints(self.points, self.stratum, self.label, self.at, self.radius)

    def without(self, points: Bools) -> Self:
        """But for some of the points, given as a mask (k,)."""
        return self._replace(points=self.points[~points], stratum=self.stratum[~points], label=self.label[~points])
