"""What the compiled functions give."""

from dataclasses import dataclass
from typing import Any, TypedDict

from wct_plugin.core.domain import StratifiedMesh
from wct_plugin.types import Floats, Ints


@dataclass(frozen=True, eq=False)
class ResampleResult:
    """What :func:`wct_plugin.core._core.resample` gives."""

    mesh: StratifiedMesh
    held: Ints  #: (n,) the held point that it is, or -1
    exposed: Ints
    """Points of a facet of the surface that no tet is behind, and"""
    pinched: Ints
    """points where the result is no manifold; both empty if all went well"""
    intact: bool
    """No such points but corners, no facet that cuts across from one planar patch to another, no gap in the creases of
    those, the Euler characteristic of every region as in the mesh, and all held facets"""
    lost: Ints  #: points where the domain is not represented, but for corners; -1 for one of no tet
    work: int  #: in evaluations of a tet's energy
    stats: dict[str, Any]


@dataclass(frozen=True, eq=False)
class SearchResult:
    """What :func:`wct_plugin.core._core.search_well_centered` gives."""

    mesh: StratifiedMesh
    bad: int  #: tets that miss the goal, or are at a facet beyond the tolerance
    stuck: Ints  #: (s,) which tets those are, but for those on a facet that is ruled out
    beyond: float  #: how far the farthest facet is beyond the tolerance, in tolerances
    passes: int
    kicks: int
    accepted: int  #: kicks that made it better
    evaluations: int  #: tets measured
    work: int  #: the same with what looking at curved surfaces costs
    stopped: bool  #: whether the listener ended the work
    released: Ints
    """(r,) curves that became ordinary surface; patches they divided have the smallest number of any of them"""


@dataclass(frozen=True, eq=False)
class RefillResult:
    """What :func:`wct_plugin.core._core.refill` and :func:`wct_plugin.core._core.conform_inside` give."""

    points: Floats
    tets: Ints  #: none where the facets leave no choice, or where it was stopped early
    regions: Ints
    origin: Ints  #: (n,) the input's point, -1 for a new one
    size: Floats  #: (n,) edge length wanted
    stopped: bool


@dataclass(frozen=True, eq=False)
class ConformResult:
    """What :func:`wct_plugin.core._core.conform` gives."""

    mesh: StratifiedMesh
    origin: Ints  #: (n,) the input's point, -1 for a new one
    rounds: int
    intact: bool  #: creases, surfaces and the Euler characteristic of every region are as in the mesh
    faults: dict[str, int]  #: places that are short of the goal, by kind
    stopped: bool


class MoveReport(TypedDict):
    """What :func:`wct_plugin.core._core.move_vertices` did."""

    iterations: int  #: steps of all points together, or sweeps over them
    evaluations: int  #: tets measured
    bad_before: int  #: tets that miss the goal, exactly
    bad_after: int
    worst_before: float  #: smallest h/R, for goal cwc smallest of h/R and the cosines of the facet angles
    worst_after: float
    stopped: bool  #: whether the listener ended the work
