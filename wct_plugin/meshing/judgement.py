"""What a new mesh has reached and what of the old one it has kept, measured on the meshes themselves."""

import warnings
from dataclasses import dataclass
from typing import NamedTuple

from wct_plugin.errors import WctWarning
from wct_plugin.measure.conserved import measure_groups, measure_sharp
from wct_plugin.measure.fidelity import measure_fidelity, region_names
from wct_plugin.measure.goals import Dual
from wct_plugin.measure.losses import find_losses
from wct_plugin.measure.pinned import measure_pinned
from wct_plugin.measure.quality import Quality
from wct_plugin.measure.region_topology import measure_region_topology
from wct_plugin.measure.shape_floor import measure_shape_floor
from wct_plugin.mesh import TetMesh, unit_scaling
from wct_plugin.mesh.periodic import find_periodic
from wct_plugin.mesh.strata import find_strata
from wct_plugin.meshing import curved
from wct_plugin.meshing.boundary_choice import Boundary, PatchChoices
from wct_plugin.meshing.followed_surface import enclosed_volumes, outer, stretch
from wct_plugin.meshing.reference import Reference
from wct_plugin.meshing.released_creases import measure_none
from wct_plugin.obstructions import Goal
from wct_plugin.obstructions.remaining_tets import list_remaining
from wct_plugin.types import Metrics


class Found(NamedTuple):
    """What the work on a mesh led to, in the unit it was done in."""

    mesh: TetMesh
    measured: Quality
    tolerance: float
    work: Metrics
    on: Reference  #: the surface that was followed


@dataclass(frozen=True)
class Asked:
    """What a new mesh is judged by."""

    goal: Goal | Dual
    boundary: Boundary
    crease_angle: float
    allow_released: bool
    pairs: bool  #: sides that are translates of each other are to stay so
    curved: bool  #: cells with mid nodes stand for what is curved, as no reference was named


def judge(
    old: TetMesh, own: Reference, new: TetMesh, found: Found, followed: Reference, tolerance: float, asked: Asked
) -> Metrics:
    """Measure what was reached and what is left.

    Parameters
    ----------
    old, new : TetMesh
        In the user's unit; ``new`` may be ``old``.
    own : Reference
        The old mesh's own surface.
    found : Found
        What led to the new mesh.
    followed : Reference
        The surface ``found.on``, in the user's unit.
    tolerance : float
        A length, in the user's unit.
    asked : Asked
        The options that count.

    Warns
    -----
    WctWarning
        For each thing that was not kept.
    """
    allowed = tolerance / (new.reference or old).diagonal
    other = found.on.strata is not own.strata  # than the mesh's own
    surface = outer(followed) if other else new.reference
    kept = measure_fidelity(old, new, surface, enclosed_volumes(followed) if other else None)
    groups = measure_groups(old, new, stretch(old, own, found.on) if other else {})
    if asked.curved and old.second_order and old.second_order.curved:
        domain = curved.CurvedDomain(old, new)
        kept, groups = domain.fidelity(kept), domain.groups(groups)
    boundaries = [(old.points, old.topology.boundary)]
    if other and surface is not None:
        boundaries.append((surface.points, surface.triangles))
    sides = _sides(old, new)
    sharp = measure_sharp(boundaries, (new.points, new.topology.boundary), asked.crease_angle)
    before = measure_region_topology(old)
    after = before if new is old else measure_region_topology(new)
    losses = find_losses(
        kept,
        groups,
        sharp,
        (before, after),
        found.work.get("released") or measure_none(own),
        sides if asked.pairs else None,
        allowed=allowed,
        allow_released=asked.allow_released,
        names=region_names(old),
    )
    for loss in losses:
        warnings.warn(loss["text"], WctWarning, stacklevel=3)
    strata = find_strata(new, asked.crease_angle)
    choices = PatchChoices(asked.boundary, new, strata)
    left = list_remaining(
        new,
        strata,
        found.measured,
        goal=asked.goal,
        boundary=choices.word,
        fixed=choices.fixed[strata.patch],
        crease_angle=asked.crease_angle,
        stopped=found.work["stopped"],
        needed=found.work.get("needed"),
    )
    shape = measure_shape_floor(new, found.measured, old, own.strata, tolerance)
    said: Metrics = {"groups": groups, "sharp_edges": sharp, "periodic": sides, "losses": losses}
    said["pinned"] = measure_pinned(old)
    return {"bad": left["count"], "tets": len(new.tets), **kept, **said, "shape": shape, "remaining": left}


def _sides(old: TetMesh, new: TetMesh) -> dict[str, int] | None:
    """How many pairs of sides are translates of each other, other than by nothing; None where none was."""
    unit = unit_scaling.exponent(old.points)

    def count(mesh: TetMesh) -> int:
        return sum(bool(pair.translation.any()) for pair in find_periodic(unit_scaling.scaled(mesh, -unit)))

    before = count(old)
    return {"before": before, "after": before if new is old else count(new)} if before else None
