"""The figures of one mesh against the mesh it was made from, and of the tool that made it."""

import math
from typing import Any

from benchmarks.run import Outcome
from wct_plugin.errors import WctError
from wct_plugin.measure import quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import SurfaceMesh, TetMesh

_MB = 2.0**20


def row_of(name: str, tool: str, outcome: Outcome, mesh: TetMesh, surface: SurfaceMesh) -> dict[str, Any]:
    """How a tool did on ``mesh``, called ``name``; what it used is in seconds and MB, per tet in ms and kB."""
    row = {"mesh": name, "tool": tool, "status": outcome.status, "load": outcome.load, "cpu_with_start": outcome.cpu}
    if outcome.status != "ok":
        return row
    arrays = outcome.arrays
    row |= {"cpu": float(arrays["cpu"]), "wall": float(arrays["wall"])}
    row |= {key: float(arrays[key]) / _MB for key in ("memory", "memory_above")}
    try:
        row |= judge(TetMesh(arrays["points"], arrays["tets"]), mesh, surface)
    except WctError as error:
        return row | {"status": f"unusable: {error}"}
    per_tet = {"ms_per_tet": 1e3 * row["cpu"], "kb_per_tet": float(arrays["memory_above"]) / 1e3}
    return row | {key: value / row["tets"] for key, value in per_tet.items()}


def judge(mesh: TetMesh, given: TetMesh, surface: SurfaceMesh) -> dict[str, Any]:
    """Quality of ``mesh``, its boundary's distance from ``surface`` and its volume beside ``given``'s.

    Raises :class:`wct_plugin.errors.InputError` where the mesh is not one: facets shared by three tets.
    """
    measured = quality.measure(mesh)
    boundary = mesh.boundary_surface()
    volume = float(measured.volume.sum())
    before = float(quality.measure(given).volume.sum())
    turned = mesh.repairs.flipped
    return {
        "tets": len(mesh.tets),
        "points": len(mesh.points),
        "3wc": 100.0 * float(measured.well_centered_3.mean()),
        "2wc": 100.0 * float(measured.well_centered_2.mean()),
        "cwc": 100.0 * float(measured.completely_well_centered.mean()),
        "min_height": float(measured.min_height.min()),
        "min_dihedral": float(measured.min_dihedral_angle.min()),
        "max_dihedral": float(measured.max_dihedral_angle.max()),
        "radius_over_edge": float(measured.radius_over_edge.max()),
        "deviation": measure_deviation(boundary, surface).max / surface.diagonal,
        "volume_change": volume / before - 1.0,
        # All of one orientation is a convention; a mixture is inverted tets.
        "inverted": min(turned, len(mesh.tets) - turned),
        "encloses": math.isclose(_enclosed(boundary), volume, rel_tol=1e-9),
    }


def _enclosed(surface: SurfaceMesh) -> float:
    """Volume inside an outward surface, from a point near it so that little cancels."""
    a, b, c = (surface.points[surface.triangles[:, k]] - surface.points.mean(axis=0) for k in range(3))
    normals = [b[:, (k + 1) % 3] * c[:, (k + 2) % 3] - b[:, (k + 2) % 3] * c[:, (k + 1) % 3] for k in range(3)]
    return float(sum((a[:, k] * normals[k]).sum() for k in range(3))) / 6.0
