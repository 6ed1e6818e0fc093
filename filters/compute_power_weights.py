"""``filters.compute_power_weights``: weights whose power dual is positive where positions alone fail."""

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from wct_plugin.errors import WctError
from wct_plugin.measure import compiled_quality, duals
from wct_plugin.measure.negative_duals import count_negative_duals
from wct_plugin.mesh import TetMesh, unit_scaling
from wct_plugin.mesh.manifold import check_manifold
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import Progress, ProgressCallback
from wct_plugin.types import Metrics
from wct_plugin.weights.infeasibility import contradiction, separate
from wct_plugin.weights.linear_programs import power_weights

#: How many of the tets without their orthocenter the metrics name.
_NAMED = 100
#: How many of those are explained, if they can be: a proof may take a second.
_EXPLAINED = 25


class PowerWeightsOptions(Options):
    """What the weights aim at."""

    margin: float = Field(
        0.1,
        gt=0,
        le=0.2,
        description="Height of the orthocenter over each facet aimed at, in the tet's root mean square edge length",
    )
    strict: bool = Field(
        False, description="Refuse a mesh for which no weights were found that give every tet its orthocenter"
    )


class ComputePowerWeights(FilterStage[PowerWeightsOptions]):
    """Give each vertex a weight so that every tet contains its orthocenter: weighted well-centered.

    The mesh stays as it is. With a power distance |x - x_i|^2 - w_i in the place of the distance, the dual is still
    orthogonal to the mesh, and positive where every tet contains its orthocenter, also where it does not contain its
    circumcenter; it is not well-centered for that. Weights come from descent over the whole mesh and, where that leaves
    tets without or with a small margin, sparse linear programmes around them. Point data: ``power_weight`` (length
    squared, the smallest 0) and ``weighted_dual_volume``. Cell data: ``orthocenter_margin``, its smallest height over a
    facet in the tet's root mean square edge length (positive: contained), and ``min_weighted_dual_length``.
    ``compute_duals(mesh, weights)`` has all.
    Where a tet goes without, it is often because no weights exist: ``contradictions`` in the metrics names groups of
    tets, each proven in exact arithmetic to hold one at least that no weights can help together with the others.
    Refused are meshes with two points in one place and those whose boundary is no manifold.
    """

    name = "compute_power_weights"
    takes = TetMesh
    gives = TetMesh
    declaration = PowerWeightsOptions
    example: ClassVar[dict[str, Any]] = {"margin": 0.05}

    def run(self, mesh: TetMesh, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        unit_scaling.check(mesh)
        check_manifold(mesh)

        stopped = False

        def told(done: float, bad: int) -> bool:
            nonlocal stopped
            stopped = progress(Progress("weighing vertices", done, bad)) is False
            return not stopped

        found = power_weights(mesh, self.options.margin, told)
        outside = np.flatnonzero(~(found.margins > 0))
        known = np.isfinite(found.margins)
        asked = [] if stopped else [tet for tet in outside[:_EXPLAINED].tolist() if known[tet]]
        reasons = [contradiction(mesh.points, mesh.tets, found.heights, tet, found.margins > 0) for tet in asked]
        proven = [one for one in reasons if one]
        if self.options.strict and len(outside):
            more = f" (nor {len(outside) - 1} more)" if len(outside) > 1 else ""
            why = f"; none exist: tets {' '.join(map(str, proven[0].names))} exclude each other" if proven else ""
            raise WctError(
                f"{mesh.source or 'the mesh'}: no weights were found that give tet {outside[0]}{more} its orthocenter"
                f"{why}; with strict=false the others get theirs"
            )
        plain, weighted = duals.compute_duals(mesh), duals.compute_duals(mesh, found.weights)
        marked = replace(
            mesh,
            point_data={
                **mesh.point_data,
                "power_weight": found.weights,
                "weighted_dual_volume": weighted.volumes,
            },
            cell_data={
                **mesh.cell_data,
                "orthocenter_margin": found.margins,
                "min_weighted_dual_length": duals.shortest_lengths(mesh, weighted.lengths),
            },
        )
        count = len(mesh.tets)
        centered = int(compiled_quality.measure(mesh).well_centered_3.sum())
        return marked, {
            "3wc": {"count": centered, "percent": 100.0 * centered / count},
            "weighted_well_centered": {
                "count": count - len(outside),
                "percent": 100.0 * (count - len(outside)) / count,
            },
            "margin": float(np.nanmin(found.margins)),
            "stopped": stopped,
            "without_orthocenter": outside[:_NAMED].tolist(),
            "contradictions": {
                "missed_at_least": separate(proven),
                "proven": [one.to_dict() for one in proven],
            },
            "negative_duals": {
                "circumcentric": count_negative_duals(mesh, plain).to_dict(),
                "weighted": count_negative_duals(mesh, weighted).to_dict(),
            },
        }
