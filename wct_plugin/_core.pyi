"""Compiled core of wct_plugin: arrays in, arrays out.

Arrays are C-contiguous, float64 for coordinates and int64 for indices unless stated; a wrong type, shape or index
raises ValueError. Inputs are never changed. The interpreter is free to run other threads meanwhile.
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
    the iterations.

    ``tolerance`` is a length, without limit by default: how far curved patches, as the moved points span them, may be
    from where they are now, patch by patch and both ways; and curved creases likewise. Planes and straight creases know
    none.

    ``progress(done, bad)`` hears the done fraction and the number of tets that miss the goal so far; if it returns
    something false other than None, the best positions so far are returned; if it raises, that propagates, as does
    KeyboardInterrupt.

    Whatever happens, no returned tet is inverted and no fewer contain their circumcenter than before, both exactly;
    points that may not move keep their bits; the same input gives the same bits.
    """
