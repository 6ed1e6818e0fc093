"""The local search, from a start that is given or resampled, and from others where it is stuck."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from wct_plugin.core import _core
from wct_plugin.core.domain import RegionMesh, StratifiedMesh
from wct_plugin.core.requests import ResampleOptions, SearchOptions
from wct_plugin.core.results import ResampleResult, SearchResult
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.triangle_surfaces import pinched
from wct_plugin.meshing.followed_surface import region_volumes
from wct_plugin.meshing.held_surface import HeldSurface
from wct_plugin.meshing.kept_areas import KeptAreas
from wct_plugin.meshing.local_tolerance import Tolerance
from wct_plugin.meshing.phase_progress import Listener
from wct_plugin.meshing.reference import Reference
from wct_plugin.meshing.released_creases import without
from wct_plugin.meshing.restart import PartialRestart, ShorterEdges
from wct_plugin.meshing.stitching import stitched
from wct_plugin.meshing.surface_edges import Lengths
from wct_plugin.meshing.tet_limit import TetLimit
from wct_plugin.meshing.work_limit import WorkLimit
from wct_plugin.obstructions import fixed_facets
from wct_plugin.types import Ints

#: Sweeps and tries at effort 1.
_PASSES = 12
_KICKS = 4000
#: How many starts are made until one represents the domain: without one, the search begins with the mesh that came.
_STARTS = 3
_FEW_LOST = 0.01  #: share of a start's points, round which it does not: with more of them no other start does
#: How often a start is made anew with shorter edges where the search was stuck.
_FINER = 5
_FINER_HELD = 2  #: the same beside facets that are held
#: Edges round what is stuck, in those that were wanted there. Where the first starts at that length do not come right,
#: a body of one region needs more points, as between two creases that run together. At interfaces, with points enough
#: on both sides, a start of nearly even size comes right oftener than one whose lattice changes from cell to cell.
_SHARES = (1.0, 1.0, 0.6)
_AT_INTERFACES = 0.8
#: Where more than this share of the first start's tets is stuck, its search goes on for so many times its worth, at
#: most for a part of the work that is left: another start has more tets, and comes right no oftener.
_FEW_STUCK = 0.002
_PATIENCE = 6.0
_PATIENT = 0.4
#: At interfaces, from so many tets on, the search of any start that is the best so far goes on, with most of what is
#: left where more than that share is stuck: ever fewer are. Shorter edges seldom help, unless so many are stuck that
#: there are too few points; with the rest one whole start is tried, and if that is spoilt, more of the same.
_SEVERAL_TETS = 2_000
_MANY_STUCK = 0.035
_MOST = 0.75
#: Where more than this share of such a mesh is stuck, and not that many, no start has come back below it.
_IN_VAIN = 0.005
#: Where a start has come back with more than so many times the stuck tets of the best, the others do not come below it.
_SPOILT = 3
#: Where more than this share of such a mesh is stuck, there are too few points: each start is finer than the last.
_TOO_FEW_POINTS = 0.05
#: Where more than this share of such a mesh's first start is stuck, as where parts are few edges wide, one that is
#: finer there is tried at once: it comes right, or all work goes into the better of the two.
_ANOTHER = 0.018
#: Where more than this share of a body's first start is stuck at corners, and there are layers at interfaces with one
#: row of tets, a start with three rows is tried at once: kicks hardly help at the corners of a single row, elsewhere
#: they do.
_STUCK_AT_CORNERS = 0.0006
#: A surface that is a tolerance beyond the tolerance is as bad as so many bad tets.
_MOVED = 10.0
#: How many partial restarts are tried, each with wider zones, before all of a mesh is made anew.
_PARTIAL_RESTARTS = 3
#: What a mesh without bad tets is worth, in evaluations per tet, where the surface or its vertices stay and nobody
#: knows whether there is one, more where flips of the surface can help too; and where another start, with shorter
#: edges, takes less: most that come right have come so by then.
_WORTH = {"fixed": 12_000.0, "keep": 30_000.0, "move": 5_000.0}


@dataclass(frozen=True, eq=False)
class LocalSearch:
    """What is asked of the search of a mesh, whatever it starts from."""

    mesh: TetMesh
    boundary: str  #: move, keep or fixed
    acute: bool  #: every triangle is to contain its circumcenter too
    margin: float
    effort: int
    seed: int
    listen: Listener
    limit: TetLimit
    work: WorkLimit
    held: HeldSurface | None = None  #: patches of a boundary that moves elsewhere
    fixed: Ints = field(default_factory=lambda: np.empty(0, dtype=np.int64))  #: patches whose facets stay
    firm: Ints = field(default_factory=lambda: np.empty(0, dtype=np.int64))  #: creases never given up
    crease_angle: float = 180.0  #: in degrees: patches do not come to bend more
    areas: KeptAreas | None = None  #: of plane groups and interfaces; None: nobody asks

    @property
    def worth(self) -> float:
        """Evaluations per tet, after which kicks may be given up."""
        return _WORTH["keep" if self.held is not None else self.boundary] * self.effort

    def run(
        self, start: StratifiedMesh, on: Reference, tolerance: Tolerance, worth: float = np.inf, part: float = 1.0
    ) -> SearchResult:
        """Search within the tolerance of the surface, for at most this ``part`` of the work that is left."""
        flips, moves = self.boundary != "fixed", self.boundary == "move"
        rows = np.flatnonzero(np.isin(start.facet_patch, self.fixed))
        sides = on.sides[start.facet_patch[rows]]
        ruled_out = fixed_facets.ruled_out(start.points, start.facets[rows], sides, acute=self.acute)
        options = SearchOptions(
            tolerance=tolerance.most,
            local_tolerance=tolerance.local,
            acute=self.acute,
            margin=self.margin,
            flip_surface=flips,
            split_surface=flips,
            passes=_PASSES,
            kicks=_KICKS * self.effort,
            seed=self.seed,
            crease_angle=self.crease_angle,
            ruled_out=rows[ruled_out],
            fixed=self.fixed,
            fixed_curves=None if self.held is None else self.held.all_curves(on),
            loose=self._loose(on) if moves else None,
            volumes=region_volumes(on) if moves else None,
            worth=worth,
            most_tets=self.limit.most,
            most_work=int(part * self.work.left),
        )
        found = _core.search_well_centered(start, on.surface, options, self.listen.search)
        self.work.add_search(found.work, stuck=len(found.stuck))
        return found

    def first_start(self, on: Reference, tolerance: Tolerance, lengths: Lengths) -> StratifiedMesh | None:
        """The first of some starts, which differ by chance alone, that represents the domain; None where none does.

        Where a start is far from that, no other is tried.
        """
        for attempt in range(_STARTS):
            found = self._sampled(on, tolerance, lengths, ShorterEdges.nowhere(), None, attempt)
            if found is None:
                return None
            start = self._sound(found, on)
            if start is not None or len(found.lost) > _FEW_LOST * len(found.mesh.points):
                return start
        return None

    def resampled(
        self,
        on: Reference,
        tolerance: Tolerance,
        lengths: Lengths,
        finer: ShorterEdges | None = None,
        restart: PartialRestart | None = None,
        attempt: int = 0,
    ) -> StratifiedMesh | None:
        """The relaxed lattice start, put into what stays of a mesh; None where it does not represent the domain.

        None too where it is stopped, as what is made until then is no start, and where it has too many tets.
        """
        found = self._sampled(on, tolerance, lengths, finer or ShorterEdges.nowhere(), restart, attempt)
        if found is None:
            return None
        return self._sound(found, on) if restart is None else self._stitched(self._pinned(found), found, restart)

    def _sampled(
        self,
        on: Reference,
        tolerance: Tolerance,
        lengths: Lengths,
        finer: ShorterEdges,
        restart: PartialRestart | None,
        attempt: int,
    ) -> ResampleResult | None:
        """What the core makes; None where it is not begun, or stopped, or that has too many tets."""
        if self.listen.stopped:
            return None
        found = _core.resample(
            on.surface,
            RegionMesh(self.mesh.points, self.mesh.tets, np.searchsorted(on.regions, self.mesh.regions)),
            ResampleOptions(
                tolerance=tolerance.most,
                local_tolerance=tolerance.local,
                size=lengths.inside,
                surface_size=lengths.surface,
                finer_at=finer.at,
                finer_size=finer.size,
                one_row=lengths.one_row,
                cosines=self.acute,
                seed=self.seed + 1 + attempt,
            ),
            kept=restart and restart.request,
            held=self.held and self.held.request,
            progress=self.listen.resample,
            expected=self.limit.expect if lengths.one_row else self.limit.expect_more_rows,
        )
        self.work.add_start(found.work)
        if not len(found.mesh.tets) or self.listen.stopped or not self.limit.takes(len(found.mesh.tets)):
            return None
        return found

    def _sound(self, found: ResampleResult, on: Reference) -> StratifiedMesh | None:
        """The start, where it represents the domain."""
        if not self._represents_domain(found, on):
            return None
        start = self._pinned(found)
        return start if self.held is None or self.held.is_in(start, np.unique(self.held.patch)) else None

    def _pinned(self, found: ResampleResult) -> StratifiedMesh:
        """What was resampled, in which points that are held and tagged vertices stay where they are."""
        mesh, stays = found.mesh, found.held >= 0
        pinned = ((mesh.stratum == 3) & np.isin(mesh.label, self.mesh.nodes.vertices)) | stays
        return replace(
            mesh,
            stratum=np.where(stays, 3, mesh.stratum).astype(np.int8),
            label=np.where(pinned, -1, mesh.label),
        )

    def _stitched(self, start: StratifiedMesh, found: ResampleResult, restart: PartialRestart) -> StratifiedMesh | None:
        """The start put into the tets that stay; None where that does not represent the domain, or has too many."""
        again = stitched(start, found.lost, restart.old)
        if again is None or not self.limit.takes(len(again.tets)):
            return None
        if self.held is None:
            return again
        return self.held.pinned(again) if self.held.is_in(again, self.held.fixed) else None

    @staticmethod
    def _represents_domain(found: ResampleResult, on: Reference) -> bool:
        """Whether it is intact, and pinched only at corners where sheets of the reference itself touch."""
        mesh, touching = found.mesh, found.pinched
        if not found.intact or (mesh.stratum[touching] < 3).any():
            return False
        if not len(touching):
            return True
        own_pinches = pinched(on.strata.triangles, len(on.points))
        return bool(own_pinches[mesh.label[touching]].all())

    def run_finer(
        self, start: StratifiedMesh, on: Reference, tolerance: Tolerance, lengths: Lengths
    ) -> list[SearchResult]:
        """What the search makes of a resampled start, and of others that are finer where the best of them is stuck.

        Where much of it is, its search goes on before that. Where the best is stuck in few places, the rest of it
        stays, and creases that it gave up stay so. Where none is stuck, but plane groups or interfaces did not keep
        their areas, another start is tried that differs by chance alone.
        """
        self.work.lead_to(len(start.tets))
        tried, finer = [], ShorterEdges.nowhere()
        gone = np.empty(0, dtype=np.int64)  # the creases without which the start was made
        worth, part = self.worth, 1.0
        last = False  # nothing else is left to try
        while True:
            found = self.run(start, self._without(on, gone), tolerance, worth, part)
            found = replace(found, released=np.union1d(gone, found.released))
            tried.append(found)
            fewest = best(tried)
            self.work.lead_to(len(fewest.mesh.tets))
            if self.listen.stopped or last or not self.work.left:
                return tried
            if len(tried) == 2 and fewest is tried[0]:
                lengths = lengths._replace(one_row=True)
            if not len(fewest.stuck):
                done = len(tried) > _FINER or self.areas is None or self.areas.holds(fewest)
                again = None if done else self.resampled(on, tolerance, lengths, finer, attempt=len(tried))
                if again is None:
                    return tried
                start, gone, (worth, part) = again, gone[:0], (self.worth, 1.0)
                continue
            if self._tries_more_rows(on, tried):
                three = lengths._replace(one_row=False)
                again = self.resampled(on, tolerance, three, attempt=len(tried))
                if again is not None:
                    start, gone, lengths = again, gone[:0], three
                    continue
            more = self._more_of(on, tried) if worth == self.worth else None
            if more is not None:
                start, gone, (worth, part) = fewest.mesh, fewest.released, more
                continue
            worth, part = self.worth, 1.0
            finer = self._finer(on, tried, finer)
            again = None
            if len(tried) <= self._restarts(on, tried):
                gone, again = fewest.released, None
                if not self._tries_whole(on, tried):
                    again = self._partial_restart(self._without(on, gone), tolerance, lengths, finer, tried)
                if again is None:
                    gone = gone[:0]
                    again = self.resampled(on, tolerance, lengths, finer, attempt=len(tried))
            if self.listen.stopped:
                return tried
            if again is None:  # more of the same
                last, worth, again, gone = True, np.inf, fewest.mesh, fewest.released
            start = again

    def _restarts(self, on: Reference, tried: list[SearchResult]) -> int:
        """How often to start anew from the best that was found so far."""
        fewest = best(tried)
        stuck, tets = len(fewest.stuck), len(fewest.mesh.tets)
        spoilt = len(tried[-1].stuck) > _SPOILT * stuck
        if self._several(on, fewest) and (spoilt or _IN_VAIN * tets < stuck <= _MANY_STUCK * tets):
            return 1 if self._tries_another(on, tried) else 0
        return _FINER_HELD if self.held is not None else _FINER

    def _finer(self, on: Reference, tried: list[SearchResult], finer: ShorterEdges) -> ShorterEdges:
        """Shorter edges too where the best is stuck; where there are too few points, where the last is."""
        stuck_in, share = best(tried), _SHARES[min(len(tried), len(_SHARES)) - 1]
        if len(on.regions) > 1:
            share = _AT_INTERFACES
            if len(stuck_in.stuck) > _TOO_FEW_POINTS * len(stuck_in.mesh.tets):
                stuck_in, share = tried[-1], _SHARES[-1]
        free, mesh = self._free(stuck_in), stuck_in.mesh
        return finer.about(mesh.points[free].mean(axis=1), share * mesh.size[free].mean(axis=1))

    def _more_of(self, on: Reference, tried: list[SearchResult]) -> tuple[float, float] | None:
        """With what worth and part of the work the search from the last start goes on; None where it does not."""
        last, patient = tried[-1], (_PATIENCE * self.worth, _PATIENT)
        stuck = len(last.stuck) / len(last.mesh.tets)
        if not self._several(on, last):
            return patient if len(tried) == 1 and stuck > _FEW_STUCK else None
        if stuck > _MANY_STUCK or last is not best(tried) or self._tries_another(on, tried):
            return None
        return (np.inf, _MOST) if stuck > _FEW_STUCK else patient

    @staticmethod
    def _tries_more_rows(on: Reference, tried: list[SearchResult]) -> bool:
        """Whether a start with more rows through layers, where it has any, is made before the first search goes on."""
        if len(tried) > 1 or len(on.regions) == 1:
            return False
        mesh, stuck = tried[0].mesh, tried[0].stuck
        at_corners = int((mesh.stratum[mesh.tets[stuck]] == 3).any(axis=1).sum())
        return at_corners > _STUCK_AT_CORNERS * len(mesh.tets)

    def _tries_another(self, on: Reference, tried: list[SearchResult]) -> bool:
        """Whether a finer start is made before the search from the first goes on."""
        first = tried[0]
        enough = len(first.stuck) > _ANOTHER * len(first.mesh.tets)
        return len(tried) == 1 and self._several(on, first) and enough

    def _tries_whole(self, on: Reference, tried: list[SearchResult]) -> bool:
        """Whether all is made anew after the search from the first start went on with most of the work."""
        first = tried[0]
        return len(tried) == 2 and self._several(on, first) and len(first.stuck) > _FEW_STUCK * len(first.mesh.tets)

    @staticmethod
    def _several(on: Reference, found: SearchResult) -> bool:
        """Whether there are interfaces, and tets enough for a search at them to go on."""
        return len(on.regions) > 1 and len(found.mesh.tets) >= _SEVERAL_TETS

    def _partial_restart(
        self,
        on: Reference,
        tolerance: Tolerance,
        lengths: Lengths,
        finer: ShorterEdges,
        tried: list[SearchResult],
    ) -> StratifiedMesh | None:
        """A partial restart: the best that was found, made anew round its stuck tets."""
        fewest = best(tried)
        vain = len(tried) - 1 - [_shortfall(one) for one in tried].index(_shortfall(fewest))
        for wider in range(_PARTIAL_RESTARTS):
            restart = PartialRestart.of(fewest, vain + wider, held=self.held is not None)
            start = restart and self.resampled(on, tolerance, lengths, finer, restart, len(tried))
            if start is not None:
                return start
        return None

    def _free(self, found: SearchResult) -> Ints:
        """(s, 4) the stuck tets that shorter edges may help, as they do not beside facets that are held."""
        stuck = found.mesh.tets[found.stuck]
        if self.held is None:
            return stuck
        pinned = (found.mesh.stratum == 3) & (found.mesh.label < 0)
        free: Ints = stuck[~pinned[stuck].any(axis=1)]
        return free

    def _loose(self, on: Reference) -> Ints:
        """Creases that the search may give up."""
        soft = np.setdiff1d(on.strata.soft_curves, self.firm)
        return soft if self.held is None else np.setdiff1d(soft, self.held.all_curves(on))

    def _without(self, on: Reference, creases: Ints) -> Reference:
        return without(on, creases, self.mesh.nodes.vertices.ravel())


def ranked(tried: list[SearchResult], missed: Callable[[SearchResult], float] = lambda _: 0.0) -> list[SearchResult]:
    """Those with the fewest bad tets first, no surface far off; of equals the last, from which others were tried.

    ``missed``: of what else equals are told apart by, the less the better.
    """
    shortfall = [_shortfall(one) for one in tried]
    equals = [shortfall.count(one) > 1 for one in shortfall]
    rest = [missed(one) if asked else 0.0 for one, asked in zip(tried, equals, strict=True)]
    return [tried[k] for k in sorted(range(len(tried)), key=lambda k: (shortfall[k], rest[k], -k))]


def _shortfall(found: SearchResult) -> float:
    """The bad tets, and as many more as a surface that has moved beyond the tolerance is worse than one of them."""
    return found.bad + _MOVED * found.beyond


def best(tried: list[SearchResult]) -> SearchResult:
    """The first of :func:`ranked`."""
    return ranked(tried)[0]
