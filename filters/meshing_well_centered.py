"""``filters.meshing_well_centered``: resample, reconnect and move until every tet is well-centered."""

import math
import warnings
from collections.abc import Callable
from copy import copy
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self, TypedDict

import numpy as np
from pydantic import ConfigDict, Field, field_validator, model_validator
from pydantic.json_schema import SkipJsonSchema

from wct_plugin.certify.overlapping_tets import overlap
from wct_plugin.errors import OptionError, WctWarning
from wct_plugin.io import read
from wct_plugin.measure import quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.measure.goals import DUAL, misses
from wct_plugin.measure.quality import Quality
from wct_plugin.measure.region_topology import changes, measure_region_topology
from wct_plugin.measure.thin_walls import thinnest
from wct_plugin.mesh import SurfaceMesh, TetMesh, unit_scaling
from wct_plugin.mesh.periodic import find_periodic
from wct_plugin.meshing import (
    beside,
    boundary_choice,
    coincident,
    conforming,
    curved,
    edge_length,
    loose_cells,
    parts_work,
    planes,
    required_cells,
    search_mesh,
    touching_pieces,
)
from wct_plugin.meshing.boundary_choice import Boundary, PatchChoices
from wct_plugin.meshing.edge_length import EdgeLength
from wct_plugin.meshing.followed_surface import outer
from wct_plugin.meshing.held_surface import HeldSurface
from wct_plugin.meshing.judgement import Asked, Found, judge
from wct_plugin.meshing.local_search import LocalSearch, best, ranked
from wct_plugin.meshing.local_tolerance import Tolerance, find_tolerance
from wct_plugin.meshing.periodic_pairs import PeriodicSurface, Unmatched
from wct_plugin.meshing.phase_progress import Listener
from wct_plugin.meshing.reference import Reference, own_boundary
from wct_plugin.meshing.reference_choice import choose
from wct_plugin.meshing.reference_fit import check_near, gap
from wct_plugin.meshing.released_creases import measure_none, measure_released
from wct_plugin.meshing.search_mesh import SearchMesh
from wct_plugin.meshing.surface_edges import Lengths, longest_edges
from wct_plugin.meshing.tet_limit import TetLimit
from wct_plugin.meshing.transfer import carry, resampled
from wct_plugin.meshing.work_limit import WorkLimit
from wct_plugin.objects.conversions import as_mesh
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import ProgressCallback
from wct_plugin.types import Floats, Metrics

if TYPE_CHECKING:  # the stubs' names are not in the module
    from wct_plugin.core._core import SearchedArrays


_LARGEST_TOLERANCE = 0.1


class MeshingOptions(Options):
    """What may change, how near the surface must stay, and how hard to try."""

    model_config = ConfigDict(arbitrary_types_allowed=True)

    goal: Literal["delaunay", "one-sided", "3wc", "cwc"] = Field(
        "cwc",
        description="delaunay: no vertex inside a tet's sphere, and of several regions none with a negative couple;"
        " one-sided: all signed duals of every region positive;"
        " 3wc: every tet contains its circumcenter; cwc: every triangle too",
    )
    boundary: Boundary = Field(
        "move",
        description="move: resampled; keep: vertices stay, facets may flip or split; fixed: facets stay; or one of them"
        " per group of facets, set or tag, * for the rest: contact=fixed,*=move",
    )
    tolerance: float | None = Field(
        None,
        gt=0,
        le=_LARGEST_TOLERANCE,
        description="Greatest distance from the reference, both ways, as a fraction of the diagonal"
        " (none: 1e-3, or the sag of the reference's own facets if larger)",
    )
    local_tolerance: bool = Field(
        True, description="Locally never more than a tenth of the wall, gap or radius there, nor less than a quarter"
    )
    reference: SkipJsonSchema[SurfaceMesh] | str | None = Field(
        None, description="Surface to stay near, or its file (none: the surface read at the start, or the own boundary)"
    )
    edge_length: float | str | dict[str, float] | SkipJsonSchema[np.ndarray] | None = Field(
        None,
        description="Edge length in the mesh's unit: a number > 0, one per point, the name of point data, or one per"
        " region or group of facets, * for the rest: oxide=0.01,*=0.1 (none, or no *: the input's own); shorter where"
        " the tolerance needs it",
    )
    surface_edges: float = Field(
        1.25,
        gt=0,
        description="How long edges of the surface may be on average, in the input's own there; on groups and"
        " interfaces 0.82 of that; of no effect with edge_length",
    )
    crease_angle: float = Field(
        40.0, gt=0, lt=180, description="Boundary edges that bend more than this are creases, in degrees"
    )
    planes: Literal["exact", "input"] = Field(
        "exact",
        description="exact: what is plane but for the rounding of a file becomes plane; input: all stays as it came",
    )
    merge: coincident.Merge = Field(
        "auto",
        description="Points that coincide exactly: auto: facets that do match again, other points stay apart; none: all"
        " stay apart; all: all are joined",
    )
    max_tets: int | None = Field(
        None,
        ge=1,
        description="Most tets that the new mesh may have (none: two million, or 20 times those that came if more)",
    )
    margin: float = Field(0.02, ge=0, le=0.1, description="Clearance aimed at: smallest h/R and smallest cosine")
    effort: int = Field(1, ge=1, le=100, description="Multiplies the work after which the search ends")
    seed: int = Field(0, ge=0, description="Of the random choices")
    allow_released: bool = Field(
        False,
        description="Accept, as on scans, that creases which leave well-centered tets no place become ordinary surface,"
        " and that more of its edges bend",
    )
    periodic: bool | None = Field(
        None,
        description="Sides that are translates of each other, as a periodic cell's are, match again (none: where the"
        " file says that they are periodic)",
    )
    force: bool = Field(False, description="Make the mesh anew although it meets the goal")

    @field_validator("boundary", mode="before")
    @classmethod
    def _per_group(cls, value: Any) -> Any:
        return boundary_choice.parse(value)

    @field_validator("edge_length", mode="before")
    @classmethod
    def _lengths(cls, value: Any) -> EdgeLength:
        return edge_length.parse(value)

    @field_validator("reference", mode="before")
    @classmethod
    def _surface_or_name(cls, value: Any) -> Any:
        if value is None or isinstance(value, str | SurfaceMesh):
            return value
        surface = None if isinstance(value, bool | int | float | dict) else as_mesh(value)
        if isinstance(surface, SurfaceMesh):
            return surface
        raise ValueError("must be a surface or the name of a surface file")

    @model_validator(mode="after")
    def _cheapest(self) -> Self:
        if self.goal in DUAL and self.edge_length is not None:
            raise ValueError(f"edge_length asks for other edges, goal {self.goal} for the cheapest change: drop one")
        if self.goal in DUAL and self.force:
            raise ValueError(f"force asks for a new mesh, goal {self.goal} for the cheapest change: drop one")
        return self


class MeshingWellCentered(FilterStage[MeshingOptions]):
    """Resample, reconnect and move until every tet contains its circumcenter; the surface stays within a tolerance.

    A lattice-like start (graded body-centered cubic inside, evenly spaced on patches and creases, relaxed) is repaired
    by local search: flips, edge removal, collapse, split, insertion and relocation round every tet that falls short.
    Where that is stuck, it goes on for longer, then starts again with shorter edges there, five times at most; if few
    tets are, the rest stays. All that ends after so much work, counted, as takes about 6 s and 4 ms per tet of CPU
    time; ``effort`` multiplies it.
    Regions and their interfaces, creases, corners and tagged facets and edges are kept, point data interpolated.
    Facets of a set RequiredTriangles and edges of a set RequiredEdges, as Medit's files have them, stay to the bit;
    other words of ``boundary`` for RequiredTriangles free its facets.
    Planes, straight creases and corners at them are kept exactly, and those that a file rounded are put right first;
    but for those smaller than 28 tolerances and 3 % of the diagonal: these move within the tolerance, as all that is
    curved does. Of the other creases, those that their angle alone makes and that hold tets back for long become
    ordinary surface within the tolerance, as on scans.
    With ``boundary`` keep or fixed the inside is filled anew between the surface facets, with up to twice the tets;
    where only some groups of facets stay, all else is resampled round them. With ``periodic``, and where the file
    says so, sides that are translates of each other match again, vertex for vertex.
    Where those or facets and edges tagged inside a region rule a new start out, the search starts from the mesh itself.
    Holes of the reference are closed and what of it runs on inside the body is cut off, by MeshLab, and followed where
    that bounds the mesh. Meshes of several regions, with tagged edges or vertices, or with tags that change where the
    reference has no edges follow their own facets instead of it, as do those that it does not bound.
    The goals delaunay and one-sided take the cheapest change instead: vertices of the surface stay with ``boundary``
    move too, those inside go where they crowd it, new ones come on it where its own are too far apart.
    A mesh that meets the goal, with its boundary within the tolerance, stays as it is, to the bit, also where it falls
    short of the margin; ``force`` or an edge length makes it anew.
    The metrics say which tets miss the goal, which option would free each, and how well the domain is kept.
    Hexahedra, wedges and pyramids stay as they are, and so do the facets that tets share with them. Tets with mid nodes
    are worked on by their corners; where they are curved the boundary stays near the curved surface.
    The unit of length is no matter: bounding boxes of 1e-90 to 1e90 across are taken, others are refused.
    """

    name = "meshing_well_centered"
    takes = TetMesh
    gives = TetMesh
    measures = True
    declaration = MeshingOptions
    example: ClassVar[dict[str, Any]] = {"tolerance": 2e-3, "goal": "3wc"}

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._surface = _load(self.options.reference)  # now, so that a file of no use is refused before any work

    def run(self, mesh: TetMesh, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        tets = beside.alone(mesh)
        one = copy(self)
        one.options = self.options.model_copy(
            update={"boundary": tets.boundary(self.options.boundary), "tolerance": self._tolerance_of_curved(mesh)}
        )
        made, metrics = one._improve(tets.mesh, progress)
        return tets.together(made), {**tets.metrics(metrics), "default_tolerance": self.options.tolerance is None}

    def _tolerance_of_curved(self, mesh: TetMesh) -> float | None:
        """The tolerance, which without one is as on straight tets: what the facets between the corners sag by."""
        of = mesh.second_order
        if self.options.tolerance is not None or of is None or not of.curved or self._surface:
            return self.options.tolerance
        unit_scaling.check(mesh)
        straight = unit_scaling.scaled(replace(mesh, reference=None), -unit_scaling.exponent(mesh.points))
        return min(own_boundary(straight, self.options.crease_angle).auto_tolerance(), _LARGEST_TOLERANCE)

    def _put_on_curved(self, made: TetMesh, found: Found, unit: int) -> tuple[TetMesh, Found]:
        """The mesh with its vertices on the curved surface, where that leaves as many tets good."""
        of, options = made.second_order, self.options
        stays = found.work["kept"] or found.work["stopped"] or self._surface
        if stays or of is None or not of.curved or options.goal == "delaunay" or options.goal == "one-sided":
            return made, found
        given = unit_scaling.scaled(made, -unit)
        moved = curved.on_surface(given, options.goal, options.margin, options.crease_angle)
        if moved is given or overlap(moved):
            return made, found
        return unit_scaling.scaled(moved, unit), found._replace(measured=quality.measure(moved))

    def _improve(self, mesh: TetMesh, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:
        unit_scaling.check(mesh)
        mesh = loose_cells.without(mesh)
        boundary = required_cells.boundary_of(self.options.boundary, mesh)
        if boundary != self.options.boundary:
            return self._with(boundary=boundary).run(mesh, progress)
        if self.options.merge == "all":
            mesh = coincident.merged(mesh)
        zipped = coincident.zip_up(mesh, self.options.merge)
        surface = self._surface or mesh.reference
        if surface:
            unit_scaling.check_reference(surface, mesh)
            check_near(surface, mesh)
        wanted = edge_length.at_points(self.options.edge_length, mesh)
        tangled = overlap(mesh)
        if tangled:
            warnings.warn(
                f"{mesh.source or 'the mesh'} overlaps itself: tets {tangled[0]} and {tangled[1]} do,"
                f" {_where(mesh, tangled)}; a result that still does is not valid and meets no goal",
                WctWarning,
                stacklevel=3,
            )
        unit = unit_scaling.exponent(mesh.points)
        if zipped:
            own, better, found = self._in_parts(mesh, zipped, surface, wanted, progress, tangled=tangled is not None)
        else:
            own, better, found = self._whole(mesh, surface, wanted, progress, tangled=tangled is not None)
        better, found = self._put_on_curved(better, found, unit)
        tolerance = math.ldexp(found.tolerance, unit)
        followed = replace(found.on, points=unit_scaling.rescaled(found.on.points, unit))
        required_cells.check_edges(mesh, better)
        options = self.options
        asked = Asked(
            options.goal,
            options.boundary,
            options.crease_angle,
            options.allow_released,
            pairs=self._wants_pairs(mesh),
            curved=not self._surface,
        )
        result = judge(mesh, own, better, found, followed, tolerance, asked)
        return better, {
            **result,
            **found.work,
            "tolerance": tolerance / (surface or mesh).diagonal,
        }

    def _with(self, **options: Any) -> Self:
        """The same with other options, which are good ones."""
        other = copy(self)
        other.options = self.options.model_copy(update=options)
        return other

    def _wants_pairs(self, mesh: TetMesh) -> bool:
        return mesh.periodic if self.options.periodic is None else self.options.periodic

    def _whole(
        self,
        mesh: TetMesh,
        surface: SurfaceMesh | None,
        wanted: Floats | None,
        progress: ProgressCallback,
        *,
        tangled: bool,
    ) -> tuple[Reference, TetMesh, Found]:
        """The mesh's own surface, the mesh made anew, or as it came, and what that took."""
        unit = unit_scaling.exponent(mesh.points)
        normalized = unit_scaling.scaled(replace(mesh, reference=surface), -unit)
        apart = touching_pieces.set_apart(normalized)
        if apart:
            normalized = apart.mesh
        pairs = find_periodic(normalized) if self._wants_pairs(mesh) else []
        own = own_boundary(normalized, self.options.crease_angle)
        choices = PatchChoices(self.options.boundary, mesh, own.strata)
        periodic = None
        if pairs and choices.word == "move" and self.options.goal not in DUAL:
            try:
                periodic = PeriodicSurface(normalized, pairs, self.options.boundary, self.options.crease_angle)
            except Unmatched as why:
                warnings.warn(f"periodic pairs of facets cannot be made to match: {why}", WctWarning, stacklevel=3)
            else:
                own, choices = periodic.own, periodic.choices
        if self.options.goal in DUAL:
            found = self._conform(normalized, own, choices, unit, progress, tangled=tangled)
        else:
            wanted = None if wanted is None else unit_scaling.rescaled(wanted, -unit)
            found = self._well_center(normalized, own, choices, periodic, wanted, unit, progress, tangled=tangled)
        better = mesh if surface is mesh.reference else replace(mesh, reference=surface)
        changed = found.mesh is not normalized
        if apart:
            on = apart.whole_surface(found.on)
            own = on if found.on is own else apart.whole_surface(own)
            found = found._replace(mesh=apart.whole(found.mesh), on=on)
        if changed:
            better = replace(unit_scaling.scaled(found.mesh, unit), reference=surface)
        return own, better, found

    def _in_parts(
        self,
        mesh: TetMesh,
        zipped: coincident.Zipped,
        surface: SurfaceMesh | None,
        wanted: Floats | None,
        progress: ProgressCallback,
        *,
        tangled: bool,
    ) -> tuple[Reference, TetMesh, Found]:
        """As :meth:`_whole`, for each part by itself, with the tolerance of the whole."""
        unit = unit_scaling.exponent(mesh.points)
        normalized = unit_scaling.scaled(mesh, -unit)
        own = own_boundary(normalized, self.options.crease_angle)
        PatchChoices(self.options.boundary, mesh, own.strata)  # names groups that are in no part
        diagonal = (surface or mesh).diagonal
        tolerance = (self.options.tolerance or own.auto_tolerance()) * diagonal
        reference = surface if len(zipped.parts) == 1 else None
        if surface is not reference:
            said = "the boundary is resampled on the mesh's own facets, not on the reference: bodies share no vertex"
            warnings.warn(said, WctWarning, stacklevel=3)
        made: list[TetMesh] = []
        works: list[Metrics] = []
        changed = False
        for part, points in zipped.parts:
            given = replace(part, reference=reference)
            most = self.options.max_tets and max(1, self.options.max_tets * len(part.tets) // len(mesh.tets))
            one = self._with(
                tolerance=tolerance / (reference or part).diagonal,
                boundary=boundary_choice.in_part(self.options.boundary, part, coincident.SHEETS),
                max_tets=most,
            )
            size = None if wanted is None else wanted[points]
            _, new, found = one._whole(given, reference, size, progress, tangled=tangled)
            made.append(new)
            works.append(found.work)
            changed |= new is not given
        better = replace(zipped.unzipped(made) if changed else mesh, reference=surface)
        measured = quality.measure(unit_scaling.scaled(better, -unit))
        work = parts_work.together(works, [(reference or part).diagonal / diagonal for part, _ in zipped.parts])
        return own, better, Found(better, measured, math.ldexp(tolerance, -unit), work, own)

    def _well_center(
        self,
        mesh: TetMesh,
        own: Reference,
        choices: PatchChoices,
        periodic: PeriodicSurface | None,
        wanted: Floats | None,
        unit: int,
        progress: ProgressCallback,
        *,
        tangled: bool,
    ) -> Found:
        """The mesh resampled, or made from itself, with as few bad tets as the search gets to.

        It is in 2 ** ``unit`` of the user's unit of length; ``tangled``: its tets overlap as it came.
        """
        options = self.options
        surface = mesh.reference
        moves = choices.word == "move"
        curves = required_cells.curves_of(mesh, own.strata)
        stays = moves and (choices.stays.any() or len(curves))
        kept = HeldSurface.of(own, choices.stays, choices.fixed, curves) if stays else None
        diagonal = (surface or mesh).diagonal
        reference, reason = own, ""
        if moves and surface is not None:
            reason = "facets of it stay"
            if kept is None:
                exact = planes.precision(surface.points, unit)
                reference, reason = choose(mesh, own, surface, options.crease_angle, options.tolerance, exact)
        straight, plane = periodic.mesh if periodic else mesh, None
        if moves and options.planes == "exact" and kept is None and periodic is None:
            if reference is own:
                straight, own, plane = planes.straightened_mesh(mesh, own, planes.precision(mesh.points, unit))
                reference = own
            else:
                reference, plane = planes.straightened(reference, exact)
        tolerance = held = (options.tolerance or reference.auto_tolerance()) * diagonal
        if surface is not None and reason:
            warnings.warn(
                f"the boundary is resampled on the mesh's own facets, not on the reference: {reason}",
                WctWarning,
                stacklevel=3,
            )
            held -= gap(own, surface, tolerance)  # what lies between the two comes off the tolerance
        within = self._within(reference, own, surface, held)
        least = within.least(reference, diagonal, math.ldexp(1.0, unit))
        measured = quality.measure(mesh)
        bad = self._bad(mesh, measured)
        few_enough = options.max_tets is None or len(mesh.tets) <= options.max_tets
        asked = wanted is not None or options.force or not few_enough
        if not bad and not asked and _follows(mesh, own, reference, tolerance):
            none: Metrics = {"passes": 0, "kicks": 0, "evaluations": 0, "stopped": False, "kept": True}
            none |= {"planes": plane, "local_tolerance": least, "estimate": None, "released": measure_none(own)}
            none |= {"exhausted": False, "needed": None}
            return Found(mesh, measured, tolerance, none, reference)
        self._warn_of_thin_walls(mesh, tolerance, unit)
        listen = Listener(progress, bad)
        acute = options.goal == "cwc"
        limit = TetLimit(options.max_tets, len(mesh.tets), listen)
        allowed = WorkLimit(len(mesh.tets), options.effort)
        fixed = np.flatnonzero(choices.fixed)
        search = LocalSearch(
            straight,
            choices.word,
            acute,
            options.margin,
            options.effort,
            options.seed,
            listen,
            limit,
            allowed,
            kept,
            fixed,
            fixed[:0] if periodic is None else periodic.firm,
            options.crease_angle,
        )
        fresh = None
        if moves and not _has_rough_sheets(mesh, own):
            most = None if wanted is not None else longest_edges(mesh, own, reference, options.surface_edges)
            lengths = Lengths(wanted, most)
            fresh = search.resampled(reference, within, lengths)
        if fresh is not None:
            tried = search.run_finer(fresh, reference, within, lengths)
            if periodic:
                tried = _with_pairs(periodic, search, tried, within)
        else:
            if reference is not own:
                within = self._within(own, own, None, held)
                least = within.least(own, diagonal, math.ldexp(1.0, unit))
            reference = own
            start = self._own_start(straight, own, choices, wanted, listen, limit)
            stays = listen.stopped or not limit.takes(len(start["tets"]))
            tried = [] if stays else [search.run(start, own, within, np.inf if moves else search.worth)]
        work: Metrics = {name: sum(one[name] for one in tried) for name in ("passes", "kicks", "evaluations")}
        work |= {"stopped": listen.stopped, "kept": False, "planes": plane, "estimate": limit.expected}
        work |= {"exhausted": allowed.reached, "needed": limit.needed}
        work["local_tolerance"] = least
        if not tried:  # stopped before there was any other mesh, or none has few enough tets
            work["released"] = measure_none(own)
            limit.warn(missed=bad > 0 or asked)
            return Found(mesh, measured, tolerance, work, reference)
        faults: list[str] = []
        found, better = None, mesh
        for one in ranked(tried):
            made = carry(mesh, own.strata, resampled(one, reference))
            fault = self._fault(mesh, made, reference, tolerance, unit, tangled=tangled, stopped=listen.stopped)
            if not fault:
                found, better = one, made
                break
            faults.append(fault)
        if found is None and not listen.stopped:
            _warn_of_fault(faults[0])
        listen.measure(found["bad"] if found else bad)
        after = quality.measure(better)
        gain = bad * len(after) - self._bad(better, after) * len(measured)
        if few_enough and (gain < 0 or (gain == 0 and listen.stopped)):  # the output is never worse
            better, after = mesh, measured
            if not listen.stopped:
                warnings.warn("nothing better was found; the mesh stays as it is", WctWarning, stacklevel=3)
        limit.warn(missed=self._bad(better, after) > 0 or not limit.holds(len(better.tets)) or wanted is not None)
        work["released"] = measure_released(
            reference, found["released"] if found and better is not mesh else np.empty(0, dtype=np.int64)
        )
        return Found(better, after, tolerance, work, reference)

    def _fault(
        self, old: TetMesh, new: TetMesh, on: Reference, tolerance: float, unit: int, *, tangled: bool, stopped: bool
    ) -> str:
        """Why a new mesh is no better than the old one, whatever its tets are like; empty where nothing is wrong.

        ``stopped``: the work was cut short, when its surface may not be near the one that is followed yet.
        """
        crossed = None if tangled else overlap(new)
        if crossed:
            return f"the new mesh overlaps itself {_where(unit_scaling.scaled(new, unit), crossed)}"
        if changes(measure_region_topology(old), measure_region_topology(new)):
            return "the new mesh has another topology"
        if stopped:
            surface = outer(on)
            allowed = max(tolerance, measure_deviation(old.boundary_surface(), surface, compiled=True).max)
            if measure_deviation(new.boundary_surface(), surface, compiled=True).max > allowed:
                return "the new mesh is not near the surface yet"
        return ""

    def _within(self, on: Reference, own: Reference, surface: SurfaceMesh | None, held: float) -> Tolerance:
        """The tolerance place by place; where the mesh is off the surface already, no less than that."""
        if not self.options.local_tolerance:
            return Tolerance(held)
        apart = gap(own, surface, held) if surface is not None and on is not own else 0.0
        return find_tolerance(on, held, apart)

    def _share(self, start: SearchMesh) -> float:
        """Of the tets that miss the goal in a start of the search."""
        mesh = TetMesh(start["points"], start["tets"])
        return self._bad(mesh, quality.measure(mesh)) / len(mesh.tets)

    def _bad(self, mesh: TetMesh, measured: Quality) -> int:
        return int(misses(mesh, measured, self.options.goal).sum())

    def _conform(
        self,
        mesh: TetMesh,
        own: Reference,
        choices: PatchChoices,
        unit: int,
        progress: ProgressCallback,
        *,
        tangled: bool,
    ) -> Found:
        """The cheapest change that makes the mesh Delaunay or one-sided: none, where it is; ``unit`` as above."""
        options = self.options
        surface = mesh.reference
        tolerance = (options.tolerance or own.auto_tolerance()) * (surface or mesh).diagonal
        better, after = mesh, quality.measure(mesh)
        bad = self._bad(mesh, after)
        if not bad:
            return Found(mesh, after, tolerance, {"stopped": False, "kept": True}, own)
        self._warn_of_thin_walls(mesh, tolerance, unit)
        listen = Listener(progress, bad)
        if not listen.stopped:
            asked: _ConformAsked = {
                "one_sided": options.goal == "one-sided",
                "effort": options.effort,
                "seed": options.seed + 1,
                "progress": listen.conform,
            }
            if choices.fixed.any() or _has_sheets(mesh, own):
                found = conforming.conform_inside(mesh, own, **asked)
            else:
                found = conforming.conform(mesh, own, surface, tolerance, **asked)
            new = mesh if found is None else carry(mesh, own.strata, found)
            if options.max_tets is not None and len(new.tets) > options.max_tets:
                new = mesh
            measured = quality.measure(new)
            left = self._bad(new, measured)
            fault = self._fault(mesh, new, own, tolerance, unit, tangled=tangled, stopped=False) if found else ""
            if fault:
                _warn_of_fault(fault)
            elif left * len(mesh.tets) < bad * len(new.tets):  # the output is never worse
                better, after, bad = new, measured, left
            elif not listen.stopped:
                warnings.warn("nothing better was found; the mesh stays as it is", WctWarning, stacklevel=3)
            listen.measure(bad)
        return Found(better, after, tolerance, {"stopped": listen.stopped, "kept": False}, own)

    def _warn_of_thin_walls(self, mesh: TetMesh, tolerance: float, unit: int) -> None:
        """Say where the two sides of a wall, each within the tolerance, may meet."""
        thin = None if self.options.boundary == "fixed" else thinnest(mesh, 2.0 * tolerance)
        if not thin:
            return
        body = "the body" if (mesh.regions == thin.region).all() else f"region {thin.region}"
        thickness, x, y, z = (math.ldexp(one, unit) for one in (thin.thickness, *thin.place))
        diagonal = (mesh.reference or mesh).diagonal
        warnings.warn(
            f"{body} is {thickness:.3g} thick near ({x:.4g}, {y:.4g}, {z:.4g}), thinner than twice the tolerance of"
            f" {tolerance / diagonal:.2e} of the diagonal, within which its two sides may meet; use a tolerance below"
            f" {thin.thickness / 2.0 / diagonal:.2e}",
            WctWarning,
            stacklevel=4,
        )

    def _own_start(
        self,
        mesh: TetMesh,
        own: Reference,
        choices: PatchChoices,
        size: Floats | None,
        listen: Listener,
        limit: TetLimit,
    ) -> SearchMesh:
        """The mesh, or its inside filled anew where its surface stays: whichever has the smaller share of bad tets."""
        moves = choices.word == "move"
        pinned = np.zeros(len(mesh.points), dtype=bool)
        pinned[own.strata.triangles[choices.stays[own.strata.patch]]] = True
        start = search_mesh.from_mesh(mesh, own, pinned=pinned if moves else True)
        if size is not None:
            start["size"] = size
        if moves or listen.stopped:
            return start
        acute, seed = self.options.goal == "cwc", self.options.seed + 1
        refilled = search_mesh.refill(start, own.sides, size, acute=acute, seed=seed, progress=listen.resample)
        if refilled is None or listen.stopped or not limit.takes(len(refilled["tets"])):
            return start
        if limit.holds(len(start["tets"])) and self._share(refilled) >= self._share(start):
            return start
        return refilled


class _ConformAsked(TypedDict):
    """What both ways to conform are asked."""

    one_sided: bool
    effort: int
    seed: int
    progress: Callable[[float, int], bool]


def _where(mesh: TetMesh, tets: tuple[int, int]) -> str:
    """The place of two tets that overlap."""
    x, y, z = mesh.points[mesh.tets[list(tets)]].mean(axis=(0, 1)).tolist()
    return f"near ({x:.4g}, {y:.4g}, {z:.4g})"


def _follows(mesh: TetMesh, own: Reference, reference: Reference, tolerance: float) -> bool:
    """Whether the boundary is within the tolerance of the reference, both ways; it is where that is its own."""
    if reference is own:
        return True
    return measure_deviation(mesh.boundary_surface(), outer(reference), compiled=True).max <= tolerance


def _warn_of_fault(fault: str) -> None:
    said = f"{fault}; the mesh stays as it is: a smaller tolerance or shorter edges may help"
    warnings.warn(said, WctWarning, stacklevel=4)


def _with_pairs(
    periodic: PeriodicSurface, search: LocalSearch, tried: "list[SearchedArrays]", tolerance: Tolerance
) -> "list[SearchedArrays]":
    """What was found with pairs that match; as it was, with a warning, where that cannot be."""
    try:
        return periodic.matched(search, best(tried), tolerance)
    except Unmatched as why:
        warnings.warn(f"periodic pairs of facets cannot be made to match: {why}", WctWarning, stacklevel=5)
        return tried


def _has_sheets(mesh: TetMesh, own: Reference) -> bool:
    """Whether facets inside a region are tagged."""
    return len(own.strata.triangles) > len(mesh.topology.boundary) + len(mesh.topology.interfaces)


def _has_rough_sheets(mesh: TetMesh, own: Reference) -> bool:
    """Whether facets tagged inside regions bend at most of their edges, as picked from a mesh: all corners stay then.

    No new start can have better tets beside them, and sizes between them go to nothing.
    """
    patch = own.strata.patch[len(mesh.topology.boundary) + len(mesh.topology.interfaces) :]
    return 2 * len(np.unique(patch)) > len(patch)


def _load(reference: SurfaceMesh | str | None) -> SurfaceMesh | None:
    if not isinstance(reference, str):
        return reference
    surface = read(reference)
    if isinstance(surface, TetMesh):
        raise OptionError(f"{reference}: the reference must be a surface, here is a tet mesh")
    return surface
