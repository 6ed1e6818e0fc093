"""What the local search starts from: the mesh itself, its inside filled anew, or what another search led to."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np
from numpy.typing import NDArray

from wct_plugin.core import _core
from wct_plugin.mesh import TetMesh
from wct_plugin.meshing.reference import Reference
from wct_plugin.types import Bools, Floats, Ints

if TYPE_CHECKING:  # the stubs' names are not in the module
    from wct_plugin.core._core import RefilledArrays, SearchedArrays


class SearchMesh(TypedDict):
    """The arguments of :func:`wct_plugin.core._core.search_well_centered` that make up a mesh."""

    points: Floats
    tets: Ints
    regions: Ints
    stratum: NDArray[np.int8]
    label: Ints
    size: Floats
    facets: Ints
    facet_patch: Ints
    creases: Ints
    crease_curve: Ints


def from_mesh(mesh: TetMesh, own: Reference, *, pinned: Bools | bool) -> SearchMesh:
    """The mesh itself; ``pinned`` (n,): which of its surface vertices stay where they are, or whether all do."""
    edges = mesh.topology.edges
    length = np.linalg.norm(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]], axis=1)
    ends = edges.ravel()
    stratum = own.strata.stratum
    stays = (stratum > 0) & pinned
    return {
        "points": mesh.points,
        "tets": mesh.tets,
        "regions": np.searchsorted(own.regions, mesh.regions),
        "stratum": np.where(stays, 3, stratum).astype(np.int8),
        "label": np.where(stays, -1, own.strata.label),
        "size": np.bincount(ends, np.repeat(length, 2)) / np.bincount(ends),
        "facets": own.strata.triangles,
        "facet_patch": own.strata.patch,
        "creases": own.strata.segments,
        "crease_curve": own.strata.curve,
    }


def from_search(found: "SearchedArrays") -> SearchMesh:
    """The mesh that a search led to, as the start of another."""
    return {
        "points": found["points"],
        "tets": found["tets"],
        "regions": found["regions"],
        "stratum": found["stratum"],
        "label": found["label"],
        "size": found["size"],
        "facets": found["facets"],
        "facet_patch": found["facet_patch"],
        "creases": found["creases"],
        "crease_curve": found["crease_curve"],
    }


def refill(
    start: SearchMesh,
    sides: Ints,
    size: Floats | None,
    *,
    acute: bool,
    seed: int,
    progress: Callable[[float, int], Any],
) -> SearchMesh | None:
    """The inside of a pinned start filled anew between its surface facets, or None where these leave no choice.

    ``sides`` as of :class:`Reference`, the others as of :func:`wct_plugin.core._core.refill`.
    """
    found = _core.refill(
        *_between_facets(start, sides),
        size=size,
        cosines=acute,
        seed=seed,
        progress=progress,
    )
    return _filled(start, found)


def conform_inside(
    start: SearchMesh, sides: Ints, *, one_sided: bool, effort: int, seed: int, progress: Callable[[float, int], Any]
) -> SearchMesh | None:
    """A pinned start made Delaunay or one-sided between its surface facets, or None where these leave no choice.

    Arguments as of :func:`refill` and :func:`wct_plugin.core._core.conform_inside`.
    """
    found = _core.conform_inside(
        *_between_facets(start, sides),
        start["size"],
        one_sided=one_sided,
        effort=effort,
        seed=seed,
        progress=progress,
    )
    return _filled(start, found)


def _between_facets(start: SearchMesh, sides: Ints) -> tuple[Floats, Ints, Ints, Ints, Ints, Ints, Ints, Ints]:
    """What the core wants to know of a pinned start."""
    return (
        start["points"],
        start["tets"],
        start["regions"],
        np.flatnonzero(start["stratum"] > 0),
        start["facets"],
        start["facet_patch"],
        sides,
        start["creases"],
    )


def _filled(start: SearchMesh, found: "RefilledArrays") -> SearchMesh | None:
    """The start whose inside is what was found; None where nothing was."""
    if not len(found["tets"]):
        return None
    pinned = np.flatnonzero(start["stratum"] > 0)
    origin = found["origin"]
    old = origin >= 0
    place = np.full(len(start["points"]), -1)
    place[origin[old]] = np.flatnonzero(old)
    stratum = np.zeros(len(origin), dtype=np.int8)
    stratum[place[pinned]] = 3
    return {
        **start,
        "points": found["points"],
        "tets": found["tets"],
        "regions": found["regions"],
        "size": found["size"],
        "stratum": stratum,
        "label": np.where(stratum > 0, start["label"][origin], -1),
        "facets": place[start["facets"]],
        "creases": place[start["creases"]],
    }
