"""The goals 3wc and cwc: the domain resampled, or the mesh itself, and the search from there."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from wct_plugin.core.domain import StratifiedMesh
from wct_plugin.core.results import SearchResult
from wct_plugin.measure import compiled_quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.measure.planes import PlaneCount
from wct_plugin.measure.quality import Quality
from wct_plugin.mesh import TetMesh
from wct_plugin.meshing import planes, required_cells, search_mesh
from wct_plugin.meshing.followed_surface import outer
from wct_plugin.meshing.held_surface import HeldSurface
from wct_plugin.meshing.judgement import Found
from wct_plugin.meshing.kept_areas import KeptAreas
from wct_plugin.meshing.kept_volumes import volume_missed
from wct_plugin.meshing.local_search import LocalSearch, best, ranked
from wct_plugin.meshing.local_tolerance import LeastTolerance, Tolerance, find_tolerance
from wct_plugin.meshing.new_mesh_faults import find_fault, warn_of_fault, warn_that_nothing_was_found
from wct_plugin.meshing.normalized_mesh import NormalizedMesh, count_bad
from wct_plugin.meshing.periodic_pairs import Unmatched, warn_unmatched
from wct_plugin.meshing.phase_progress import Listener
from wct_plugin.meshing.reference import Reference
from wct_plugin.meshing.reference_choice import choose, warn_of_own_facets
from wct_plugin.meshing.reference_fit import gap
from wct_plugin.meshing.released_creases import measure_none, measure_released
from wct_plugin.meshing.surface_edges import Lengths, longest_edges
from wct_plugin.meshing.tet_limit import TetLimit
from wct_plugin.meshing.transfer import carry, in_strata_of_mesh
from wct_plugin.meshing.well_center_options import WellCenterOptions
from wct_plugin.meshing.work_limit import WorkLimit
from wct_plugin.progress import ProgressCallback
from wct_plugin.types import Floats, Metrics


def remesh(
    given: NormalizedMesh, wanted: Floats | None, options: WellCenterOptions, progress: ProgressCallback
) -> Found:
    """The mesh made anew with as few bad tets as the search gets to, or as it came where nothing better is found.

    ``wanted`` (n,): edge lengths asked for, in the mesh's unit.
    """
    follow = Followed.of(given, options)
    mesh, bad = given.mesh, given.count_bad(options.goal)
    few_enough = options.max_tets is None or len(mesh.tets) <= options.max_tets
    asked = wanted is not None or options.force or not few_enough
    if not bad and not asked and follow.boundary_is_near():
        return follow.found(mesh, given.measured, follow.work_of_none())
    if options.boundary != "fixed":
        given.warn_of_thin_walls(follow.tolerance)
    listen = Listener(progress, bad)
    limit = TetLimit(options.max_tets, len(mesh.tets), listen)
    allowed = WorkLimit(len(mesh.tets), options.effort)
    follow, tried = _search(follow, options, wanted, listen, limit, allowed)
    work: Metrics = {name: sum(getattr(one, name) for one in tried) for name in ("passes", "kicks", "evaluations")}
    work |= {"stopped": listen.stopped, "kept": False, "planes": follow.planes, "estimate": limit.expected}
    work |= {"exhausted": allowed.reached, "needed": limit.needed, "local_tolerance": follow.least}
    if not tried:  # stopped before there was any other mesh, or none has few enough tets
        work["released"] = measure_none(given.own)
        limit.warn(missed=bad > 0 or asked)
        return follow.found(mesh, given.measured, work)
    result, better = _choose(follow, tried, stopped=listen.stopped)
    listen.measure(result.bad if result else bad)
    after = compiled_quality.measure(better)
    gain = bad * len(after) - count_bad(better, after, options.goal) * len(given.measured)
    if few_enough and (gain < 0 or (gain == 0 and listen.stopped)):  # the output is never worse
        better, after = mesh, given.measured
        if not listen.stopped:
            warn_that_nothing_was_found()
    left = count_bad(better, after, options.goal)
    limit.warn(missed=left > 0 or not limit.holds(len(better.tets)) or wanted is not None)
    gone = result.released if result and better is not mesh else np.empty(0, dtype=np.int64)
    work["released"] = measure_released(follow.surface, gone)
    return follow.found(better, after, work)


@dataclass(frozen=True, eq=False)
class Followed:
    """The surface that a new mesh stays near, and how near."""

    given: NormalizedMesh
    own: Reference  #: the mesh's own surface, with its planes put right
    surface: Reference  #: the one that is followed
    held: HeldSurface | None  #: facets of it that stay while the rest is made anew
    straight: TetMesh  #: the mesh on its own surface
    planes: PlaneCount | None  #: what was put right
    tolerance: float  #: a length, from the surface that was given
    within: Tolerance  #: the same from the surface that is followed, place by place

    @classmethod
    def of(cls, given: NormalizedMesh, options: WellCenterOptions) -> Self:
        """The given surface where the mesh can follow it, else its own; planes exact if asked for."""
        mesh, own, choices = given.mesh, given.own, given.choices
        surface = mesh.reference
        moves = choices.word == "move"
        curves = required_cells.curves_of(mesh, own.strata)
        stays = moves and (choices.stays.any() or len(curves))
        held = HeldSurface.of(own, choices.stays, choices.fixed, curves) if stays else None
        followed, reason = own, ""
        exact = 0.0
        if moves and surface is not None:
            reason = "facets of it stay"
            if held is None:
                exact = planes.precision(surface.points, given.unit)
                followed, reason = choose(mesh, own, surface, options.crease_angle, options.tolerance, exact)
        straight, put_right = given.periodic.mesh if given.periodic else mesh, None
        if moves and options.planes == "exact" and held is None and given.periodic is None:
            if followed is own:
                straight, own, put_right = planes.straightened_mesh(
                    mesh, own, planes.precision(mesh.points, given.unit)
                )
                followed = own
            else:
                followed, put_right = planes.straightened(followed, exact)
        tolerance = (options.tolerance or followed.auto_tolerance()) * given.diagonal
        near = tolerance
        if surface is not None and reason:
            warn_of_own_facets(reason)
            near -= gap(own, surface, tolerance)  # what lies between the two comes off the tolerance
        if surface is None or followed is own:
            within = _tolerance_of(followed, near, options)
        else:
            within = _tolerance_of(followed, near, options, gap(own, surface, near), own)
        return cls(given, own, followed, held, straight, put_right, tolerance, within)

    def on_own(self, options: WellCenterOptions) -> "Followed":
        """The same with the mesh's own surface."""
        if self.surface is self.own:
            return self
        return replace(self, surface=self.own, within=_tolerance_of(self.own, self.within.most, options))

    @property
    def least(self) -> LeastTolerance | None:
        """Where the tolerance is smallest; None where it is the same everywhere."""
        return self.within.least(self.surface, self.given.diagonal, 2.0**self.given.unit)

    def boundary_is_near(self) -> bool:
        """Whether the mesh's boundary is within the tolerance, both ways; it is where it is followed itself."""
        if self.surface is self.own:
            return True
        there = self.given.mesh.boundary_surface()
        return measure_deviation(there, outer(self.surface), compiled=True).max <= self.tolerance

    def work_of_none(self) -> Metrics:
        """What is said of the work where the mesh stays as it came."""
        none: Metrics = {"passes": 0, "kicks": 0, "evaluations": 0, "stopped": False, "kept": True}
        none |= {"planes": self.planes, "local_tolerance": self.least, "estimate": None}
        return none | {"released": measure_none(self.own), "exhausted": False, "needed": None}

    def found(self, mesh: TetMesh, measured: Quality, work: Metrics) -> Found:
        """The outcome."""
        return Found(mesh, measured, self.tolerance, work, self.surface)


def _tolerance_of(
    on: Reference, most: float, options: WellCenterOptions, apart: float = 0.0, own: Reference | None = None
) -> Tolerance:
    """At most so much, and less in places unless that is not wanted; arguments as of :func:`find_tolerance`."""
    return find_tolerance(on, most, apart, own) if options.local_tolerance else Tolerance(most)


def _search(
    follow: Followed,
    options: WellCenterOptions,
    wanted: Floats | None,
    listen: Listener,
    limit: TetLimit,
    allowed: WorkLimit,
) -> tuple[Followed, list[SearchResult]]:
    """What the searches lead to, and the surface that they stayed near."""
    given, mesh = follow.given, follow.given.mesh
    moves = given.choices.word == "move"
    fixed = np.flatnonzero(given.choices.fixed)
    search = LocalSearch(
        follow.straight,
        given.choices.word,
        options.goal == "cwc",
        options.margin,
        options.effort,
        options.seed,
        listen,
        limit,
        allowed,
        follow.held,
        fixed,
        fixed[:0] if given.periodic is None else given.periodic.firm,
        options.crease_angle,
        KeptAreas.of(follow.straight, follow.own, follow.surface),
    )
    if moves and not _has_rough_sheets(given):
        most = None if wanted is not None else longest_edges(mesh, follow.own, follow.surface, options.surface_edges)
        lengths = Lengths(wanted, most)
        fresh = search.first_start(follow.surface, follow.within, lengths)
        if fresh is not None:
            tried = search.run_finer(fresh, follow.surface, follow.within, lengths)
            return follow, _with_pairs(follow, search, tried)
    follow = follow.on_own(options)
    if listen.stopped:
        return follow, []
    start = _own_start(follow, options, wanted, listen, limit)
    if listen.stopped or not limit.takes(len(start.tets)):
        return follow, []
    worth = np.inf if moves else search.worth
    return follow, [search.run(start, follow.surface, follow.within, worth)]


def _with_pairs(follow: Followed, search: LocalSearch, tried: list[SearchResult]) -> list[SearchResult]:
    """What was found with pairs that match; as it was, with a warning, where that cannot be."""
    periodic = follow.given.periodic
    if periodic is None:
        return tried
    try:
        return periodic.matched(search, best(tried), follow.within)
    except Unmatched as why:
        warn_unmatched(why)
        return tried


def _choose(follow: Followed, tried: list[SearchResult], *, stopped: bool) -> tuple[SearchResult | None, TetMesh]:
    """The best result that has no fault, and the mesh it is; none, and the mesh that came, where all have one."""
    mesh, faults = follow.given.mesh, []
    for one in ranked(tried, lambda found: volume_missed(found, follow.surface)):
        made = carry(mesh, follow.own.strata, in_strata_of_mesh(one.mesh, follow.surface))
        fault = find_fault(follow.given, made, follow.surface, follow.tolerance, stopped=stopped)
        if not fault:
            return one, made
        faults.append(fault)
    if not stopped:
        warn_of_fault(faults[0])
    return None, mesh


def _own_start(
    follow: Followed, options: WellCenterOptions, size: Floats | None, listen: Listener, limit: TetLimit
) -> StratifiedMesh:
    """The mesh, or its inside filled anew where its surface stays: whichever has the smaller share of bad tets."""
    own, mesh, choices = follow.own, follow.straight, follow.given.choices
    moves = choices.word == "move"
    pinned = np.zeros(len(mesh.points), dtype=bool)
    pinned[own.strata.triangles[choices.stays[own.strata.patch]]] = True
    start = search_mesh.from_mesh(mesh, own, pinned=pinned if moves else True, size=size)
    if moves or listen.stopped:
        return start
    refilled = search_mesh.refill(
        start,
        own.sides,
        size,
        acute=options.goal == "cwc",
        seed=options.seed + 1,
        progress=listen.resample,
        expected=limit.expect,
    )
    if refilled is None or listen.stopped or not limit.takes(len(refilled.tets)):
        return start
    if limit.holds(len(start.tets)) and _bad_share(refilled, options.goal) >= _bad_share(start, options.goal):
        return start
    return refilled


def _bad_share(start: StratifiedMesh, goal: str) -> float:
    """Of the tets that miss the goal in a start of the search."""
    mesh = TetMesh(start.points, start.tets)
    return count_bad(mesh, compiled_quality.measure(mesh), goal) / len(mesh.tets)


def _has_rough_sheets(given: NormalizedMesh) -> bool:
    """Whether facets tagged inside regions bend at most of their edges, as picked from a mesh: all corners stay then.

    No new start can have better tets beside them, and sizes between them go to nothing.
    """
    topology = given.mesh.topology
    patch = given.own.strata.patch[len(topology.boundary) + len(topology.interfaces) :]
    return 2 * len(np.unique(patch)) > len(patch)
