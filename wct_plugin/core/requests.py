"""What the compiled functions are asked for: options, and what of a mesh is to stay."""

from dataclasses import dataclass, field

import numpy as np

from wct_plugin.types import Floats, Ints


def _no_points() -> Floats:
    return np.empty((0, 3))


def _no_numbers() -> Floats:
    return np.empty(0)


@dataclass(frozen=True, eq=False)
class ResampleOptions:
    """How :func:`wct_plugin.core._core.resample` makes tets."""

    tolerance: float  #: greatest distance between mesh and surface, a length
    local_tolerance: Floats | None = None  #: (n,) the same per surface point, where it is less in places
    size: Floats | None = None  #: wanted edge length per point of the mesh (none: the mesh's own there)
    surface_size: Floats | None = None  #: (n,) per surface point, the longest edges wanted there
    finer_at: Floats = field(default_factory=_no_points)  #: (k, 3) places round which
    finer_size: Floats = field(default_factory=_no_numbers)  #: (k,) edges are no longer than this
    cosines: bool = True  #: triangles are to be acute, too
    one_row: bool = True
    """Of tets through layers at interfaces where edges are long; else three, and no tet where there is no such layer"""
    gap: float = 1.0  #: how long edges beside a gap outside may be, in widths of the gap
    seed: int = 1


@dataclass(frozen=True, eq=False)
class KeptPoints:
    """The points of a mesh, which stay but for those near some places."""

    points: Floats  #: (k, 3)
    stratum: Ints  #: (k,) as of a stratified mesh
    label: Ints  #: (k,) patch, curve or surface point; inside, the region
    at: Floats  #: (z, 3) the places
    radius: Floats  #: (z,) and how far from each points are new


@dataclass(frozen=True, eq=False)
class HeldFacets:
    """Facets of some patches, all they have, and edges of some curves, that are to be in the mesh."""

    points: Floats  #: (h, 3)
    stratum: Ints  #: (h,) 1 patch, 2 crease, 3 corner
    label: Ints  #: (h,) patch, curve or surface point
    facets: Ints  #: (g, 3) running as the surface's triangles do
    patch: Ints  #: (g,)
    edges: Ints  #: (e, 2)
    curves: Ints  #: (c,) those the edges are of


@dataclass(frozen=True, eq=False)
class SearchOptions:
    """How :func:`wct_plugin.core._core.search_well_centered` works, and what it may change."""

    tolerance: float  #: greatest distance between facets and surface, a length
    acute: bool = True  #: triangles are to be acute, too
    margin: float = 0.02  #: clearance wanted in h/R and in the cosines
    flip_surface: bool = True  #: surface facets may be flipped
    split_surface: bool = True  #: crease edges and surface edges may be split and collapsed
    passes: int = 12  #: most sweeps
    kicks: int = 4000  #: most tries
    seed: int = 0
    local_tolerance: Floats | None = None  #: (n,) the tolerance per surface point, where it is less in places
    crease_angle: float = 180.0
    """In degrees: no edge within a curved patch comes to bend more, if none beside it did before"""
    ruled_out: Ints | None = None
    """(r,) rows of facets on which no tet can meet the goal as long as they stay"""
    fixed: Ints | None = None  #: patches whose facets stay, and whose points all stay
    fixed_curves: Ints | None = None  #: curves whose edges are not split
    loose: Ints | None = None
    """(l,) curves that are creases by their angle alone, and may become ordinary surface"""
    volumes: Floats | None = None  #: (regions,) what they are to have in the end
    worth: float = np.inf  #: evaluations per tet that getting rid of all bad tets is worth
    most_tets: int | None = None  #: what the mesh may grow to
    most_work: int | None = None  #: as of :class:`wct_plugin.core.results.SearchResult`, after which kicks end


@dataclass(frozen=True, eq=False)
class ConformOptions:
    """How a mesh is made Delaunay, or one-sided."""

    one_sided: bool = True
    effort: int = 1  #: multiplies the rounds
    seed: int = 1
    stays: Ints | None = None  #: patches whose vertices stay where they are; others may move a little in their plane
