"""``filters.compute_scalar_by_well_centeredness``: how well-centered each tet is, as arrays to look at."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.measure import compiled_quality, duals
from wct_plugin.mesh import TetMesh, unit_scaling
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import ProgressCallback
from wct_plugin.types import Metrics


class WellCenterednessOptions(Options):
    """There is nothing to choose."""


class ComputeScalarByWellCenteredness(FilterStage[WellCenterednessOptions]):
    """Write per tet min_h_over_R, largest angles, flags and the shortest dual edge; per point the dual volume.

    Cell data: ``min_h_over_R`` (positive: 3WC), ``max_face_angle`` and ``max_dihedral_angle`` in degrees, ``is_3wc``,
    ``is_2wc``, ``is_cwc``, ``is_acute`` as 0 or 1, ``min_dual_length``, the shortest signed dual edge through the tet's
    facets. Point data: ``dual_volume``, the signed volume of the point's circumcentric dual cell.
    """

    name = "compute_scalar_by_well_centeredness"
    takes = TetMesh
    gives = TetMesh
    declaration = WellCenterednessOptions

    def run(self, mesh: TetMesh, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        unit_scaling.check(mesh)
        measured = compiled_quality.measure(mesh)
        dual = duals.compute_duals(mesh)
        flags = {
            "is_3wc": measured.well_centered_3,
            "is_2wc": measured.well_centered_2,
            "is_cwc": measured.completely_well_centered,
            "is_acute": measured.acute,
        }
        cell_data: dict[str, NDArray[Any]] = {
            "min_h_over_R": measured.min_height,
            "max_face_angle": measured.max_face_angle,
            "max_dihedral_angle": measured.max_dihedral_angle,
            **{name: flag.astype(np.int8) for name, flag in flags.items()},
            "min_dual_length": duals.shortest_lengths(mesh, dual.lengths),
        }
        marked = replace(
            mesh,
            cell_data={**mesh.cell_data, **cell_data},
            point_data={**mesh.point_data, "dual_volume": dual.volumes},
        )
        return marked, {name.removeprefix("is_"): int(flag.sum()) for name, flag in flags.items()}
