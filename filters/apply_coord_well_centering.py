"""``filters.apply_coord_well_centering``: move vertices, nothing else."""

from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from wct_plugin.core import _core
from wct_plugin.measure import compiled_quality
from wct_plugin.measure.conserved import measure_groups
from wct_plugin.measure.fidelity import measure_volumes, region_names
from wct_plugin.measure.losses import find_changes
from wct_plugin.mesh import TetMesh, unit_scaling
from wct_plugin.mesh.strata import find_strata
from wct_plugin.meshing import required_cells
from wct_plugin.obstructions.remaining_tets import list_remaining
from wct_plugin.pipeline.stage import FilterStage, OfDiagonal, Options
from wct_plugin.progress import Progress, ProgressCallback
from wct_plugin.types import Metrics


class CoordWellCenteringOptions(Options):
    """What the vertices may do and what they aim at."""

    goal: Literal["3wc", "cwc"] = Field(
        "cwc", description="3wc: every tet contains its circumcenter; cwc: every triangle too"
    )
    boundary: Literal["fixed", "slide"] = Field(
        "slide", description="fixed: boundary vertices stay; slide: they move on their own patch or crease"
    )
    tolerance: Annotated[float | None, OfDiagonal] = Field(
        1e-3,
        gt=0,
        le=0.1,
        description="Farthest that sliding may take curved surfaces off where they were, "
        "as a fraction of the bounding-box diagonal; null: no limit",
    )
    margin: float = Field(0.02, ge=0, le=0.3, description="Clearance aimed at: smallest h/R and smallest cosine")
    crease_angle: float = Field(
        40.0, gt=0, lt=180, description="Boundary edges that bend more than this stay, in degrees"
    )
    effort: int = Field(1, ge=1, le=100, description="Multiplies the iterations; time grows with it")


class ApplyCoordWellCentering(FilterStage[CoordWellCenteringOptions]):
    """Move vertices so that more tets are well-centered; connectivity, ids, tags and data stay.

    No tet is ever inverted and never fewer tets contain their circumcenter than before. Sliding vertices stay on the
    surface that came in, and the facets between them, where it is curved, within the tolerance of it. Interfaces
    between regions and tagged facets count as boundary; tagged edges as creases, tagged vertices as corners. Vertices
    shared with other cells, and those of the sets RequiredTriangles and RequiredEdges, stay.
    Volumes of regions and sizes of tagged groups that change by more than .5 % are among the losses, and no success.
    The metrics say which tets miss the goal, and what in the connectivity or the boundary provably rules it out.
    """

    name = "apply_coord_well_centering"
    takes = TetMesh
    gives = TetMesh
    measures = True
    declaration = CoordWellCenteringOptions
    example: ClassVar[dict[str, Any]] = {"goal": "3wc", "boundary": "fixed"}

    def run(self, mesh: TetMesh, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        options = self.options
        unit_scaling.check(mesh)
        unit = unit_scaling.exponent(mesh.points)  # the core works in a unit in which nothing under- or overflows
        normalized = unit_scaling.scaled(mesh, -unit)
        surface = find_strata(mesh, options.crease_angle)
        slides = options.boundary == "slide"
        stays = required_cells.vertices_of(mesh) | (not slides and surface.stratum > 0)
        if mesh.others:
            stays[mesh.others.shared[mesh.others.shared >= 0]] = True
        strata = replace(
            surface,
            stratum=np.where(stays, 3, surface.stratum).astype(np.int8),
            label=np.where(stays, -1, surface.label),
        )
        tolerance = np.inf if options.tolerance is None else options.tolerance * normalized.diagonal
        points, report = _core.move_vertices(
            normalized.points,
            mesh.tets,
            strata,
            goal=options.goal,
            margin=options.margin,
            effort=options.effort,
            tolerance=tolerance,
            progress=lambda done, bad: progress(Progress("moving vertices", done, bad)) is not False,
        )
        moved = replace(mesh, points=unit_scaling.rescaled(points, unit), mends=False)
        left = list_remaining(
            moved,
            surface,
            compiled_quality.measure(moved),
            goal=options.goal,
            boundary=options.boundary,
            crease_angle=options.crease_angle,
            stopped=report["stopped"],
            connectivity="fixed",
        )
        return moved, {**report, **(_sizes(mesh, moved) if slides else {}), "remaining": left}


def _sizes(old: TetMesh, new: TetMesh) -> Metrics:
    """Volumes of regions and sizes of groups, which sliding on what is curved changes, and which by too much."""
    volumes, groups = measure_volumes(old, new, {}), measure_groups(old, new, {})
    return {"volumes": volumes, "groups": groups, "losses": find_changes(volumes, groups, region_names(old))}
