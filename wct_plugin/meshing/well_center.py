"""The remesher: any tet mesh in, a well-centered one of the same domain out."""

import math
import warnings
from dataclasses import dataclass, replace

from wct_plugin.certify.overlapping_tets import overlap
from wct_plugin.errors import WctWarning
from wct_plugin.measure import compiled_quality
from wct_plugin.measure.goals import DUAL
from wct_plugin.mesh import SurfaceMesh, TetMesh, unit_scaling
from wct_plugin.mesh.periodic import find_periodic
from wct_plugin.meshing import (
    beside,
    boundary_choice,
    coincident,
    curved,
    edge_length,
    loose_cells,
    parts_work,
    required_cells,
    touching_pieces,
)
from wct_plugin.meshing.boundary_choice import PatchChoices
from wct_plugin.meshing.cheapest_change import change_least
from wct_plugin.meshing.judgement import Asked, Found, judge
from wct_plugin.meshing.new_mesh_faults import describe_place
from wct_plugin.meshing.normalized_mesh import NormalizedMesh
from wct_plugin.meshing.periodic_pairs import PeriodicSurface, Unmatched, warn_unmatched
from wct_plugin.meshing.reference import Reference, own_boundary
from wct_plugin.meshing.reference_choice import warn_of_own_facets
from wct_plugin.meshing.reference_fit import check_near
from wct_plugin.meshing.remesh import remesh
from wct_plugin.meshing.well_center_options import LARGEST_TOLERANCE, WellCenterOptions
from wct_plugin.progress import ProgressCallback
from wct_plugin.types import Floats, Metrics


def well_center(
    mesh: TetMesh,
    options: WellCenterOptions | None = None,
    *,
    reference: SurfaceMesh | None = None,
    progress: ProgressCallback = lambda _: None,
) -> tuple[TetMesh, Metrics]:
    """Resample, reconnect and move until every tet meets the goal; the surface stays within a tolerance.

    Parameters
    ----------
    mesh : TetMesh
        In any unit of length; with the tags, sets, names and data that are to come back.
    options : WellCenterOptions
        None: all as by default.
    reference : SurfaceMesh
        The surface to stay near; None: the one that the mesh was made from, if it knows that, or else its own boundary.
    progress : callable
        Hears a :class:`wct_plugin.progress.Progress` now and then; returns False to stop, which gives the best so far.

    Returns
    -------
    TetMesh
        The same object where the mesh met the goal as it came.
    dict
        What was reached, what of the old mesh was kept, and what it took; ``losses`` lists what was not kept.

    Raises
    ------
    OptionError
        For an option that does not fit the mesh, as a group that it has not.
    InputError
        For a mesh or a reference that cannot be worked on.

    Warns
    -----
    WctWarning
        For each thing that was not kept.
    """
    options = options or WellCenterOptions()
    default_tolerance = options.tolerance is None
    tets = beside.alone(mesh)
    options = replace(
        options,
        boundary=tets.boundary(options.boundary),
        tolerance=_tolerance_of_curved(mesh, options, given=reference is not None),
    )
    made, metrics = _improve(tets.mesh, options, reference, progress)
    return tets.together(made), {**tets.metrics(metrics), "default_tolerance": default_tolerance}


def _tolerance_of_curved(mesh: TetMesh, options: WellCenterOptions, *, given: bool) -> float | None:
    """The tolerance, which without one is as on straight tets: what the facets between the corners sag by."""
    of = mesh.second_order
    if options.tolerance is not None or of is None or not of.curved or given:
        return options.tolerance
    unit_scaling.check(mesh)
    straight = unit_scaling.scaled(mesh.altered(reference=None), -unit_scaling.exponent(mesh.points))
    return min(own_boundary(straight, options.crease_angle).auto_tolerance(), LARGEST_TOLERANCE)


def _improve(
    mesh: TetMesh, options: WellCenterOptions, reference: SurfaceMesh | None, progress: ProgressCallback
) -> tuple[TetMesh, Metrics]:
    """Tets alone; what was reached is judged on the meshes themselves."""
    unit_scaling.check(mesh)
    mesh = loose_cells.without(mesh)
    options = replace(options, boundary=required_cells.boundary_of(options.boundary, mesh))
    if options.merge == "all":
        mesh = coincident.merged(mesh)
    zipped = coincident.zip_up(mesh, options.merge)
    surface = reference or mesh.reference
    if surface:
        unit_scaling.check_reference(surface, mesh)
        check_near(surface, mesh)
    work = _Work(options, edge_length.at_points(options.edge_length, mesh), _warn_of_overlap(mesh), progress)
    own, better, found = work.in_parts(mesh, zipped, surface) if zipped else work.whole(mesh, surface)
    unit = unit_scaling.exponent(mesh.points)
    if reference is None:
        better, found = _put_on_curved(better, found, options, unit)
    tolerance = math.ldexp(found.tolerance, unit)
    followed = replace(found.on, points=unit_scaling.rescaled(found.on.points, unit))
    required_cells.check_edges(mesh, better)
    asked = Asked(
        options.goal,
        options.boundary,
        options.crease_angle,
        options.allow_released,
        pairs=work.wants_pairs(mesh),
        curved=reference is None,
    )
    result = judge(mesh, own, better, found, followed, tolerance, asked)
    return better, {**result, **found.work, "tolerance": tolerance / (surface or mesh).diagonal}


def _warn_of_overlap(mesh: TetMesh) -> bool:
    """Say which tets overlap as they came, if any do."""
    tangled = overlap(mesh)
    if tangled:
        warnings.warn(
            f"{mesh.source or 'the mesh'} overlaps itself: tets {tangled[0]} and {tangled[1]} do,"
            f" {describe_place(mesh, tangled)}; a result that still does is not valid and meets no goal",
            WctWarning,
            stacklevel=3,
        )
    return tangled is not None


def _put_on_curved(made: TetMesh, found: Found, options: WellCenterOptions, unit: int) -> tuple[TetMesh, Found]:
    """The mesh with its vertices on the curved surface, where that leaves as many tets good."""
    of = made.second_order
    stays = found.work["kept"] or found.work["stopped"]
    if stays or of is None or not of.curved or options.goal == "delaunay" or options.goal == "one-sided":
        return made, found
    given = unit_scaling.scaled(made, -unit)
    moved = curved.on_surface(given, options.goal, options.margin, options.crease_angle)
    if moved is given or overlap(moved):
        return made, found
    return unit_scaling.scaled(moved, unit), found._replace(measured=compiled_quality.measure(moved))


@dataclass(frozen=True, eq=False)
class _Work:
    """The work on a mesh: whole, or on each of the parts that share no vertex."""

    options: WellCenterOptions
    wanted: Floats | None  #: (n,) edge lengths, in the user's unit
    tangled: bool  #: whether tets overlap as they came
    progress: ProgressCallback

    def wants_pairs(self, mesh: TetMesh) -> bool:
        """Whether sides that are translates of each other are to stay so."""
        return mesh.periodic if self.options.periodic is None else self.options.periodic

    def whole(self, mesh: TetMesh, surface: SurfaceMesh | None) -> tuple[Reference, TetMesh, Found]:
        """The mesh's own surface, the mesh made anew, or as it came, and what that took."""
        options, unit = self.options, unit_scaling.exponent(mesh.points)
        normalized = unit_scaling.scaled(mesh.altered(reference=surface), -unit)
        apart = touching_pieces.set_apart(normalized)
        if apart:
            normalized = apart.mesh
        given = self._normalized(normalized, mesh, unit)
        if options.goal in DUAL:
            found = change_least(given, options, self.progress)
        else:
            wanted = None if self.wanted is None else unit_scaling.rescaled(self.wanted, -unit)
            found = remesh(given, wanted, options, self.progress)
        own = given.own
        better = mesh if surface is mesh.reference else mesh.altered(reference=surface)
        changed = found.mesh is not normalized
        if apart:
            on = apart.whole_surface(found.on)
            own = on if found.on is own else apart.whole_surface(own)
            found = found._replace(mesh=apart.whole(found.mesh), on=on)
        if changed:
            better = unit_scaling.scaled(found.mesh, unit).altered(reference=surface)
        return own, better, found

    def _normalized(self, normalized: TetMesh, mesh: TetMesh, unit: int) -> NormalizedMesh:
        """What the remesher works on; with the pairs of ``mesh``, where they are to match and can."""
        options = self.options
        pairs = find_periodic(normalized) if self.wants_pairs(mesh) else []
        own = own_boundary(normalized, options.crease_angle)
        choices = PatchChoices(options.boundary, mesh, own.strata)
        if pairs and choices.word == "move" and options.goal not in DUAL:
            try:
                periodic = PeriodicSurface(normalized, pairs, options.boundary, options.crease_angle)
            except Unmatched as why:
                warn_unmatched(why)
            else:
                return NormalizedMesh(normalized, periodic.own, periodic.choices, unit, self.tangled, periodic)
        return NormalizedMesh(normalized, own, choices, unit, self.tangled)

    def in_parts(
        self, mesh: TetMesh, zipped: coincident.Zipped, surface: SurfaceMesh | None
    ) -> tuple[Reference, TetMesh, Found]:
        """As :meth:`whole`, for each part by itself, with the tolerance of the whole."""
        options, unit = self.options, unit_scaling.exponent(mesh.points)
        normalized = unit_scaling.scaled(mesh, -unit)
        own = own_boundary(normalized, options.crease_angle)
        PatchChoices(options.boundary, mesh, own.strata)  # names groups that are in no part
        diagonal = (surface or mesh).diagonal
        tolerance = (options.tolerance or own.auto_tolerance()) * diagonal
        reference = surface if len(zipped.parts) == 1 else None
        if surface is not reference:
            warn_of_own_facets("bodies share no vertex")
        made: list[TetMesh] = []
        works: list[Metrics] = []
        changed = False
        for part, points in zipped.parts:
            given = part.altered(reference=reference)
            of_part = replace(
                options,
                tolerance=tolerance / (reference or part).diagonal,
                boundary=boundary_choice.in_part(options.boundary, part, coincident.SHEETS),
                max_tets=options.max_tets and max(1, options.max_tets * len(part.tets) // len(mesh.tets)),
            )
            wanted = None if self.wanted is None else self.wanted[points]
            _, new, found = replace(self, options=of_part, wanted=wanted).whole(given, reference)
            made.append(new)
            works.append(found.work)
            changed |= new is not given
        better = (zipped.unzipped(made) if changed else mesh).altered(reference=surface)
        measured = compiled_quality.measure(unit_scaling.scaled(better, -unit))
        work = parts_work.together(works, [(reference or part).diagonal / diagonal for part, _ in zipped.parts])
        return own, better, Found(better, measured, math.ldexp(tolerance, -unit), work, own)
