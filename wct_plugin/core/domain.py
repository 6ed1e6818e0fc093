"""What the compiled functions take and give: a surface, and meshes in its strata.

Arrays are C-contiguous, float64 for coordinates and int64 for indices unless stated. The compiled functions check them:
a wrong type, shape or index is a ValueError that names the array, the value and what is allowed.
"""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from wct_plugin.types import Floats, Ints


def _none() -> Ints:
    return np.empty(0, dtype=np.int64)


def _no_edges() -> Ints:
    return np.empty((0, 2), dtype=np.int64)


@dataclass(frozen=True, eq=False)
class StratifiedSurface:
    """A surface in strata: patches between creases, creases between corners. Numbers of both may be left out."""

    points: Floats  #: (n, 3); not all need be used
    triangles: Ints  #: (t, 3)
    patch: Ints  #: (t,) from 0
    segments: Ints  #: (s, 2) the edges of creases
    curve: Ints  #: (s,) from 0
    sides: Ints = field(default_factory=_no_edges)
    """(patches, 2) index of the region behind a patch's triangles and of the one before, -1 outside"""
    corners: Ints = field(default_factory=_none)  #: (c,) of the points
    folds: Ints = field(default_factory=_no_edges)  #: (f, 2) edges that bend as creases do and are none
    flat: float = 0.0
    """As far off a plane or line, a length, points may be that count as on it, if more than 1e-9 of its extent"""


@dataclass(frozen=True, eq=False)
class StratifiedMesh:
    """Tets, and of which part of a surface their facets, edges and points are."""

    points: Floats  #: (n, 3)
    tets: Ints  #: (m, 4) positively oriented
    regions: Ints  #: (m,) index of the region, from 0
    stratum: NDArray[np.int8]  #: (n,) 0 interior, 1 on a patch, 2 on a crease, 3 corner
    label: Ints
    """(n,) its patch or curve; of a corner its point of the surface, or -1, and it stays; -1 inside"""
    size: Floats  #: (n,) edge length wanted there
    facets: Ints  #: (k, 3) of the surface: the boundary, interfaces, sheets inside
    facet_patch: Ints  #: (k,)
    creases: Ints  #: (c, 2)
    crease_curve: Ints  #: (c,)


@dataclass(frozen=True, eq=False)
class RegionMesh:
    """Tets that say what is inside, and where which region is."""

    points: Floats  #: (n, 3)
    tets: Ints  #: (m, 4) positively oriented
    regions: Ints  #: (m,) index of the region, from 0


class Triangles(Protocol):
    """Triangles of a surface, whatever else it has."""

    @property
    def points(self) -> Floats:
        """(n, 3)."""

    @property
    def triangles(self) -> Ints:
        """(t, 3)."""


class InStrata(Protocol):
    """Which part of a surface the points of a mesh are on, and the triangles and segments of the parts."""

    @property
    def stratum(self) -> NDArray[np.int8]:
        """(n,) as of :class:`StratifiedMesh`."""

    @property
    def label(self) -> Ints:
        """(n,) patch or curve."""

    @property
    def triangles(self) -> Ints:
        """(t, 3) of the mesh's points."""

    @property
    def patch(self) -> Ints:
        """(t,)."""

    @property
    def segments(self) -> Ints:
        """(s, 2) of the mesh's points."""

    @property
    def curve(self) -> Ints:
        """(s,)."""
