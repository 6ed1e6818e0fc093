"""The goals delaunay and one-sided: a mesh made so with the vertices of its surface where they are, or nearly so."""

from collections.abc import Callable
from typing import Any

from wct_plugin.core import _core
from wct_plugin.core.domain import StratifiedMesh
from wct_plugin.core.requests import ConformOptions
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.meshing import search_mesh
from wct_plugin.meshing.reference import Reference


def conform(
    mesh: TetMesh,
    own: Reference,
    given: SurfaceMesh | None,
    tolerance: float,
    options: ConformOptions,
    progress: Callable[[float, int], Any],
) -> StratifiedMesh | None:
    """With facets within ``tolerance``, a length, of the ``own`` surface or of the ``given`` one it stands for.

    None where no mesh was found that represents the domain.
    """
    start = search_mesh.from_mesh(mesh, own, pinned=False)
    found = _core.conform(start, own.sides, tolerance, options, given=given, progress=progress)
    return found.mesh if found.intact else None


def conform_inside(
    mesh: TetMesh, own: Reference, options: ConformOptions, progress: Callable[[float, int], Any]
) -> StratifiedMesh | None:
    """With the facets of the ``own`` surface as they are; None where they leave no choice."""
    return search_mesh.conform_inside(search_mesh.from_mesh(mesh, own, pinned=True), own.sides, options, progress)
