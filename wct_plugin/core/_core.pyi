"""
Compiled core of wct_plugin: arrays in, arrays out.

Arrays are C-contiguous, float64 for coordinates and int64 for indices unless stated; a wrong type, shape or index
raises ValueError. Inputs are never changed. The interpreter is free to run other threads meanwhile.

``threads`` is how many a function works with at most; 0 means OMP_NUM_THREADS, or one per core where that is not set.
The results are the same bits whatever it is.
"""

from collections.abc import Callable
from typing import Any, Literal

import numpy
import numpy.typing

import wct_plugin.core.domain
import wct_plugin.core.requests
import wct_plugin.core.results


def tet_energy(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64], *, margin3: float, power3: float, margin2: float, power2: float, weight2: float, weight_quality: float) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
    """
    How far each tet is from being well-centered, and which way is better.

    ::

        E = sum over 4 facets         max(0, margin3 - h/R)^power3
          + weight2 * sum over 12 angles  max(0, margin2 - cos)^power2
          + weight_quality * sum over 4 facets  (h/R - 1/3)^2

    with h the signed height of the circumcenter over the facet, R the circumradius and cos the cosines of the facet angles.
    Powers are at least 1; multiples of one half up to 3 are quickest.

    ``points`` (n, 3), ``tets`` (m, 4). Returns the energies (m,) and the gradient (n, 3) of their sum. A tet that is
    inverted or flat, det <= 1e-5 longest_edge^3, has infinite energy and no part in the gradient.

    Raises
    ------
    ValueError
        Where an array has a wrong type, shape or index, or a power is below 1.
    """

def star_energy(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64], point: int, *, margin3: float, power3: float, margin2: float, power2: float, weight2: float, weight_quality: float) -> tuple[float, numpy.typing.NDArray[numpy.float64]]:
    """
    The energy of :func:`tet_energy` summed over the tets around one point, and its gradient (3,) in that point.

    Here a tet may be as flat as it is; it is infinite where one is inverted.
    """

def orientation(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64]) -> numpy.typing.NDArray[numpy.int8]:
    """
    Exact sign of det(x1-x0, x2-x0, x3-x0) per tet: 1, -1, or 0 for four coplanar points.

    ``points`` (n, 3) finite, ``tets`` (m, 4); returns (m,).
    """

def move_vertices(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64], strata: wct_plugin.core.domain.InStrata, *, goal: Literal['3wc', 'cwc'], margin: float, effort: int, tolerance: float = ..., progress: Callable[[float, int], Any] | None = None) -> tuple[numpy.typing.NDArray[numpy.float64], wct_plugin.core.results.MoveReport]:
    """
    Move vertices so that as many tets as possible contain their circumcenter ("3wc"), and have acute facets ("cwc").

    Parameters
    ----------
    points, tets
        (n, 3) and (m, 4), all positive.
    strata
        What each point may do: those inside move freely, those of a patch on its triangles, those of a crease on its
        segments, corners stay. Triangles and segments lie where the points are now. Flat patches and straight creases stay
        so to rounding.
    margin
        0 to 1/3, the clearance wanted in h/R, and in the cosines for cwc.
    effort
        1 to 1000, multiplies the iterations.
    tolerance
        A length, without limit by default: how far curved patches, as the moved points span them, may be from where they
        are now, patch by patch and both ways; and curved creases likewise. Planes and straight creases know none.
    progress
        ``progress(done, bad)`` hears the done fraction and the number of tets that miss the goal so far; if it returns
        something false other than None, the best positions so far are returned; if it raises, that propagates, as does
        KeyboardInterrupt.

    Returns
    -------
    tuple
        The points (n, 3), and what was done. Whatever happens, no tet is inverted and no fewer contain their circumcenter
        than before, both exactly; points that may not move keep their bits; the same input gives the same bits.

    Raises
    ------
    ValueError
        Where an array has a wrong type, shape or index, an option a value that is not allowed, or a tet is inverted.
    """

def delaunay(points: numpy.typing.NDArray[numpy.float64]) -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int64]]:
    """
    Delaunay tetrahedralization of ``points`` (n, 3).

    Returns tets (m, 4), positively oriented, and neighbours (m, 4): the tet across the facet opposite each vertex, -1 on
    the hull. Exact: no point lies inside a circumsphere and no tet is flat.

    Raises
    ------
    ValueError
        For fewer than four points, and for points that are not finite, coincide or all lie in one plane.
    """

def closest_points(surface_points: numpy.typing.NDArray[numpy.float64], triangles: numpy.typing.NDArray[numpy.int64], queries: numpy.typing.NDArray[numpy.float64], threads: int = 0) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64]]:
    """
    Nearest points (q, 3) of a triangle surface, the triangles (q,) they lie on and the distances (q,).
    """

def edge_table(tets: numpy.typing.NDArray[numpy.int64], points: int) -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int64]]:
    """
    Every edge (e, 2) of ``tets`` (m, 4) once, ends ascending, rows in lexicographic order, and each tet's (m, 6).

    The edges of a tet are those of its corners 01, 02, 03, 12, 13 and 23.
    """

def euler_characteristics(tets: numpy.typing.NDArray[numpy.int64], region: numpy.typing.NDArray[numpy.int64]) -> numpy.typing.NDArray[numpy.int64]:
    """
    Euler characteristic (regions,) of ``tets`` (m, 4) by ``region`` (m,): vertices - edges + facets - tets.
    """

def facet_pairs(tets: numpy.typing.NDArray[numpy.int64], points: int) -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int64], bool]:
    """
    Half-facets, 4 times a tet of ``tets`` (m, 4) and the corner opposite, that face each other (p, 2).

    The first is the smaller, and the pairs ascend by it. Then those (b,), ascending, that face nothing, and whether any
    facet belongs to three tets or more; its half-facets are among the latter.
    """

def components(rows: numpy.typing.NDArray[numpy.int64], columns: numpy.typing.NDArray[numpy.int64], count: int) -> numpy.typing.NDArray[numpy.int64]:
    """
    Number (count,) of each node's component, where links ``rows[k]`` - ``columns[k]`` (k,) join two nodes.

    Components are numbered from 0 in the order of their first nodes.
    """

def facet_order(tets: numpy.typing.NDArray[numpy.int64], points: int) -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.bool_]]:
    """
    Half-facets (4 m,), 4 times a tet of ``tets`` (m, 4) and the corner opposite, by their ascending corners.

    Those with the same corners ascend. Which of them (4 m - 1,) have the same corners as the next one.
    """

def farthest_sample(points: numpy.typing.NDArray[numpy.float64], triangles: numpy.typing.NDArray[numpy.int64], step: float, surface_points: numpy.typing.NDArray[numpy.float64], surface_triangles: numpy.typing.NDArray[numpy.int64], threads: int = 0) -> tuple[float, tuple[float, float, float]]:
    """
    The sample of one triangle surface that is farthest from another: its distance and where it is.

    Samples are the corners and, regularly, points inside the triangles and on their edges, neighbours at most ``step``
    apart; 0 for the corners alone.
    """

def surface_curvatures(surface_points: numpy.typing.NDArray[numpy.float64], triangles: numpy.typing.NDArray[numpy.int64], patch: numpy.typing.NDArray[numpy.int64]) -> numpy.typing.NDArray[numpy.float64]:
    """
    Principal curvatures (t, 6) at the three corners of each triangle as its patch sees them, the larger first.

    Positive where the surface bends away from its normal; zero on planar patches.
    """

def resample(surface: wct_plugin.core.domain.StratifiedSurface, mesh: wct_plugin.core.domain.RegionMesh | wct_plugin.core.domain.StratifiedMesh, options: wct_plugin.core.requests.ResampleOptions, *, kept: wct_plugin.core.requests.KeptPoints | None = None, held: wct_plugin.core.requests.HeldFacets | None = None, progress: Callable[[float, int], Any] | None = None, expected: Callable[[float], Any] | None = None, threads: int = 0) -> wct_plugin.core.results.ResampleResult:
    """
    Resample a domain with tets that are nearly all well-centered.

    Parameters
    ----------
    surface
        To stay near; with its sides and corners.
    mesh
        Says what is inside.
    options
        How.
    kept
        Points of a mesh that stay, but for those near some places: it is made anew there, and what is beside moves.
    held
        Facets and edges that are to be in the mesh, to the bit.
    progress
        ``progress(done, bad)`` hears the done fraction and the number of tets that miss the goal; it returns something
        false other than None to stop.
    expected
        ``expected(tets)`` hears about how many tets there will be, before any is made, but for a mesh made anew in places;
        it returns False to give up, without a tet.
    threads
        At most so many work; 0: OMP_NUM_THREADS, or one per core. The bits are the same whatever it is.

    Returns
    -------
    ResampleResult
        The label of a corner is its surface point. Points of the surface that are buried inside count as interior.
        No tets where it was stopped before there were any, or with ``one_row`` false where there is no layer for one. The
        same input and seed give the same bits.

    Raises
    ------
    ValueError
        Where an array has a wrong type, shape or index, or an option a value that is not allowed.
    """

def conform(mesh: wct_plugin.core.domain.StratifiedMesh, sides: numpy.typing.NDArray[numpy.int64], tolerance: float, options: wct_plugin.core.requests.ConformOptions, *, given: wct_plugin.core.domain.Triangles | None = None, progress: Callable[[float, int], Any] | None = None, threads: int = 0) -> wct_plugin.core.results.ConformResult:
    """
    Make a mesh Delaunay, and one-sided, with its surface vertices where they are, or nearly so within their planes.

    Parameters
    ----------
    mesh
        With its surface.
    sides
        (patches, 2) of its patches, as of a StratifiedSurface.
    tolerance
        Greatest distance, a length, of the new surface from the facets, or from the given triangles where there are some.
    options
        How.
    given
        Triangles that the facets stand for.
    progress, threads
        As of resample.

    Returns
    -------
    ConformResult
        The same input and seed give the same bits.

    Raises
    ------
    ValueError
        Where an array has a wrong type, shape or index, or an option a value that is not allowed.
    """

def refill(mesh: wct_plugin.core.domain.StratifiedMesh, sides: numpy.typing.NDArray[numpy.int64], *, size: numpy.typing.NDArray[numpy.float64] | None = None, cosines: bool = True, seed: int = 1, progress: Callable[[float, int], Any] | None = None, expected: Callable[[float], Any] | None = None, threads: int = 0) -> wct_plugin.core.results.RefillResult:
    """
    Fill a mesh anew between its surface facets, which stay, as do its creases and all points of its surface.

    Parameters
    ----------
    mesh
        With its surface; its sizes do not matter.
    sides
        (patches, 2) of its patches, as of a StratifiedSurface.
    size
        (n,) wanted edge length per point; without it the new mesh has up to twice the tets.
    cosines
        Triangles are to be acute, too.
    expected
        As of resample; it is called where there are wanted lengths.
    seed, progress, threads
        As of resample.

    Returns
    -------
    RefillResult
        The same input and seed give the same bits.

    Raises
    ------
    ValueError
        Where an array has a wrong type, shape or index.
    """

def conform_inside(mesh: wct_plugin.core.domain.StratifiedMesh, sides: numpy.typing.NDArray[numpy.int64], options: wct_plugin.core.requests.ConformOptions, progress: Callable[[float, int], Any] | None = None) -> wct_plugin.core.results.RefillResult:
    """
    Make a mesh Delaunay, and one-sided, between its surface facets, which stay.

    Arguments, result and errors as of refill; edges are as long as the mesh's sizes say.
    """

def measure_tets(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64], threads: int = 0) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.int8], numpy.typing.NDArray[numpy.bool_]]:
    """
    Measures of ``tets`` (m, 4): numbers (8, m), the facet (m,) with the smallest h/R, flags (3, m).

    The numbers are the smallest and largest h/R, face angle and dihedral angle in degrees, circumradius over shortest edge,
    and signed volume; the flags, exact, are 3WC, 2WC and acute.
    """

def tet_volumes(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64], threads: int = 0) -> numpy.typing.NDArray[numpy.float64]:
    """Signed volumes (m,) of ``tets`` (m, 4)."""

def circumradii(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64], threads: int = 0) -> numpy.typing.NDArray[numpy.float64]:
    """Circumradii (m,) of ``tets`` (m, 4)."""

def unsigned_volumes(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64], threads: int = 0) -> numpy.typing.NDArray[numpy.float64]:
    """
    Volume (m,) of the parts of dual cells in each of ``tets`` (m, 4), without their signs.

    Infinite in tets so flat that it is not known.
    """

def circumcenter_heights(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64], threads: int = 0) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
    """
    Signed heights (m, 4) of circumcenters over the facets opposite each corner of ``tets`` (m, 4).

    And bounds of their rounding errors (m, 4), infinite where nothing is known.
    """

def dual_edge_sums(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64], tet_edges: numpy.typing.NDArray[numpy.int64], edges: int, coefficient: numpy.typing.NDArray[numpy.float64] | None = None, threads: int = 0) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
    """
    What :func:`circumcenter_heights` gives, and per edge (edges,) the sum of cot(gamma) h, and its error's bound.

    The sum runs over the facets at the edge in each of ``tets`` (m, 4), gamma the facet's angle opposite the edge, h the
    circumcenter's height over the facet. ``tet_edges`` (m, 6) are the numbers of the tets' edges, ``coefficient`` (m,)
    multiplies all that is of a tet.
    """

def orthogonality(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64], pairs: numpy.typing.NDArray[numpy.int64], threads: int = 0) -> numpy.typing.NDArray[numpy.float64]:
    """
    Cosine (p,) between a facet's normal and the line between its tets' centroids.

    A row of ``pairs`` (p, 4) is a tet, its facet, the tet across, its facet.
    """

def dihedral_counts(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64], bins: numpy.typing.NDArray[numpy.float64], threads: int = 0) -> numpy.typing.NDArray[numpy.int64]:
    """
    How many of the dihedral angles of ``tets`` (m, 4), in degrees, are in each of the bins (b + 1 ends).
    """

def local_tolerance(surface: wct_plugin.core.domain.StratifiedSurface, *, tolerance: float, floor: float, threads: int = 0) -> numpy.typing.NDArray[numpy.float64]:
    """
    Per point of a surface, (n,), a tenth of the wall, gap or radius there, within ``floor``..``tolerance``.

    All are lengths. ``threads`` as of resample.

    Raises
    ------
    ValueError
        Where an array has a wrong type, shape or index, or a length is not positive.
    """

def read_reals(text: bytes, head: bytes = b'', stop: bytes = b'', start: int = 0, lines: int | None = None) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.int64], int, bool]:
    """
    The numbers of a text (n,), how many each line has that is read, where reading ended, and whether all is well.

    Blanks part numbers; each is rounded to nearest. Exponents may be Fortran's D. Without a ``head`` all lines are read
    that have any word; with one, in small letters, those that begin with it, behind it. What of a word is behind the letter
    ``stop`` is left out. ``start``: where to begin; ``lines``: how many are read at most. Reading ends behind the last
    line, or at the first word that is no number, and then all is not well.
    """

def read_integers(text: bytes, head: bytes = b'', stop: bytes = b'', start: int = 0, lines: int | None = None) -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int64], int, bool]:
    """The same of whole numbers; these may have a point and an exponent."""

def search_well_centered(mesh: wct_plugin.core.domain.StratifiedMesh, surface: wct_plugin.core.domain.StratifiedSurface, options: wct_plugin.core.requests.SearchOptions, progress: Callable[[str, float, int], Any] | None = None, threads: int = 0) -> wct_plugin.core.results.SearchResult:
    """
    Reconnect and move by local search until all tets contain their circumcenter, and facets are acute.

    Facets and surface stay within the tolerance of each other, or come nearer where they were farther apart. Planar patches
    and straight creases are kept exactly, unless they are smaller than 28 tolerances and 3 % of the surface's diagonal, and
    corners at them; other corners move by up to half the tolerance.

    Parameters
    ----------
    mesh
        Whose facets are the boundary and whatever lies on a patch inside.
    surface
        To stay near. Its sides and corners do not matter.
    options
        How. Rows that are ruled out go only with a surface that is neither flipped nor split, or with fixed patches. Of the
        loose curves, those that are not kept exactly, nor bound a planar patch that is, become ordinary surface where tets
        near them withstand an eighth of the kicks. Volumes are reached as far as tets and tolerance allow; planar patches
        with curved rims keep their area so too.
    progress
        ``progress(phase, done, bad)`` hears the done fraction of the phase and the number of tets that miss the goal; it
        returns something false other than None to stop.
    threads
        To work on; 0 as many as OMP_NUM_THREADS says, or there are cores. The same bits come out whatever it is.

    Returns
    -------
    SearchResult
        The same input and seed give the same bits.

    Raises
    ------
    ValueError
        Where an array has a wrong type, shape or index, an option a value that is not allowed, a tet is inverted or flat,
        or a facet is none of a tet.
    """
