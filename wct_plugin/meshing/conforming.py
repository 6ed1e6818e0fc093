"""The goals delaunay and one-sided: a mesh made so with the vertices of its surface where they are."""

from collections.abc import Callable
from typing import Any

from wct_plugin.core import _core
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.meshing import search_mesh
from wct_plugin.meshing.reference import Reference
from wct_plugin.meshing.transfer import Resampled, resampled


def conform(
    mesh: TetMesh,
    own: Reference,
    given: SurfaceMesh | None,
    tolerance: float,
    *,
    one_sided: bool,
    effort: int,
    seed: int,
    progress: Callable[[float, int], Any],
) -> Resampled | None:
    """With facets within ``tolerance``, a length, of the ``own`` surface or of the ``given`` one it stands for.

    None where no mesh was found that represents the domain.
    """
    found = _core.conform(
        **search_mesh.from_mesh(mesh, own, pinned=False),
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
        return None
    return resampled(found, own)


def conform_inside(
    mesh: TetMesh, own: Reference, *, one_sided: bool, effort: int, seed: int, progress: Callable[[float, int], Any]
) -> Resampled | None:
    """With the facets of the ``own`` surface as they are; None where they leave no choice."""
    start = search_mesh.conform_inside(
        search_mesh.from_mesh(mesh, own, pinned=True),
        own.sides,
        one_sided=one_sided,
        effort=effort,
        seed=seed,
        progress=progress,
    )
    return None if start is None else resampled(start, own)
