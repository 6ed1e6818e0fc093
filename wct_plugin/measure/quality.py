"""Every measure of a tetrahedron, vectorised NumPy: h/R, face and dihedral angles, R/l, and what follows from them.

Definitions follow VanderZee, Hirani and Guoy, "Triangulation of Simple 3D Shapes with Well-Centered Tetrahedra"
(17th International Meshing Roundtable, 2008), section 2. The formulas behind them, with the bounds of their rounding
errors, are in :mod:`wct_plugin.measure.shape_polynomials`.

A flag is exact: floating point decides where the value exceeds a bound of its own rounding error, on either side of
zero, and :mod:`wct_plugin.exact` the rest, so exact right angles and circumcenters that lie in a facet never pass, and
what is off by one unit in the last place is told from them. The smallest h/R and the largest angles are kept on their
flag's side of 0 and 90 degrees.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import exact_signs
from wct_plugin.measure.shape_polynomials import (
    ANGLE_COLUMNS,
    ANGLES,
    EDGE_COLUMNS,
    EPS,
    HEIGHT_COLUMNS,
    WINGS,
    Shapes,
    dot,
    in_chunks,
    restore,
)
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import FACETS
from wct_plugin.types import Bools, Floats, Ints

#: Columns of :func:`wct_plugin.exact.predicates.pulls`: the dot products of the normals of two different facets.
_NORMAL_PAIRS = [4 * i + j for i, j in WINGS]
#: Nearest numbers beside the values that flags tell from: of an h/R above 0, of an angle below 90 degrees.
_POSITIVE, _ACUTE = np.finfo(np.float64).tiny, np.nextafter(90.0, 0.0)


@dataclass(frozen=True, eq=False)
class Quality:
    """The measures of ``m`` tets, one entry each, in the order of the mesh's tets. Angles in degrees."""

    min_height: Floats  #: (m,) smallest h/R of the four facets, in (-1, 1); positive iff 3WC
    max_height: Floats  #: (m,) largest h/R
    worst_facet: NDArray[np.int8]  #: (m,) the facet (opposite that vertex) with the smallest h/R
    min_face_angle: Floats  #: (m,) smallest of the twelve face angles
    max_face_angle: Floats  #: (m,) largest; below 90 iff 2WC
    min_dihedral_angle: Floats  #: (m,) smallest of the six dihedral angles
    max_dihedral_angle: Floats  #: (m,) largest; below 90 iff acute
    radius_over_edge: Floats  #: (m,) circumradius over shortest edge, at least sqrt(3/8)
    volume: Floats  #: (m,) in the mesh's own unit, cubed
    well_centered_3: Bools  #: (m,) contains its circumcenter, strictly and exactly
    well_centered_2: Bools  #: (m,) every face angle acute, exactly
    acute: Bools  #: (m,) every dihedral angle acute, exactly; implies 2WC (but not 3WC)

    @property
    def completely_well_centered(self) -> Bools:
        """(m,) both 2WC and 3WC."""
        return self.well_centered_3 & self.well_centered_2

    def __len__(self) -> int:
        return len(self.volume)


def volumes(points: Floats, tets: Ints) -> Floats:
    """Signed volume per tet (m,): positive where vertices 1, 2, 3 run counter-clockwise seen from outside.

    ``points`` (n, 3), ``tets`` (m, 4). Zero volume gives about zero; the other measures are then NaN or infinite.
    """
    out = np.empty(len(tets))
    exponent, chunks = in_chunks(points, tets)
    for part, shapes in chunks:
        out[part] = np.ldexp(shapes.det / 6.0, 3 * exponent)
    return out


def circumcenters(points: Floats, tets: Ints) -> Floats:
    """Circumcenter per tet (m, 3), in the unit of ``points`` (n, 3); ``tets`` (m, 4)."""
    out = np.empty((len(tets), 3))
    exponent, chunks = in_chunks(points, tets)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for part, shapes in chunks:
            out[part] = np.ldexp(shapes.origin + shapes.q / (2.0 * shapes.det), exponent).T
    return out


def circumradii(points: Floats, tets: Ints) -> Floats:
    """Circumradius per tet (m,), in the unit of ``points`` (n, 3); ``tets`` (m, 4)."""
    out = np.empty(len(tets))
    exponent, chunks = in_chunks(points, tets)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for part, shapes in chunks:
            out[part] = np.ldexp(shapes.radius(), exponent)
    return out


def heights_over_radius(points: Floats, tets: Ints) -> Floats:
    """h/R per facet (m, 4): column i is the facet opposite vertex i, positive where the circumcenter is on its side.

    ``points`` (n, 3), ``tets`` (m, 4) of either orientation. Range (-1, 1); 1/3 throughout the regular tetrahedron.
    """
    out = np.empty((len(tets), 4))
    _, chunks = in_chunks(points, tets)
    with np.errstate(divide="ignore", invalid="ignore"):
        for part, shapes in chunks:
            out[part] = restore(_ratios(shapes), HEIGHT_COLUMNS, shapes.base)
    return out


def heights(points: Floats, tets: Ints) -> tuple[Floats, Floats]:
    """Signed height of the circumcenter over each facet (m, 4), and a bound of its rounding error (m, 4).

    Both in the unit of ``points`` (n, 3); columns as in :func:`heights_over_radius`. Unlike h/R the height itself is
    divided by the volume, so the bound is large, at worst infinite, for slivers.
    """
    values, errors = np.empty((len(tets), 4)), np.empty((len(tets), 4))
    exponent, chunks = in_chunks(points, tets)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for part, shapes in chunks:
            values[part], errors[part] = _heights(shapes, exponent)
    return values, errors


def heights_and_cotangents(points: Floats, tets: Ints) -> tuple[Floats, Floats, Floats]:
    """What :func:`heights` gives, and cotangents of the face angles (m, 12), columns as in :func:`face_angles`.

    In one pass: the two that dual cells are made of. ``points`` (n, 3), ``tets`` (m, 4).
    """
    values, errors, cotangents = (np.empty((len(tets), columns)) for columns in (4, 4, 12))
    exponent, chunks = in_chunks(points, tets)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for part, shapes in chunks:
            values[part], errors[part] = _heights(shapes, exponent)
            rows = [dot / shapes.areas[facet] for (facet, _), dot in zip(ANGLES, shapes.face_dots(), strict=True)]
            cotangents[part] = restore(rows, ANGLE_COLUMNS, shapes.base)
    return values, errors, cotangents


def face_angles(points: Floats, tets: Ints) -> Floats:
    """Face angles in degrees (m, 12): column 3 i + k is facet i (opposite vertex i) at its vertex ``FACETS[i, k]``.

    ``points`` (n, 3), ``tets`` (m, 4); ``FACETS`` is :data:`wct_plugin.mesh.topology.FACETS`.
    """
    out = np.empty((len(tets), 12))
    _, chunks = in_chunks(points, tets)
    for part, shapes in chunks:
        dots = shapes.face_dots()
        rows = [np.arctan2(shapes.areas[facet], dot) for (facet, _), dot in zip(ANGLES, dots, strict=True)]
        out[part] = np.degrees(restore(rows, ANGLE_COLUMNS, shapes.base))
    return out


def dihedral_angles(points: Floats, tets: Ints) -> Floats:
    """Dihedral angles in degrees (m, 6): column k at edge ``EDGES[k]`` of :data:`wct_plugin.mesh.topology.EDGES`.

    ``points`` (n, 3), ``tets`` (m, 4) of either orientation.
    """
    out = np.empty((len(tets), 6))
    _, chunks = in_chunks(points, tets)
    for part, shapes in chunks:
        # |N_i x N_j| = |det| times the length of the edge the two facets share.
        det = np.abs(shapes.det)
        rows = [
            np.arctan2(det * length, dot) for length, dot in zip(shapes.lengths, shapes.dihedral_dots(), strict=True)
        ]
        out[part] = np.degrees(restore(rows, EDGE_COLUMNS, shapes.base))
    return out


def radius_over_edge(points: Floats, tets: Ints) -> Floats:
    """R/l per tet (m,): circumradius over shortest edge, at least sqrt(3/8); ``points`` (n, 3), ``tets`` (m, 4)."""
    out = np.empty(len(tets))
    _, chunks = in_chunks(points, tets)
    with np.errstate(divide="ignore", invalid="ignore"):
        for part, shapes in chunks:
            out[part] = shapes.radius() / shapes.shortest()
    return out


def measure(mesh: TetMesh) -> Quality:
    """All measures of a mesh in one pass; memory beyond the result is independent of the mesh's size, about 20 MB."""
    count = len(mesh.tets)
    floats = np.empty((8, count))
    worst = np.empty(count, dtype=np.int8)
    flags = np.empty((3, count), dtype=bool)
    exponent, chunks = in_chunks(mesh.points, mesh.tets)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for part, shapes in chunks:
            ratios = np.stack(_ratios(shapes))
            facet = np.argmin(ratios, axis=0)
            worst[part] = facet ^ shapes.base
            floats[0, part] = np.take_along_axis(ratios, facet[None], axis=0)[0]
            floats[1, part] = ratios.max(axis=0)
            faces, dihedrals = shapes.face_dots(), shapes.dihedral_dots()
            floats[2:4, part] = _extremes(
                [(dot, shapes.areas[facet]) for (facet, _), dot in zip(ANGLES, faces, strict=True)]
            )
            det = np.abs(shapes.det)
            sines = [det * length for length in shapes.lengths]
            floats[4:6, part] = _extremes(list(zip(dihedrals, sines, strict=True)))
            floats[6, part] = shapes.radius() / shapes.shortest()
            floats[7, part] = np.ldexp(shapes.det / 6.0, 3 * exponent)
            corners = mesh.points, mesh.tets[part]
            flags[0, part] = _all_positive(shapes.heights(), shapes.height_bounds(), corners, _well_centered_3)
            flags[1, part] = _all_positive(faces, shapes.face_bounds(), corners, _well_centered_2)
            # Acute implies 2WC, so that only what is 2WC need be looked at.
            flags[2, part] = _all_positive(dihedrals, shapes.dihedral_bounds(), corners, _acute, flags[1, part])
    return from_rows(floats, worst, flags)


def from_rows(floats: Floats, worst: NDArray[np.int8], flags: Bools) -> Quality:
    """The measures as objects: numbers (8, m) and flags (3, m) in the order of :class:`Quality`, and the worst facets.

    The arrays are the result's from now on.
    """
    _keep_to_flags(floats, flags)
    floats.setflags(write=False)
    worst.setflags(write=False)
    flags.setflags(write=False)
    lowest, highest, min_face, max_face, min_dihedral, max_dihedral, ratio, volume = floats
    return Quality(lowest, highest, worst, min_face, max_face, min_dihedral, max_dihedral, ratio, volume, *flags)


def _ratios(shapes: Shapes) -> list[Floats]:
    size = np.sqrt(dot(shapes.q, shapes.q))
    return [p / (area * size) for p, area in zip(shapes.heights(), shapes.areas, strict=True)]


def _heights(shapes: Shapes, exponent: int) -> tuple[Floats, Floats]:
    """The circumcenters' heights (c, 4) and their bounds (c, 4), in the unit of the points, in the tets' own order."""
    det = np.abs(shapes.det)
    det_error = 10.0 * EPS * shapes.det_size / det
    rows, bounds = [], []
    for p, bound, area, size in zip(
        shapes.heights(), shapes.height_bounds(), shapes.areas, shapes.normal_sizes, strict=True
    ):
        height = p / (2.0 * det * area)
        relative = det_error + 10.0 * EPS * np.sqrt(dot(size, size)) / area
        error = bound / (2.0 * det * area) + np.abs(height) * relative
        rows.append(np.ldexp(height, exponent))
        # Where the divisor itself is in doubt, nothing is known.
        bounds.append(np.where(relative < 0.25, np.ldexp(2.0 * error, exponent), np.inf))
    return restore(rows, HEIGHT_COLUMNS, shapes.base), restore(bounds, HEIGHT_COLUMNS, shapes.base)


def _all_positive(
    values: list[Floats],
    bounds: list[Floats],
    mesh: tuple[Floats, Ints],
    exactly: Callable[[Floats], Bools],
    among: Bools | None = None,
) -> Bools:
    """Per tet (c,) whether all of its values are positive, False outside of ``among``.

    What rounding leaves open is decided by ``exactly``, from the corners in the points and tets (c, 4) of ``mesh``.
    """
    points, tets = mesh
    possible = np.ones(len(tets), dtype=bool) if among is None else among.copy()
    surely = possible.copy()
    for value, bound in zip(values, bounds, strict=True):
        surely &= value > bound
        possible &= value >= -bound
    open_ = np.flatnonzero(possible & ~surely)
    if len(open_):
        surely[open_] = exactly(points[tets[open_]])
    return surely


def _well_centered_3(corners: Floats) -> Bools:
    """(c,) for tets given by their corners (c, 4, 3), by exact signs."""
    values = exact_signs(predicates.circumcenter, corners.reshape(-1, 3), np.arange(4 * len(corners)).reshape(-1, 4))
    inside: Bools = np.all(values.values > 0, axis=1)
    return inside


def _well_centered_2(corners: Floats) -> Bools:
    cells = 4 * np.arange(len(corners))[:, None, None] + FACETS
    values = exact_signs(predicates.corners, corners.reshape(-1, 3), cells.reshape(-1, 3)).values
    acute: Bools = np.all(values.reshape(len(corners), -1) > 0, axis=1)
    return acute


def _acute(corners: Floats) -> Bools:
    values = exact_signs(predicates.pulls, corners.reshape(-1, 3), np.arange(4 * len(corners)).reshape(-1, 4)).values
    acute: Bools = np.all(values[:, _NORMAL_PAIRS] < 0, axis=1)
    return acute


def _keep_to_flags(floats: Floats, flags: Bools) -> None:
    """Put the smallest h/R and the largest angles of :func:`measure` on their flag's side, which rounding may miss.

    So is what is no number of a tet whose flag holds, as one that is flat in all digits but one.
    """
    for row, flag in ((3, flags[1]), (5, flags[2])):
        floats[row] = np.where(flag, np.fmin(floats[row], _ACUTE), np.maximum(floats[row], 90.0))
    floats[0] = np.where(flags[0], np.fmax(floats[0], _POSITIVE), np.minimum(floats[0], 0.0))


def _extremes(angles: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    """Smallest and largest angle in degrees; each is given as (cosine, sine) times a positive factor of its own."""
    cotangents = [cosine / sine for cosine, sine in angles]  # falls as the angle grows; infinite at 0 and 180
    largest, smallest = cotangents[0].copy(), cotangents[0].copy()
    for cotangent in cotangents[1:]:
        np.maximum(largest, cotangent, out=largest)
        np.minimum(smallest, cotangent, out=smallest)
    return np.degrees(np.arctan2(1.0, largest)), np.degrees(np.arctan2(1.0, smallest))
