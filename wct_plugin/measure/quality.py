"""Every measure of a tetrahedron, vectorised NumPy: h/R, face and dihedral angles, R/l, and what follows from them.

Definitions follow VanderZee, Hirani and Guoy, "Triangulation of Simple 3D Shapes with Well-Centered Tetrahedra"
(17th International Meshing Roundtable, 2008), section 2. The one formula behind them: with u, v, w the edges from
vertex 0, N1 = v x w, N2 = w x u, N3 = u x v, N0 = -(N1 + N2 + N3) the inward normals, det = u . N1 and
Q = |u|^2 N1 + |v|^2 N2 + |w|^2 N3, the circumcenter is x0 + Q / (2 det), and

    h_i / R = P_i / (|N_i| |Q|),   P_i = N_i . Q (i = 1, 2, 3),   P_0 = N0 . Q + 2 det^2.

P_i is a polynomial: nothing is divided by a volume that may be tiny, so a sliver's h/R is as good as its coordinates.

Signs and rounding
------------------
A flag is exact: floating point decides where the value exceeds a bound of its own rounding error, on either side of
zero, and :mod:`wct_plugin.exact` the rest, so exact right angles and circumcenters that lie in a facet never pass, and
what is off by one unit in the last place is told from them. The smallest h/R and the largest angles are kept on their
flag's side of 0 and 90 degrees. The input coordinates count as exact; their differences are then rounded once,
relative to themselves, so distance from the origin does no harm. The bound is the usual one: a sum of
products whose terms each pass through k roundings is off by at most k eps (eps = 2^-53) times the same sum with every
term replaced by its absolute value, to first order. Here k is 19 for P_1..P_3 and 22 for P_0 (24 used for both), 13
for N_i . N_j (15 used), 5 for the dot product of the two edges at a face angle (6 used); the slack covers the higher
orders and the rounding of the bound itself. The sums of absolute values are smallest where vertex 0 is the one with
the shortest edges, so each tet is first renumbered that way. Points are scaled by a power of two into the unit cube,
which is exact, so that no unit of length under- or overflows.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import exact_signs
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import EDGES, FACETS
from wct_plugin.types import Bools, Floats, Ints

_EPS = 2.0**-53
_HEIGHT_BOUND = 24.0 * _EPS
_DIHEDRAL_BOUND = 15.0 * _EPS
_ANGLE_BOUND = 6.0 * _EPS
#: Added to each bound: what underflow may take from degree-6 polynomials of coordinates in the unit cube.
_FLOOR = 1e-300
#: Tets treated together: small enough that the hundred or so temporaries stay in cache.
_CHUNK = 8192

#: Row b: the columns of h/R, of the 12 face angles and of the 6 dihedral angles after the renumbering i -> i xor b,
#: which is an even permutation and its own inverse.
_HEIGHT_COLUMNS = np.arange(4)[:, None] ^ np.arange(4)
_ANGLES = [(facet, int(vertex)) for facet in range(4) for vertex in FACETS[facet]]
_ANGLE_COLUMNS = np.array([[_ANGLES.index((f ^ b, v ^ b)) for f, v in _ANGLES] for b in range(4)])
_PAIRS = [(int(p), int(q)) for p, q in EDGES]
_EDGE_COLUMNS = np.array([[_PAIRS.index((min(p ^ b, q ^ b), max(p ^ b, q ^ b))) for p, q in _PAIRS] for b in range(4)])
#: Per face angle: the edges that span it, as (row of EDGES, sign), both leaving its vertex.
_SPANS = [
    [(_PAIRS.index((min(v, o), max(v, o))), 1.0 if v < o else -1.0) for o in (int(x) for x in FACETS[f] if x != v)]
    for f, v in _ANGLES
]
#: Per edge: the two facets that meet there, the ones opposite its two missing vertices.
_WINGS = [tuple(facet for facet in range(4) if facet not in pair) for pair in _PAIRS]
#: Columns of :func:`wct_plugin.exact.predicates.pulls`: the dot products of the normals of two different facets.
_NORMAL_PAIRS = [4 * i + j for i, j in _WINGS]
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


class _Shapes:
    """The polynomials behind all measures for one chunk of tets, renumbered by i -> i xor ``base``.

    Vectors are (3, c), scalars (c,), so that every operation runs along contiguous memory.
    """

    def __init__(self, coordinates: Floats, tets: Ints) -> None:
        corners = coordinates[:, tets.T]
        squares = [_dot(edge, edge) for edge in _edges(corners)]
        incident = np.empty((4, len(tets)))
        for vertex in range(4):
            incident[vertex] = sum(squares[k] for k, pair in enumerate(_PAIRS) if vertex in pair)
        self.base = np.argmin(incident, axis=0)
        renumbered = np.take_along_axis(tets, _HEIGHT_COLUMNS[self.base], axis=1)
        self.origin = coordinates[:, renumbered[:, 0]]
        self.edges = _edges(coordinates[:, renumbered.T])
        self.squares = [_dot(edge, edge) for edge in self.edges]
        self.lengths = [np.sqrt(square) for square in self.squares]
        u, v, w = self.edges[:3]
        n1, n2, n3 = _cross(v, w), _cross(w, u), _cross(u, v)
        self.normals = [-(n1 + n2 + n3), n1, n2, n3]
        self.det = _dot(u, n1)
        self.q = self.squares[0] * n1 + self.squares[1] * n2 + self.squares[2] * n3
        self.areas = [np.sqrt(_dot(normal, normal)) for normal in self.normals]  # twice the facets' areas

    @cached_property
    def normal_sizes(self) -> list[Floats]:
        """N_0 .. N_3 (3, c) with every term replaced by its absolute value."""
        u, v, w = (np.abs(edge) for edge in self.edges[:3])
        sizes = [_cross_sizes(v, w), _cross_sizes(w, u), _cross_sizes(u, v)]
        return [sizes[0] + sizes[1] + sizes[2], *sizes]

    @cached_property
    def det_size(self) -> Floats:
        """The determinant with every term replaced by its absolute value."""
        return _dot(np.abs(self.edges[0]), self.normal_sizes[1])

    def heights(self) -> list[Floats]:
        """P_i per facet."""
        first = _dot(self.normals[0], self.q) + 2.0 * self.det * self.det
        return [first, *(_dot(normal, self.q) for normal in self.normals[1:])]

    def height_bounds(self) -> list[Floats]:
        """Rounding error of P_i per facet."""
        n0, n1, n2, n3 = self.normal_sizes
        q = self.squares[0] * n1 + self.squares[1] * n2 + self.squares[2] * n3
        sizes = [_dot(n0, q) + 2.0 * self.det_size * self.det_size, _dot(n1, q), _dot(n2, q), _dot(n3, q)]
        return [_HEIGHT_BOUND * size + _FLOOR for size in sizes]

    def face_dots(self) -> list[Floats]:
        """|a| |b| cos of the twelve face angles, a and b the edges that span them."""
        return [(sign_a * sign_b) * _dot(self.edges[a], self.edges[b]) for (a, sign_a), (b, sign_b) in _SPANS]

    def face_bounds(self) -> list[Floats]:
        """Rounding error of :meth:`face_dots`."""
        sizes = [np.abs(edge) for edge in self.edges]
        return [_ANGLE_BOUND * _dot(sizes[a], sizes[b]) + _FLOOR for (a, _), (b, _) in _SPANS]

    def dihedral_dots(self) -> list[Floats]:
        """|N_i| |N_j| cos of the six dihedral angles."""
        dots = {(i, j): _dot(self.normals[i], self.normals[j]) for i, j in ((1, 2), (1, 3), (2, 3))}
        own = [_dot(normal, normal) for normal in self.normals[1:]]
        dots[0, 1] = -(own[0] + dots[1, 2] + dots[1, 3])
        dots[0, 2] = -(dots[1, 2] + own[1] + dots[2, 3])
        dots[0, 3] = -(dots[1, 3] + dots[2, 3] + own[2])
        return [-dots[wings[0], wings[1]] for wings in _WINGS]

    def dihedral_bounds(self) -> list[Floats]:
        """Rounding error of :meth:`dihedral_dots`."""
        sizes = self.normal_sizes
        return [_DIHEDRAL_BOUND * _dot(sizes[i], sizes[j]) + _FLOOR for i, j in _WINGS]

    def radius(self) -> Floats:
        """Circumradius, in the scaled unit."""
        radius: Floats = np.sqrt(_dot(self.q, self.q)) / (2.0 * np.abs(self.det))
        return radius

    def shortest(self) -> Floats:
        """Shortest edge, in the scaled unit."""
        shortest: Floats = np.sqrt(np.minimum.reduce(self.squares))
        return shortest


def _dot(a: Floats, b: Floats) -> Floats:
    out: Floats = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return out


def _cross(a: Floats, b: Floats) -> Floats:
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _cross_sizes(a: Floats, b: Floats) -> Floats:
    return np.stack([a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]])


def _edges(corners: Floats) -> list[Floats]:
    return [corners[:, q] - corners[:, p] for p, q in _PAIRS]


def _chunks(points: Floats, tets: Ints) -> tuple[int, Iterator[tuple[slice, _Shapes]]]:
    """The exponent of the power of two the points are divided by, and the shapes chunk by chunk."""
    exponent = int(np.frexp(np.abs(points).max(initial=0.0))[1])
    coordinates = np.ascontiguousarray(np.ldexp(points, -exponent).T)

    def walk() -> Iterator[tuple[slice, _Shapes]]:
        for start in range(0, len(tets), _CHUNK):
            part = slice(start, min(start + _CHUNK, len(tets)))
            yield part, _Shapes(coordinates, tets[part])

    return exponent, walk()


def _restore(rows: list[Floats], columns: Ints, base: Ints) -> Floats:
    """(c, k) from k rows in the renumbered order, back in the tets' own order."""
    out: Floats = np.take_along_axis(np.stack(rows, axis=1), columns[base], axis=1)
    return out


def volumes(points: Floats, tets: Ints) -> Floats:
    """Signed volume per tet (m,): positive where vertices 1, 2, 3 run counter-clockwise seen from outside.

    ``points`` (n, 3), ``tets`` (m, 4). Zero volume gives about zero; the other measures are then NaN or infinite.
    """
    out = np.empty(len(tets))
    exponent, chunks = _chunks(points, tets)
    for part, shapes in chunks:
        out[part] = np.ldexp(shapes.det / 6.0, 3 * exponent)
    return out


def circumcenters(points: Floats, tets: Ints) -> Floats:
    """Circumcenter per tet (m, 3), in the unit of ``points`` (n, 3); ``tets`` (m, 4)."""
    out = np.empty((len(tets), 3))
    exponent, chunks = _chunks(points, tets)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for part, shapes in chunks:
            out[part] = np.ldexp(shapes.origin + shapes.q / (2.0 * shapes.det), exponent).T
    return out


def circumradii(points: Floats, tets: Ints) -> Floats:
    """Circumradius per tet (m,), in the unit of ``points`` (n, 3); ``tets`` (m, 4)."""
    out = np.empty(len(tets))
    exponent, chunks = _chunks(points, tets)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for part, shapes in chunks:
            out[part] = np.ldexp(shapes.radius(), exponent)
    return out


def heights_over_radius(points: Floats, tets: Ints) -> Floats:
    """h/R per facet (m, 4): column i is the facet opposite vertex i, positive where the circumcenter is on its side.

    ``points`` (n, 3), ``tets`` (m, 4) of either orientation. Range (-1, 1); 1/3 throughout the regular tetrahedron.
    """
    out = np.empty((len(tets), 4))
    _, chunks = _chunks(points, tets)
    with np.errstate(divide="ignore", invalid="ignore"):
        for part, shapes in chunks:
            out[part] = _restore(_ratios(shapes), _HEIGHT_COLUMNS, shapes.base)
    return out


def heights(points: Floats, tets: Ints) -> tuple[Floats, Floats]:
    """Signed height of the circumcenter over each facet (m, 4), and a bound of its rounding error (m, 4).

    Both in the unit of ``points`` (n, 3); columns as in :func:`heights_over_radius`. Unlike h/R the height itself is
    divided by the volume, so the bound is large, at worst infinite, for slivers.
    """
    values, errors = np.empty((len(tets), 4)), np.empty((len(tets), 4))
    exponent, chunks = _chunks(points, tets)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for part, shapes in chunks:
            values[part], errors[part] = _heights(shapes, exponent)
    return values, errors


def heights_and_cotangents(points: Floats, tets: Ints) -> tuple[Floats, Floats, Floats]:
    """What :func:`heights` gives, and cotangents of the face angles (m, 12), columns as in :func:`face_angles`.

    In one pass: the two that dual cells are made of. ``points`` (n, 3), ``tets`` (m, 4).
    """
    values, errors, cotangents = (np.empty((len(tets), columns)) for columns in (4, 4, 12))
    exponent, chunks = _chunks(points, tets)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for part, shapes in chunks:
            values[part], errors[part] = _heights(shapes, exponent)
            rows = [dot / shapes.areas[facet] for (facet, _), dot in zip(_ANGLES, shapes.face_dots(), strict=True)]
            cotangents[part] = _restore(rows, _ANGLE_COLUMNS, shapes.base)
    return values, errors, cotangents


def face_angles(points: Floats, tets: Ints) -> Floats:
    """Face angles in degrees (m, 12): column 3 i + k is facet i (opposite vertex i) at its vertex ``FACETS[i, k]``.

    ``points`` (n, 3), ``tets`` (m, 4); ``FACETS`` is :data:`wct_plugin.mesh.topology.FACETS`.
    """
    out = np.empty((len(tets), 12))
    _, chunks = _chunks(points, tets)
    for part, shapes in chunks:
        dots = shapes.face_dots()
        rows = [np.arctan2(shapes.areas[facet], dot) for (facet, _), dot in zip(_ANGLES, dots, strict=True)]
        out[part] = np.degrees(_restore(rows, _ANGLE_COLUMNS, shapes.base))
    return out


def dihedral_angles(points: Floats, tets: Ints) -> Floats:
    """Dihedral angles in degrees (m, 6): column k at edge ``EDGES[k]`` of :data:`wct_plugin.mesh.topology.EDGES`.

    ``points`` (n, 3), ``tets`` (m, 4) of either orientation.
    """
    out = np.empty((len(tets), 6))
    _, chunks = _chunks(points, tets)
    for part, shapes in chunks:
        # |N_i x N_j| = |det| times the length of the edge the two facets share.
        det = np.abs(shapes.det)
        rows = [
            np.arctan2(det * length, dot) for length, dot in zip(shapes.lengths, shapes.dihedral_dots(), strict=True)
        ]
        out[part] = np.degrees(_restore(rows, _EDGE_COLUMNS, shapes.base))
    return out


def radius_over_edge(points: Floats, tets: Ints) -> Floats:
    """R/l per tet (m,): circumradius over shortest edge, at least sqrt(3/8); ``points`` (n, 3), ``tets`` (m, 4)."""
    out = np.empty(len(tets))
    _, chunks = _chunks(points, tets)
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
    exponent, chunks = _chunks(mesh.points, mesh.tets)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for part, shapes in chunks:
            ratios = np.stack(_ratios(shapes))
            facet = np.argmin(ratios, axis=0)
            worst[part] = facet ^ shapes.base
            floats[0, part] = np.take_along_axis(ratios, facet[None], axis=0)[0]
            floats[1, part] = ratios.max(axis=0)
            faces, dihedrals = shapes.face_dots(), shapes.dihedral_dots()
            floats[2:4, part] = _extremes(
                [(dot, shapes.areas[facet]) for (facet, _), dot in zip(_ANGLES, faces, strict=True)]
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


def _ratios(shapes: _Shapes) -> list[Floats]:
    size = np.sqrt(_dot(shapes.q, shapes.q))
    return [p / (area * size) for p, area in zip(shapes.heights(), shapes.areas, strict=True)]


def _heights(shapes: _Shapes, exponent: int) -> tuple[Floats, Floats]:
    """The circumcenters' heights (c, 4) and their bounds (c, 4), in the unit of the points, in the tets' own order."""
    det = np.abs(shapes.det)
    det_error = 10.0 * _EPS * shapes.det_size / det
    rows, bounds = [], []
    for p, bound, area, size in zip(
        shapes.heights(), shapes.height_bounds(), shapes.areas, shapes.normal_sizes, strict=True
    ):
        height = p / (2.0 * det * area)
        relative = det_error + 10.0 * _EPS * np.sqrt(_dot(size, size)) / area
        error = bound / (2.0 * det * area) + np.abs(height) * relative
        rows.append(np.ldexp(height, exponent))
        # Where the divisor itself is in doubt, nothing is known.
        bounds.append(np.where(relative < 0.25, np.ldexp(2.0 * error, exponent), np.inf))
    return _restore(rows, _HEIGHT_COLUMNS, shapes.base), _restore(bounds, _HEIGHT_COLUMNS, shapes.base)


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
