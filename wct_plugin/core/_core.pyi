"""Compiled core of wct_plugin: arrays in, arrays out.

Arrays are C-contiguous, float64 for coordinates and int64 for indices unless stated; a wrong type, shape or index
raises ValueError. Inputs are never changed. The interpreter is free to run other threads meanwhile.

``threads`` is how many a function works with at most; 0 means OMP_NUM_THREADS, or one per core where that is not set.
The results are the same bits whatever it is.
"""

from collections.abc import Callable
from typing import Any, Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

class MoveReport(TypedDict):
    """What :func:`move_vertices` did."""

    iterations: int
    """Steps of all points together, or sweeps over them."""
    evaluations: int
    """Tets measured."""
    bad_before: int
    bad_after: int
    """Tets that miss the goal; exact."""
    worst_before: float
    worst_after: float
    """Smallest h/R, for goal cwc smallest of h/R and the cosines of the facet angles."""
    stopped: bool
    """Whether the listener ended the work."""

def tet_energy(
    points: NDArray[np.float64],
    tets: NDArray[np.int64],
    *,
    margin3: float,
    power3: float,
    margin2: float,
    power2: float,
    weight2: float,
    weight_quality: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How far each tet is from being well-centered, and which way is better.

    ::

        E = sum over 4 facets         max(0, margin3 - h/R)^power3
          + weight2 * sum over 12 angles  max(0, margin2 - cos)^power2
          + weight_quality * sum over 4 facets  (h/R - 1/3)^2

    with h the signed height of the circumcenter over the facet, R the circumradius and cos the cosines of the facet
    angles. Powers are at least 1; multiples of one half up to 3 are quickest.

    ``points`` (n, 3), ``tets`` (m, 4). Returns the energies (m,) and the gradient (n, 3) of their sum. A tet that is
    inverted or flat, det <= 1e-5 longest_edge^3, has infinite energy and no part in the gradient.
    """

def star_energy(
    points: NDArray[np.float64],
    tets: NDArray[np.int64],
    point: int,
    *,
    margin3: float,
    power3: float,
    margin2: float,
    power2: float,
    weight2: float,
    weight_quality: float,
) -> tuple[float, NDArray[np.float64]]:
    """The energy of :func:`tet_energy` summed over the tets around one point, and its gradient (3,) in that point.

    Here a tet may be as flat as it is; it is infinite where one is inverted.
    """

def orientation(points: NDArray[np.float64], tets: NDArray[np.int64]) -> NDArray[np.int8]:
    """Exact sign of det(x1-x0, x2-x0, x3-x0) per tet: 1, -1, or 0 for four coplanar points.

    ``points`` (n, 3) finite, ``tets`` (m, 4); returns (m,).
    """

def move_vertices(
    points: NDArray[np.float64],
    tets: NDArray[np.int64],
    stratum: NDArray[np.int8],
    label: NDArray[np.int64],
    triangles: NDArray[np.int64],
    triangle_patch: NDArray[np.int64],
    segments: NDArray[np.int64],
    segment_curve: NDArray[np.int64],
    *,
    goal: Literal["3wc", "cwc"],
    margin: float,
    effort: int,
    tolerance: float = ...,
    progress: Callable[[float, int], Any] | None = None,
) -> tuple[NDArray[np.float64], MoveReport]:
    """Move vertices so that as many tets as possible contain their circumcenter ("3wc"), and have acute facets ("cwc").

    ``stratum`` (n,) says what each point may do: 0 interior, moves freely; 1 on a patch, moves on the triangles whose
    ``triangle_patch`` is its ``label``; 2 on a crease, moves on the segments whose ``segment_curve`` is its label;
    3 stays. ``triangles`` (t, 3) and ``segments`` (s, 2) index ``points`` and lie where the points are now. Flat
    patches and straight creases stay so to rounding. All tets must be positive.

    ``margin`` (0 to 1/3) is the clearance wanted in h/R, and in the cosines for cwc. ``effort`` (1 to 1000) multiplies
    the iterations. ``tolerance``, a length, is how far the moved surface may get from where it was, both ways.

    ``tolerance`` is a length, without limit by default: how far curved patches, as the moved points span them, may be
    from where they are now, patch by patch and both ways; and curved creases likewise. Planes and straight creases know
    none.

    ``progress(done, bad)`` hears the done fraction and the number of tets that miss the goal so far; if it returns
    something false other than None, the best positions so far are returned; if it raises, that propagates, as does
    KeyboardInterrupt.

    Whatever happens, no returned tet is inverted and no fewer contain their circumcenter than before, both exactly;
    points that may not move keep their bits; the same input gives the same bits.
    """

def delaunay(points: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Delaunay tetrahedralization of ``points`` (n, 3).

    Returns tets (m, 4), positively oriented, and neighbours (m, 4): the tet across the facet opposite each vertex, -1
    on the hull. Exact: no point lies inside a circumsphere and no tet is flat. Fewer than four points, and points that
    are not finite, coincide or all lie in one plane, raise ValueError.
    """

class SurfaceArrays(TypedDict):
    """A tet mesh and its surface in strata, as :func:`resample` and :func:`search_well_centered` give them."""

    points: NDArray[np.float64]
    """(n, 3)"""
    tets: NDArray[np.int64]
    """(m, 4), positively oriented"""
    stratum: NDArray[np.int8]
    """(n,): 0 interior, 1 patch, 2 crease, 3 corner"""
    label: NDArray[np.int64]
    """(n,): patch or curve id, -1 inside"""
    facets: NDArray[np.int64]
    """(k, 3) surface facets: the boundary and the interfaces"""
    facet_patch: NDArray[np.int64]
    """(k,)"""
    creases: NDArray[np.int64]
    """(c, 2)"""
    crease_curve: NDArray[np.int64]
    """(c,)"""

class ResampledArrays(SurfaceArrays):
    """What :func:`resample` gives."""

    region: NDArray[np.int64]
    """(m,) index of the region"""
    size: NDArray[np.float64]
    """(n,) edge length wanted at the point"""
    held: NDArray[np.int64]
    """(n,) the held point that it is, or -1"""
    exposed: NDArray[np.int64]
    pinched: NDArray[np.int64]
    """Points where the result is no manifold; both empty if all went well."""
    intact: bool
    """No such points but corners, no facet that cuts across from one planar patch to another, the Euler characteristic
    of every region as in the mesh, and all held facets."""
    lost: NDArray[np.int64]
    """Points where the domain is not represented, but for corners; -1 for one of no tet."""
    stats: dict[str, Any]

class SearchedArrays(SurfaceArrays):
    """What :func:`search_well_centered` gives."""

    regions: NDArray[np.int64]
    """(m,) index of the region"""
    size: NDArray[np.float64]
    """(n,) edge length wanted at the point"""
    bad: int
    """Tets that miss the goal, or are at a facet beyond the tolerance."""
    stuck: NDArray[np.int64]
    """(s,) which tets those are, but for those on a facet that is ruled out"""
    passes: int
    kicks: int
    accepted: int
    """Kicks that made it better."""
    evaluations: int
    """Tets measured."""
    stopped: bool
    """Whether the listener ended the work."""
    released: NDArray[np.int64]
    """(r,) curves that became ordinary surface; patches they divided have the smallest number of any of them"""

class RefilledArrays(TypedDict):
    """What :func:`refill` gives."""

    points: NDArray[np.float64]
    origin: NDArray[np.int64]
    """(n,) the input's point, -1 for a new one"""
    size: NDArray[np.float64]
    """(n,) edge length wanted"""
    tets: NDArray[np.int64]
    regions: NDArray[np.int64]
    stopped: bool

class ConformedArrays(SurfaceArrays):
    """What :func:`conform` gives."""

    origin: NDArray[np.int64]
    """(n,) the input's point, -1 for a new one"""
    regions: NDArray[np.int64]
    """(m,) index of the region"""
    rounds: int
    intact: bool
    """Creases, surfaces and the Euler characteristic of every region are as in the mesh."""
    faults: dict[str, int]
    """Places that are short of the goal, by kind."""
    stopped: bool

def local_tolerance(
    points: NDArray[np.float64],
    triangles: NDArray[np.int64],
    patch: NDArray[np.int64],
    segments: NDArray[np.int64],
    curve: NDArray[np.int64],
    sides: NDArray[np.int64],
    *,
    tolerance: float,
    floor: float,
    flat: float = 0.0,
    threads: int = 0,
) -> NDArray[np.float64]:
    """Per point, a tenth of the wall, gap or radius there, within ``floor``..``tolerance``; all are lengths."""

def resample(
    surface_points: NDArray[np.float64],
    triangles: NDArray[np.int64],
    patch: NDArray[np.int64],
    segments: NDArray[np.int64],
    curve: NDArray[np.int64],
    corners: NDArray[np.int64],
    sides: NDArray[np.int64],
    points: NDArray[np.float64],
    tets: NDArray[np.int64],
    region: NDArray[np.int64],
    tolerance: float,
    size: NDArray[np.float64] | None = None,
    folds: NDArray[np.int64] | None = None,
    finer_at: NDArray[np.float64] | None = None,
    finer_size: NDArray[np.float64] | None = None,
    kept_points: NDArray[np.float64] | None = None,
    kept_stratum: NDArray[np.int64] | None = None,
    kept_label: NDArray[np.int64] | None = None,
    anew_at: NDArray[np.float64] | None = None,
    anew_radius: NDArray[np.float64] | None = None,
    held_points: NDArray[np.float64] | None = None,
    held_stratum: NDArray[np.int64] | None = None,
    held_label: NDArray[np.int64] | None = None,
    held_facets: NDArray[np.int64] | None = None,
    held_patch: NDArray[np.int64] | None = None,
    held_edges: NDArray[np.int64] | None = None,
    held_curves: NDArray[np.int64] | None = None,
    cosines: bool = True,
    seed: int = 1,
    progress: Callable[[float, int], Any] | None = None,
    gap: float = 1.0,
    flat: float = 0.0,
    expected: Callable[[float], Any] | None = None,
    threads: int = 0,
    local_tolerance: NDArray[np.float64] | None = None,
    surface_size: NDArray[np.float64] | None = None,
) -> ResampledArrays:
    """Resample a domain with tets that are nearly all well-centered.

    The surface: ``surface_points`` (p, 3), ``triangles`` (t, 3), ``patch`` (t,), crease ``segments`` (s, 2) with their
    ``curve`` (s,), ``corners`` (c,), ``sides`` (patches, 2): the region behind a patch's triangles and the one before,
    -1 outside. The mesh that says what is inside: ``points`` (n, 3), ``tets`` (m, 4), ``region`` (m,) from 0.
    ``tolerance``: greatest distance between mesh and surface, a length. ``size`` (n,): wanted edge length per mesh
    point, else the mesh's own local one. ``surface_size`` (p,): the longest edges wanted on the surface. ``folds``
    (f, 2): edges that bend as creases do and are none. ``finer_at`` (k, 3), ``finer_size`` (k,): edges are no longer
    than this round these places. ``kept_points`` (k, 3), ``kept_stratum``, ``kept_label`` (k,): the points of a mesh,
    with the patch, curve, surface point or, inside, region of each; they stay, but for those within ``anew_radius``
    (z,) of ``anew_at`` (z, 3), and what is beside moves. ``held_points`` (h, 3), ``held_stratum``, ``held_label`` (h,)
    in the same way, ``held_facets`` (g, 3) between them, running as the surface's triangles do, and ``held_patch``
    (g,): the facets of some patches, all of them, that are to be in the mesh; ``held_edges`` (e, 2) in the same way of
    ``held_curves`` (c,).
    ``progress(done, bad)`` as in :func:`move_vertices`. ``gap``: how long edges beside a gap outside may be, in widths
    of the gap. ``flat``, a length: as far off a plane or line vertices may be that count as on it, if that is more than
    1e-9 of its extent. ``expected(tets)`` hears about how many tets there will be, before any is made, but for a mesh
    made anew in places; it returns False to give up, without a tet.

    The label of a corner is its surface point. The same input and seed give the same bits.
    """

def refill(
    points: NDArray[np.float64],
    tets: NDArray[np.int64],
    region: NDArray[np.int64],
    pinned: NDArray[np.int64],
    facets: NDArray[np.int64],
    facet_patch: NDArray[np.int64],
    sides: NDArray[np.int64],
    edges: NDArray[np.int64],
    *,
    size: NDArray[np.float64] | None = None,
    cosines: bool = True,
    seed: int = 1,
    progress: Callable[[float, int], Any] | None = None,
    threads: int = 0,
) -> RefilledArrays:
    """Fill a mesh anew between its surface facets, which stay.

    ``points`` (n, 3), ``tets`` (m, 4), ``region`` (m,) from 0; indices of ``pinned`` points; ``facets`` (f, 3) with
    their ``facet_patch`` (f,), ``sides`` (patches, 2) as in :func:`resample`; ``edges`` (e, 2) that stay.
    ``size`` (n,): wanted edge length per point; without it the new mesh has up to twice the tets.
    There are no tets where the facets leave no choice, or where it was stopped early.
    """

def conform_inside(
    points: NDArray[np.float64],
    tets: NDArray[np.int64],
    region: NDArray[np.int64],
    pinned: NDArray[np.int64],
    facets: NDArray[np.int64],
    facet_patch: NDArray[np.int64],
    sides: NDArray[np.int64],
    edges: NDArray[np.int64],
    size: NDArray[np.float64],
    *,
    one_sided: bool = True,
    effort: int = 1,
    seed: int = 1,
    progress: Callable[[float, int], Any] | None = None,
) -> RefilledArrays:
    """Make a mesh Delaunay, and one-sided, between its surface facets, which stay.

    Arguments and result as of :func:`refill`; ``size`` (n,): edge length per point. ``effort`` multiplies the rounds.
    """

def conform(
    points: NDArray[np.float64],
    tets: NDArray[np.int64],
    regions: NDArray[np.int64],
    stratum: NDArray[np.int8],
    label: NDArray[np.int64],
    size: NDArray[np.float64],
    facets: NDArray[np.int64],
    facet_patch: NDArray[np.int64],
    sides: NDArray[np.int64],
    creases: NDArray[np.int64],
    crease_curve: NDArray[np.int64],
    tolerance: float,
    *,
    given_points: NDArray[np.float64] | None = None,
    given_triangles: NDArray[np.int64] | None = None,
    one_sided: bool = True,
    effort: int = 1,
    seed: int = 1,
    progress: Callable[[float, int], Any] | None = None,
    threads: int = 0,
) -> ConformedArrays:
    """Make a mesh Delaunay, and one-sided, with its surface vertices where they are.

    ``points`` (n, 3), ``tets`` (m, 4), ``regions`` (m,) from 0, per point ``stratum``, ``label`` and ``size``;
    ``facets`` (f, 3) of the surface with their ``facet_patch`` (f,), ``sides`` (patches, 2) as in :func:`resample`,
    ``creases`` (c, 2) with their ``crease_curve`` (c,). ``tolerance``: greatest distance of the new surface from the
    facets, or from the given triangles where there are some, a length. ``effort`` multiplies the rounds.
    """

def search_well_centered(
    points: NDArray[np.float64],
    tets: NDArray[np.int64],
    regions: NDArray[np.int64],
    stratum: NDArray[np.int8],
    label: NDArray[np.int64],
    size: NDArray[np.float64],
    facets: NDArray[np.int64],
    facet_patch: NDArray[np.int64],
    creases: NDArray[np.int64],
    crease_curve: NDArray[np.int64],
    surface_points: NDArray[np.float64],
    surface_triangles: NDArray[np.int64],
    surface_patch: NDArray[np.int64],
    surface_segments: NDArray[np.int64],
    surface_curve: NDArray[np.int64],
    *,
    tolerance: float,
    acute: bool,
    margin: float,
    flip_surface: bool,
    split_surface: bool,
    passes: int,
    kicks: int,
    seed: int,
    progress: Callable[[str, float, int], Any] | None = None,
    ruled_out: NDArray[np.int64] | None = None,
    fixed: NDArray[np.int64] | None = None,
    fixed_curves: NDArray[np.int64] | None = None,
    loose: NDArray[np.int64] | None = None,
    worth: float = ...,
    flat: float = 0.0,
    volumes: NDArray[np.float64] | None = None,
    most_tets: int | None = None,
    local_tolerance: NDArray[np.float64] | None = None,
    most_evaluations: int | None = None,
    crease_angle: float = 180.0,
) -> SearchedArrays:
    """Reconnect and move by local search until all tets contain their circumcenter, and are ``acute`` in their facets.

    The mesh: ``points`` (n, 3), ``tets`` (m, 4), ``regions`` (m,) from 0; per point ``stratum`` as in
    :func:`move_vertices`, ``label`` (that of a corner is its surface point, or -1: stays) and ``size``, the edge length
    wanted there; ``facets`` (k, 3), the boundary and whatever lies on a patch inside, ``facet_patch`` (k,), ``creases``
    (c, 2), ``crease_curve`` (c,). The surface to stay near: ``surface_points`` (p, 3), ``surface_triangles`` (t, 3),
    ``surface_patch`` (t,), ``surface_segments`` (s, 2), ``surface_curve`` (s,); patches and curves count from 0, and
    numbers may be left out.

    Facets and surface stay within ``tolerance``, a length, of each other, or come nearer where they were farther apart;
    planar patches and straight creases are kept exactly, unless they are smaller than 28 tolerances and 3 % of the
    surface's diagonal, and corners at them; other corners move by up to half the tolerance. ``flip_surface`` and
    ``split_surface`` say whether surface facets may be flipped, and crease edges and surface edges split or collapsed.
    At most ``passes`` sweeps and ``kicks`` tries. ``progress(phase, done, bad)`` as in :func:`move_vertices`.
    ``ruled_out`` (r,): rows of ``facets`` on which no tet can meet the goal as long as they stay; only where the
    surface is neither flipped nor split, or of ``fixed`` (f,) patches, whose vertices stay too. ``fixed_curves``
    (g,): curves whose edges are not split.
    ``loose`` (l,): curves that are creases by their angle alone. Those of them that are not kept exactly, nor bound a
    planar patch that is, become ordinary surface where tets near them withstand an eighth of the ``kicks``.
    ``flat``: a length, as far off a plane or line the surface's vertices may be where they count as on it, if that is
    more than 1e-9 of its extent.

    ``volumes`` (regions,), > 0: what the regions are to have in the end, as far as tets and tolerance allow. Planar
    patches with curved rims keep their area so too.

    ``worth``: evaluations per tet that getting rid of all bad tets is worth; kicks stop where it would take more.
    ``most_tets``: what the mesh may grow to. ``most_evaluations``: of tets' energies, after which kicks end.

    ``crease_angle``, in degrees: no edge within a curved patch comes to bend more, if none beside it did before.
    """

def closest_points(
    surface_points: NDArray[np.float64],
    triangles: NDArray[np.int64],
    queries: NDArray[np.float64],
    threads: int = 0,
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Nearest points (q, 3) of a triangle surface, the triangles (q,) they lie on and the distances (q,)."""

def euler_characteristics(tets: NDArray[np.int64], region: NDArray[np.int64]) -> NDArray[np.int64]:
    """Euler characteristic (regions,) of ``tets`` (m, 4) by ``region`` (m,): vertices - edges + facets - tets."""

def farthest_sample(
    points: NDArray[np.float64],
    triangles: NDArray[np.int64],
    step: float,
    surface_points: NDArray[np.float64],
    surface_triangles: NDArray[np.int64],
    threads: int = 0,
) -> tuple[float, tuple[float, float, float]]:
    """The sample of one triangle surface that is farthest from another: its distance and where it is.

    Samples are the corners and, regularly, points inside the triangles and on their edges, neighbours at most ``step``
    apart; 0 for the corners alone.
    """

def surface_curvatures(
    surface_points: NDArray[np.float64], triangles: NDArray[np.int64], patch: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Principal curvatures (t, 6) at the three corners of each triangle as its ``patch`` (t,) sees them, larger first.

    Positive where the surface bends away from its normal; zero on planar patches.
    """

def read_reals(
    text: bytes, head: bytes = b"", stop: bytes = b"", start: int = 0, lines: int | None = None
) -> tuple[NDArray[np.float64], NDArray[np.int64], int, bool]:
    """The numbers of a text (n,), how many each line has that is read, where reading ended, and whether all is well.

    Blanks part numbers; each is rounded to nearest. Exponents may be Fortran's D. Without a ``head`` all lines are read
    that have any word; with one, in small letters, those that begin with it, behind it. What of a word is behind the
    letter ``stop`` is left out. ``start``: where to begin; ``lines``: how many are read at most. Reading ends behind
    the last line, or at the first word that is no number, and then all is not well.
    """

def read_integers(
    text: bytes, head: bytes = b"", stop: bytes = b"", start: int = 0, lines: int | None = None
) -> tuple[NDArray[np.int64], NDArray[np.int64], int, bool]:
    """The same of whole numbers; these may have a point and an exponent."""
