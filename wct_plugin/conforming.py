"""A mesh made Delaunay or one-sided with the vertices of its surface where they are."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from wct_plugin import _core, starts
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.reference import Reference
from wct_plugin.transfer import Resampled


@dataclass(frozen=True, eq=False)
class Conformed:
    """What was found; ``mesh`` is None where it does not represent the domain."""

    mesh: Resampled | None
    rounds: int
    stopped: bool


def conform(
    mesh: TetMesh,
    own: Reference,
    given: SurfaceMesh | None,
    tolerance: float,
    *,
    fixed: bool,
    one_sided: bool,
    effort: int,
    seed: int,
    progress: Callable[[float, int], Any],
) -> Conformed:
    """Facets stay within ``tolerance``, a length, of the ``own`` surface or of the ``given`` one it stands for."""
    found = _core.conform(
        **starts.from_mesh(mesh, own, pinned=False),
        sides=own.sides,
        tolerance=tolerance,
        given_points=None if given is None else given.points,
        given_triangles=None if given is None else given.triangles,
        one_sided=one_sided,
        effort=effort,
        seed=seed,
        progress=progress,
    )
    if not found["intact"]:
        return Conformed(None, found["rounds"], found["stopped"])
    used, place = np.unique(found["tets"], return_inverse=True)
    new = np.full(len(found["points"]), -1)
    new[used] = np.arange(len(used))
    return Conformed(
        Resampled(
            found["points"][used],
            place.reshape(-1, 4),
            own.regions[found["regions"]],
            new[found["facets"]],
            own.carried[found["facet_patch"]],
            new[found["creases"]],
            found["crease_curve"],
        ),
        found["rounds"],
        found["stopped"],
    )
