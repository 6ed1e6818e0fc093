"""The circumcentric dual: signed dual lengths, areas and volumes, Hodge star diagonals, and the tier of a mesh.

Everything is summed from orthoschemes, the tets vertex - edge midpoint - facet circumcenter - tet circumcenter, with
signs: negative where a circumcenter lies on the far side of its face. Per tet, with h the circumcenter's height over
a facet, l an edge of that facet and gamma the facet's angle opposite the edge, the facet's circumcenter is at distance
l cot(gamma) / 2 from the edge, so the orthoscheme at either end of the edge has volume l^2 cot(gamma) h / 24 and its
dual face area l cot(gamma) h / 4.

Signs as in Hirani, Kalyanaraman and VanderZee, "Delaunay Hodge star", Computer-Aided Design 45 (2013): in a mesh that
is pairwise Delaunay, and one-sided at its boundary, all signed duals are positive.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wct_plugin import quality
from wct_plugin.mesh import TetMesh
from wct_plugin.quality import Quality
from wct_plugin.topology import EDGES, FACETS

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Names of the tiers, each implying those before it; :attr:`Tiers.reached` is an index into them.
TIERS = ("valid", "Delaunay", "one-sided", "3WC", "CWC")
#: Circumcenters this much the wrong way round, as a fraction of their mean circumradius, still count as Delaunay.
COSPHERICAL = 1e-9

#: Per face angle column (facet, vertex): the edge of the facet opposite that vertex, as a row of EDGES.
_PAIRS = [[int(p), int(q)] for p, q in EDGES]
_OPPOSITE = np.array([_PAIRS.index(sorted(int(x) for x in FACETS[f] if x != v)) for f in range(4) for v in FACETS[f]])


@dataclass(frozen=True, eq=False)
class Duals:
    """Signed measures of the dual cells, in the mesh's own unit, its square and its cube."""

    lengths: Floats  #: (f,) dual edge per facet: interior facets as ``topology.interior_pairs``, then the boundary's
    errors: Floats  #: (f,) bound of the rounding error of ``lengths``; infinite where nothing is known
    areas: Floats  #: (e,) dual face per row of ``topology.edges``
    volumes: Floats  #: (n,) dual cell per vertex; they sum to the volume of the mesh


@dataclass(frozen=True)
class Tiers:
    """How far up the ladder a mesh is; every step implies those below it."""

    delaunay: bool  #: no vertex inside the circumsphere of a facet's two tets; cospherical ties count as Delaunay
    one_sided: bool  #: every signed dual length, area and volume strictly positive; cospherical ties fail this
    well_centered_3: bool  #: every tet contains its circumcenter
    completely_well_centered: bool  #: and every triangle is acute

    @property
    def reached(self) -> int:
        """Index of the highest tier into :data:`TIERS`; a :class:`TetMesh` is always valid."""
        return sum((self.delaunay, self.one_sided, self.well_centered_3, self.completely_well_centered))

    @property
    def name(self) -> str:
        """Name of the highest tier."""
        return TIERS[self.reached]


def dual_lengths(mesh: TetMesh) -> tuple[Floats, Floats]:
    """Signed dual edge per facet (f,) and a bound of its rounding error (f,), infinite where nothing is known.

    Interior facets as in ``topology.interior_pairs``: h+ + h-. Then the boundary's, as in ``topology.boundary``: h.
    """
    return _dual_lengths(mesh, *quality.heights(mesh.points, mesh.tets))


def duals(mesh: TetMesh) -> Duals:
    """Dual lengths, areas and volumes of a mesh."""
    points, tets, topology = mesh.points, mesh.tets, mesh.topology
    heights, errors = quality.heights(points, tets)
    cotangents = quality.face_cotangents(points, tets)
    edges = points[topology.edges]
    squares = np.einsum("eki,eki->e", *[edges[:, 1:] - edges[:, :1]] * 2)
    edge_of = _tet_edges(mesh)

    # Twice 12 orthoschemes per tet: one at either end of each edge of each facet; an edge is in two facets.
    per_edge = np.zeros((len(tets), 6))
    with np.errstate(invalid="ignore", over="ignore"):
        for column, edge in enumerate(_OPPOSITE):
            per_edge[:, edge] += cotangents[:, column] * heights[:, column // 3]
    sums = np.bincount(edge_of.ravel(), per_edge.ravel(), minlength=len(squares))
    areas = sums * np.sqrt(squares) / 4.0
    halves = np.repeat(sums * squares / 24.0, 2)
    volumes = np.bincount(topology.edges.ravel(), halves, minlength=len(points)).astype(np.float64)
    return Duals(*_dual_lengths(mesh, heights, errors), areas, volumes)


def hodge_star(mesh: TetMesh, k: int, of: Duals | None = None) -> Floats:
    """Diagonal of the discrete Hodge star on primal ``k``-forms: dual over primal measure, k = 0 .. 3.

    k = 0: dual volume per vertex (n,). k = 1: dual area over length per row of ``topology.edges`` (e,). k = 2: dual
    length over area per facet (f,), interior facets first, as in :attr:`Duals.lengths`. k = 3: 1 / volume per tet
    (m,). Pass ``of`` where :func:`duals` has been called already. Raises :class:`ValueError` for another k.
    """
    if k == 3:
        return 1.0 / quality.volumes(mesh.points, mesh.tets)
    of = duals(mesh) if of is None else of
    if k == 0:
        return of.volumes
    if k == 1:
        ends = mesh.points[mesh.topology.edges]
        areas: Floats = of.areas / np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        return areas
    if k == 2:
        half_facets = np.concatenate([mesh.topology.interior_pairs[:, :2], mesh.topology.boundary_half_facets])
        corners = mesh.points[mesh.tets[half_facets[:, :1], FACETS[half_facets[:, 1]]]]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths: Floats = 2.0 * of.lengths / np.linalg.norm(normals, axis=1)
        return lengths
    raise ValueError(f"k is {k}; a tetrahedral mesh has forms of degree 0, 1, 2 and 3")


def tiers(mesh: TetMesh, of: Quality | None = None) -> Tiers:
    """The tier of a mesh; pass ``of`` where :func:`wct_plugin.quality.measure` has been called already.

    Delaunay: across every interior facet, whatever the regions, the two heights of the circumcenters add up to
    h+ + h- >= -t. The tolerance t is 1e-9 of the two circumradii's mean plus the sum's own rounding error, so that
    cospherical points, for which the sum is exactly zero (a Cartesian grid, also one that was rotated and rounded),
    count as Delaunay. They have a dual edge of length zero and so are never one-sided.

    One-sided: every dual length, the boundary's included, exceeds its rounding error, and all dual areas and volumes
    are positive. 3WC and CWC: every tet has the flag. 3WC makes all heights positive, hence the mesh one-sided.
    """
    of = quality.measure(mesh) if of is None else of
    well_centered_3 = bool(of.well_centered_3.all())
    completely = bool(of.completely_well_centered.all())
    if well_centered_3:
        return Tiers(True, True, True, completely)
    lengths, errors = dual_lengths(mesh)
    if (lengths > errors).all():
        dual = duals(mesh)
        return Tiers(True, bool((dual.areas > 0.0).all() and (dual.volumes > 0.0).all()), False, False)
    return Tiers(not _encroached(mesh, lengths, errors).any(), False, False, False)


def misses(mesh: TetMesh, of: Quality, *, one_sided: bool) -> Bools:
    """(m,) the tets that keep a mesh from being Delaunay or, if asked for, one-sided, as :func:`tiers` has them.

    Those at a facet, an edge or a vertex whose dual length, area or volume is not as it should be.
    """
    reached, topology = tiers(mesh, of), mesh.topology
    missing = np.zeros(len(mesh.tets), dtype=bool)
    if reached.one_sided or (reached.delaunay and not one_sided):
        return missing
    pairs = topology.interior_pairs
    dual = duals(mesh)
    if not one_sided:
        missing[pairs[_encroached(mesh, dual.lengths, dual.errors)][:, ::2]] = True
        return missing
    wrong = ~(dual.lengths > dual.errors)
    missing[pairs[wrong[: len(pairs)]][:, ::2]] = True
    missing[topology.boundary_half_facets[wrong[len(pairs) :], 0]] = True
    at_edge, at_vertex = ~(dual.areas > 0.0)[_tet_edges(mesh)], ~(dual.volumes > 0.0)[mesh.tets]
    return missing | at_edge.any(axis=1) | at_vertex.any(axis=1)


def _encroached(mesh: TetMesh, lengths: Floats, errors: Floats) -> Bools:
    """Per interior facet whether a vertex beyond it lies inside the sphere of the tet before it, ties left out."""
    pairs = mesh.topology.interior_pairs
    radii = quality.circumradii(mesh.points, mesh.tets)
    slack = COSPHERICAL * (radii[pairs[:, 0]] + radii[pairs[:, 2]]) / 2.0 + errors[: len(pairs)]
    inside: Bools = ~(lengths[: len(pairs)] >= -slack)
    return inside


def _dual_lengths(mesh: TetMesh, heights: Floats, errors: Floats) -> tuple[Floats, Floats]:
    pairs, border = mesh.topology.interior_pairs, mesh.topology.boundary_half_facets
    lengths, bounds = (
        np.concatenate(
            [table[pairs[:, 0], pairs[:, 1]] + table[pairs[:, 2], pairs[:, 3]], table[border[:, 0], border[:, 1]]]
        )
        for table in (heights, errors)
    )
    return lengths, bounds


def _tet_edges(mesh: TetMesh) -> Ints:
    """(m, 6) the row of ``topology.edges`` for each edge of each tet."""
    count = len(mesh.points)
    ends = np.sort(mesh.tets[:, EDGES], axis=2)
    return np.searchsorted(mesh.topology.edges @ [count, 1], ends @ [count, 1])
