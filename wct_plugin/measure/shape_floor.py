"""Tets below the usual floor of shape, a dihedral angle of 10 degrees and R/l of 3, and whether the domain forces them.

Where a crease of the domain opens by an angle a, some tet there has a dihedral angle of at most a. Where a patch has an
angle b at a corner, some facet there has an angle of at most b, so its tet's circumradius is at least
edge / (2 sin b) for an edge of that tet: R/l >= 1 / (2 sin b).
"""

from typing import TypedDict

import numpy as np

from wct_plugin.measure.opening_angles import corner_angles, wedge_angles
from wct_plugin.measure.quality import Quality, dihedral_angles
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import Strata
from wct_plugin.mesh.topology import EDGES
from wct_plugin.types import Ints

MIN_DIHEDRAL = 10.0
MAX_RADIUS_OVER_EDGE = 3.0


class ShapeFloor(TypedDict):
    """How far a mesh keeps the floor of shape."""

    min_dihedral_angle: float  #: in degrees
    max_radius_over_edge: float
    dihedral_below_floor: int  #: tets
    dihedral_forced: int  #: of these, at a crease of the domain that opens no wider than the floor
    radius_above_floor: int  #: tets
    radius_forced: int  #: of these, at a corner of the domain with a patch too narrow for the floor


def measure_shape_floor(mesh: TetMesh, measured: Quality, domain: TetMesh, of: Strata, tolerance: float) -> ShapeFloor:
    """The worst shapes of a mesh, and how many the creases and corners of ``domain`` (in strata ``of``) account for.

    ``tolerance``, a length: how far creases and corners of the mesh may be from those of the domain.
    """
    flat = np.flatnonzero(measured.min_dihedral_angle < MIN_DIHEDRAL)
    wide = np.flatnonzero(measured.radius_over_edge > MAX_RADIUS_OVER_EDGE)
    return {
        "min_dihedral_angle": float(measured.min_dihedral_angle.min()),
        "max_radius_over_edge": float(measured.radius_over_edge.max()),
        "dihedral_below_floor": len(flat),
        "dihedral_forced": _at_sharp_creases(mesh, flat, domain, of, tolerance) if len(flat) else 0,
        "radius_above_floor": len(wide),
        "radius_forced": _at_narrow_corners(mesh, wide, domain, of, tolerance) if len(wide) else 0,
    }


def describe(floor: ShapeFloor) -> str:
    """One line for the report, empty where the floor is kept."""
    parts = []
    if floor["dihedral_below_floor"]:
        parts.append(
            f"{floor['dihedral_below_floor']} tets with a dihedral angle below {MIN_DIHEDRAL:g}°, "
            f"{floor['dihedral_forced']} of them at creases that open no wider"
        )
    if floor["radius_above_floor"]:
        parts.append(
            f"{floor['radius_above_floor']} tets with R/ℓ above {MAX_RADIUS_OVER_EDGE:g}, "
            f"{floor['radius_forced']} of them at corners too narrow for less"
        )
    return "; ".join(parts)


def _at_sharp_creases(mesh: TetMesh, tets: Ints, domain: TetMesh, of: Strata, tolerance: float) -> int:
    """How many of ``tets`` have their flat dihedral angle at an edge on a crease where the domain opens no wider."""
    count = len(domain.points)
    segments = set((of.segments @ [count, 1]).tolist())
    near = np.flatnonzero((of.stratum[domain.tets] >= 2).sum(axis=1) >= 2)
    ends = np.sort(domain.tets[near][:, EDGES], axis=2)
    sharp = np.isin(ends @ [count, 1], list(segments)) & (wedge_angles(domain, near) < MIN_DIHEDRAL)
    creases = np.unique(ends[sharp], axis=0)
    if not len(creases):
        return 0
    low = (dihedral_angles(mesh.points, mesh.tets[tets]) < MIN_DIHEDRAL) & (wedge_angles(mesh, tets) < MIN_DIHEDRAL)
    row, edge = np.nonzero(low)
    middle = mesh.points[mesh.tets[tets[row]][np.arange(len(row))[:, None], EDGES[edge]]].mean(axis=1)
    start, step = domain.points[creases[:, 0]], domain.points[creases[:, 1]] - domain.points[creases[:, 0]]
    along = np.einsum("qsj,sj->qs", middle[:, None] - start, step) / (step**2).sum(axis=1)
    foot = start + np.clip(along, 0.0, 1.0)[..., None] * step
    on = np.linalg.norm(foot - middle[:, None], axis=2).min(axis=1) <= tolerance
    return len(np.unique(row[on]))


def _at_narrow_corners(mesh: TetMesh, tets: Ints, domain: TetMesh, of: Strata, tolerance: float) -> int:
    """How many of ``tets`` touch a corner of the domain where a patch is too narrow for the floor."""
    corners, angle = corner_angles(domain.points, of)
    narrow = domain.points[corners[np.sin(np.radians(np.minimum(angle, 90.0))) < 1.0 / (2.0 * MAX_RADIUS_OVER_EDGE)]]
    if not len(narrow):
        return 0
    apart = np.linalg.norm(mesh.points[mesh.tets[tets]][:, :, None] - narrow, axis=3)
    return int((apart.min(axis=(1, 2)) <= tolerance).sum())
