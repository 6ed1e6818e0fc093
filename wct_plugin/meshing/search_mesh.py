"""What the local search starts from: the mesh itself, or its inside filled anew."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from wct_plugin.core import _core
from wct_plugin.core.domain import StratifiedMesh
from wct_plugin.core.requests import ConformOptions
from wct_plugin.core.results import RefillResult
from wct_plugin.mesh import TetMesh
from wct_plugin.meshing.reference import Reference
from wct_plugin.types import Bools, Floats, Ints


def from_mesh(mesh: TetMesh, own: Reference, *, pinned: Bools | bool, size: Floats | None = None) -> StratifiedMesh:
    """The mesh itself.

    ``pinned`` (n,): which of its surface vertices stay where they are, or whether all do. ``size`` (n,): edge lengths
    wanted, else the mesh's own.
    """
    edges = mesh.topology.edges
    length = np.linalg.norm(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]], axis=1)
    ends = edges.ravel()
    stratum = own.strata.stratum
    stays = (stratum > 0) & pinned
    if size is None:
        size = np.bincount(ends, np.repeat(length, 2)) / np.bincount(ends)
    return StratifiedMesh(
        points=mesh.points,
        tets=mesh.tets,
        regions=np.searchsorted(own.regions, mesh.regions),
        stratum=np.where(stays, 3, stratum).astype(np.int8),
        label=np.where(stays, -1, own.strata.label),
        size=size,
        facets=own.strata.triangles,
        facet_patch=own.strata.patch,
        creases=own.strata.segments,
        crease_curve=own.strata.curve,
    )


def refill(
    start: StratifiedMesh,
    sides: Ints,
    size: Floats | None,
    *,
    acute: bool,
    seed: int,
    progress: Callable[[float, int], Any],
    expected: Callable[[float], Any],
) -> StratifiedMesh | None:
    """The inside of a pinned start filled anew between its surface facets, or None where these leave no choice.

    ``sides`` as of :class:`Reference`, the others as of :func:`wct_plugin.core._core.refill`.
    """
    found = _core.refill(start, sides, size=size, cosines=acute, seed=seed, progress=progress, expected=expected)
    return _filled(start, found)


def conform_inside(
    start: StratifiedMesh, sides: Ints, options: ConformOptions, progress: Callable[[float, int], Any]
) -> StratifiedMesh | None:
    """A pinned start made Delaunay or one-sided between its surface facets, or None where these leave no choice."""
    return _filled(start, _core.conform_inside(start, sides, options, progress))


def _filled(start: StratifiedMesh, found: RefillResult) -> StratifiedMesh | None:
    """The start whose inside is what was found; None where nothing was."""
    if not len(found.tets):
        return None
    pinned = np.flatnonzero(start.stratum > 0)
    old = found.origin >= 0
    place = np.full(len(start.points), -1)
    place[found.origin[old]] = np.flatnonzero(old)
    stratum = np.zeros(len(found.origin), dtype=np.int8)
    stratum[place[pinned]] = 3
    return replace(
        start,
        points=found.points,
        tets=found.tets,
        regions=found.regions,
        size=found.size,
        stratum=stratum,
        label=np.where(stratum > 0, start.label[found.origin], -1),
        facets=place[start.facets],
        creases=place[start.creases],
    )
