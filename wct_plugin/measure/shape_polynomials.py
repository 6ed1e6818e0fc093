"""The polynomials of its edges that all measures of a tet follow from, chunk by chunk, with their rounding errors.

With u, v, w the edges from vertex 0, N1 = v x w, N2 = w x u, N3 = u x v, N0 = -(N1 + N2 + N3) the inward normals,
det = u . N1 and Q = |u|^2 N1 + |v|^2 N2 + |w|^2 N3, the circumcenter is x0 + Q / (2 det), and

    h_i / R = P_i / (|N_i| |Q|),   P_i = N_i . Q (i = 1, 2, 3),   P_0 = N0 . Q + 2 det^2.

P_i is a polynomial: nothing is divided by a volume that may be tiny, so a sliver's h/R is as good as its coordinates.

The input coordinates count as exact; their differences are then rounded once, relative to themselves, so distance from
the origin does no harm. The bound of the rounding error is the usual one: a sum of products whose terms each pass
through k roundings is off by at most k eps (eps = 2^-53) times the same sum with every term replaced by its absolute
value, to first order. Here k is 19 for P_1..P_3 and 22 for P_0 (24 used for both), 13 for N_i . N_j (15 used), 5 for
the dot product of the two edges at a face angle (6 used); the slack covers the higher orders and the rounding of the
bound itself. The sums of absolute values are smallest where vertex 0 is the one with the shortest edges, so each tet is
first renumbered that way. Points are scaled by a power of two into the unit cube, which is exact, so that no unit of
length under- or overflows.
"""

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from wct_plugin.mesh.topology import EDGES, FACETS
from wct_plugin.types import Floats, Ints

EPS = 2.0**-53  #: the relative error of one rounding
_HEIGHT_BOUND = 24.0 * EPS
_DIHEDRAL_BOUND = 15.0 * EPS
_ANGLE_BOUND = 6.0 * EPS
#: Added to each bound: what underflow may take from degree-6 polynomials of coordinates in the unit cube.
_FLOOR = 1e-300
#: Tets treated together: small enough that the hundred or so temporaries stay in cache.
CHUNK = 8192

#: Row b: the columns of h/R, of the 12 face angles and of the 6 dihedral angles after the renumbering i -> i xor b,
#: which is an even permutation and its own inverse.
HEIGHT_COLUMNS = np.arange(4)[:, None] ^ np.arange(4)
ANGLES = [(facet, int(vertex)) for facet in range(4) for vertex in FACETS[facet]]
ANGLE_COLUMNS = np.array([[ANGLES.index((f ^ b, v ^ b)) for f, v in ANGLES] for b in range(4)])
_PAIRS = [(int(p), int(q)) for p, q in EDGES]
EDGE_COLUMNS = np.array([[_PAIRS.index((min(p ^ b, q ^ b), max(p ^ b, q ^ b))) for p, q in _PAIRS] for b in range(4)])
#: Per face angle: the edges that span it, as (row of EDGES, sign), both leaving its vertex.
_SPANS = [
    [(_PAIRS.index((min(v, o), max(v, o))), 1.0 if v < o else -1.0) for o in (int(x) for x in FACETS[f] if x != v)]
    for f, v in ANGLES
]
#: Per edge: the two facets that meet there, the ones opposite its two missing vertices.
WINGS = [tuple(facet for facet in range(4) if facet not in pair) for pair in _PAIRS]


class Shapes:
    """The polynomials behind all measures for one chunk of tets, renumbered by i -> i xor ``base``.

    Vectors are (3, c), scalars (c,), so that every operation runs along contiguous memory.
    """

    def __init__(self, coordinates: Floats, tets: Ints) -> None:
        corners = coordinates[:, tets.T]
        squares = [dot(edge, edge) for edge in _edges(corners)]
        incident = np.empty((4, len(tets)))
        for vertex in range(4):
            incident[vertex] = sum(squares[k] for k, pair in enumerate(_PAIRS) if vertex in pair)
        self.base = np.argmin(incident, axis=0)
        renumbered = np.take_along_axis(tets, HEIGHT_COLUMNS[self.base], axis=1)
        self.origin = coordinates[:, renumbered[:, 0]]
        self.edges = _edges(coordinates[:, renumbered.T])
        self.squares = [dot(edge, edge) for edge in self.edges]
        self.lengths = [np.sqrt(square) for square in self.squares]
        u, v, w = self.edges[:3]
        n1, n2, n3 = _cross(v, w), _cross(w, u), _cross(u, v)
        self.normals = [-(n1 + n2 + n3), n1, n2, n3]
        self.det = dot(u, n1)
        self.q = self.squares[0] * n1 + self.squares[1] * n2 + self.squares[2] * n3
        self.areas = [np.sqrt(dot(normal, normal)) for normal in self.normals]  # twice the facets' areas

    @cached_property
    def normal_sizes(self) -> list[Floats]:
        """N_0 .. N_3 (3, c) with every term replaced by its absolute value."""
        u, v, w = (np.abs(edge) for edge in self.edges[:3])
        sizes = [_cross_sizes(v, w), _cross_sizes(w, u), _cross_sizes(u, v)]
        return [sizes[0] + sizes[1] + sizes[2], *sizes]

    @cached_property
    def det_size(self) -> Floats:
        """The determinant with every term replaced by its absolute value."""
        return dot(np.abs(self.edges[0]), self.normal_sizes[1])

    def heights(self) -> list[Floats]:
        """P_i per facet."""
        first = dot(self.normals[0], self.q) + 2.0 * self.det * self.det
        return [first, *(dot(normal, self.q) for normal in self.normals[1:])]

    def height_bounds(self) -> list[Floats]:
        """Rounding error of P_i per facet."""
        n0, n1, n2, n3 = self.normal_sizes
        q = self.squares[0] * n1 + self.squares[1] * n2 + self.squares[2] * n3
        sizes = [dot(n0, q) + 2.0 * self.det_size * self.det_size, dot(n1, q), dot(n2, q), dot(n3, q)]
        return [_HEIGHT_BOUND * size + _FLOOR for size in sizes]

    def face_dots(self) -> list[Floats]:
        """|a| |b| cos of the twelve face angles, a and b the edges that span them."""
        return [(sign_a * sign_b) * dot(self.edges[a], self.edges[b]) for (a, sign_a), (b, sign_b) in _SPANS]

    def face_bounds(self) -> list[Floats]:
        """Rounding error of :meth:`face_dots`."""
        sizes = [np.abs(edge) for edge in self.edges]
        return [_ANGLE_BOUND * dot(sizes[a], sizes[b]) + _FLOOR for (a, _), (b, _) in _SPANS]

    def dihedral_dots(self) -> list[Floats]:
        """|N_i| |N_j| cos of the six dihedral angles."""
        dots = {(i, j): dot(self.normals[i], self.normals[j]) for i, j in ((1, 2), (1, 3), (2, 3))}
        own = [dot(normal, normal) for normal in self.normals[1:]]
        dots[0, 1] = -(own[0] + dots[1, 2] + dots[1, 3])
        dots[0, 2] = -(dots[1, 2] + own[1] + dots[2, 3])
        dots[0, 3] = -(dots[1, 3] + dots[2, 3] + own[2])
        return [-dots[wings[0], wings[1]] for wings in WINGS]

    def dihedral_bounds(self) -> list[Floats]:
        """Rounding error of :meth:`dihedral_dots`."""
        sizes = self.normal_sizes
        return [_DIHEDRAL_BOUND * dot(sizes[i], sizes[j]) + _FLOOR for i, j in WINGS]

    def radius(self) -> Floats:
        """Circumradius, in the scaled unit."""
        radius: Floats = np.sqrt(dot(self.q, self.q)) / (2.0 * np.abs(self.det))
        return radius

    def shortest(self) -> Floats:
        """Shortest edge, in the scaled unit."""
        shortest: Floats = np.sqrt(np.minimum.reduce(self.squares))
        return shortest


def dot(a: Floats, b: Floats) -> Floats:
    """(c,) of vectors (3, c)."""
    out: Floats = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return out


def _cross(a: Floats, b: Floats) -> Floats:
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _cross_sizes(a: Floats, b: Floats) -> Floats:
    return np.stack([a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]])


def _edges(corners: Floats) -> list[Floats]:
    return [corners[:, q] - corners[:, p] for p, q in _PAIRS]


def in_chunks(points: Floats, tets: Ints) -> tuple[int, Iterator[tuple[slice, Shapes]]]:
    """The exponent of the power of two the points are divided by, and the shapes chunk by chunk."""
    exponent = int(np.frexp(np.abs(points).max(initial=0.0))[1])
    coordinates = np.ascontiguousarray(np.ldexp(points, -exponent).T)

    def walk() -> Iterator[tuple[slice, Shapes]]:
        for start in range(0, len(tets), CHUNK):
            part = slice(start, min(start + CHUNK, len(tets)))
            yield part, Shapes(coordinates, tets[part])

    return exponent, walk()


def restore(rows: list[Floats], columns: Ints, base: Ints) -> Floats:
    """(c, k) from k rows in the renumbered order, back in the tets' own order."""
    out: Floats = np.take_along_axis(np.stack(rows, axis=1), columns[base], axis=1)
    return out
