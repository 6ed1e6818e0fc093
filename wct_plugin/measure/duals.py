"""The circumcentric dual: signed dual lengths, areas and volumes, Hodge star diagonals, and the tier of a mesh.

Everything is summed from orthoschemes, the tets vertex - edge midpoint - facet circumcenter - tet circumcenter, with
signs: negative where a circumcenter lies on the far side of its face. Per tet, with h the circumcenter's height over
a facet, l an edge of that facet and gamma the facet's angle opposite the edge, the facet's circumcenter is at distance
l cot(gamma) / 2 from the edge, so the orthoscheme at either end of the edge has volume l^2 cot(gamma) h / 24 and its
dual face area l cot(gamma) h / 4.

Signs as in Hirani, Kalyanaraman and VanderZee, "Delaunay Hodge star", Computer-Aided Design 45 (2013). In a mesh that
is pairwise Delaunay, and one-sided at its boundary, the dual of every interior vertex, edge and facet is a convex cell
with positive measure, and so are those on the boundary if its triangles are acute. If one is obtuse, its circumcenter
lies beyond the longest edge, and the dual area of that edge may be negative even where all tets contain theirs: the
tet (-0.88, 0.42, -0.22), (-0.51, 0.74, -0.45), (-0.06, 0.97, -0.23), (0.67, -0.67, 0.32) has one of -0.129.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wct_plugin.certify.overlapping_tets import overlap
from wct_plugin.core import _core
from wct_plugin.errors import InputError
from wct_plugin.measure import compiled_quality, orthocenters, quality
from wct_plugin.measure.quality import Quality
from wct_plugin.mesh import TetMesh, region_parts, unit_scaling
from wct_plugin.mesh.topology import OPPOSITE_EDGES
from wct_plugin.types import Bools, Floats

#: Names of the tiers, each implying those before it; :attr:`Tiers.reached` is an index into them.
TIERS = ("valid", "Delaunay", "one-sided", "3WC", "CWC")
#: What stands in place of a tier where tets overlap.
NOT_VALID = "not valid"
#: Circumcenters this much the wrong way round, as a fraction of their mean circumradius, still count as Delaunay.
COSPHERICAL = 1e-9

#: Rounding error of a cotangent over 1 + its square; see the module ``quality``, whose bound of the dot product is 6.
_EPS = 16.0 * 2.0**-53


@dataclass(frozen=True, eq=False)
class Duals:
    """Signed measures of the dual cells, in the mesh's own unit, its square and its cube.

    Each with a bound of its rounding error, to first order; infinite where nothing is known, in a sliver.
    """

    lengths: Floats  #: (f,) dual edge per row of ``topology.facets``: interior facets, then the boundary's
    errors: Floats  #: (f,) of ``lengths``
    areas: Floats  #: (e,) dual face per row of ``topology.edges``
    area_errors: Floats  #: (e,)
    volumes: Floats  #: (n,) dual cell per vertex; they sum to the volume of the mesh
    volume_errors: Floats  #: (n,)


@dataclass(frozen=True)
class Tiers:
    """How far up the ladder a mesh is; every step implies those below it, in a valid mesh."""

    valid: bool  #: no two tets overlap; where some do, what is below says nothing
    delaunay: bool  #: no vertex inside the circumsphere of a facet's two tets; cospherical ties count as Delaunay
    one_sided: bool  #: every signed dual length of each region by itself strictly positive; cospherical ties fail this
    well_centered_3: bool  #: every tet contains its circumcenter
    completely_well_centered: bool  #: and every triangle is acute

    @property
    def reached(self) -> int:
        """Index of the highest tier into :data:`TIERS`; -1 for a mesh that is not valid."""
        if not self.valid:
            return -1
        return sum((self.delaunay, self.one_sided, self.well_centered_3, self.completely_well_centered))

    @property
    def name(self) -> str:
        """Name of the highest tier, or :data:`NOT_VALID`."""
        return TIERS[self.reached] if self.valid else NOT_VALID


def dual_lengths(mesh: TetMesh) -> tuple[Floats, Floats]:
    """Signed dual edge per facet (f,) and a bound of its rounding error (f,), infinite where nothing is known.

    Interior facets as in ``topology.interior_pairs``: h+ + h-. Then the boundary's, as in ``topology.boundary``: h.
    """
    heights, errors = compiled_quality.heights(mesh.points, mesh.tets)
    return _per_facet(mesh, heights), _per_facet(mesh, errors)


def compute_duals(mesh: TetMesh, weights: Floats | None = None, coefficient: Floats | None = None) -> Duals:
    """Dual lengths, areas and volumes of a mesh, the cells of boundary vertices, edges and facets cut off there.

    ``weights`` (n,), of the unit of length squared, give the power dual instead, whose cells are made of orthocenters
    where the circumcentric ones are made of circumcenters. ``coefficient`` (m,) is a material per tet that each tet's
    own part of a dual cell is multiplied with: permittivity for areas, 1 / permeability for lengths, density for
    volumes; nothing is averaged across an interface.
    """
    points, tets, topology = mesh.points, mesh.tets, mesh.topology
    for name, given, count in (("weights", weights, len(points)), ("coefficient", coefficient, len(tets))):
        if given is not None and given.shape != (count,):
            raise InputError(f"{name} have shape {given.shape}; allowed is ({count},)")
    if coefficient is not None:
        coefficient = np.ascontiguousarray(coefficient, dtype=np.float64)
    squares = _squared_lengths(mesh)
    if weights is None:
        shares = np.full((len(squares), 2), 0.5)
        heights, errors, sums, doubts = _core.dual_edge_sums(
            points, tets, topology.tet_edges, len(squares), coefficient
        )
    else:
        difference = (weights[topology.edges[:, 0]] - weights[topology.edges[:, 1]]) / squares
        shares = 0.5 + 0.5 * np.stack([difference, -difference], axis=1)
        heights, errors, sums, doubts = _power_sums(mesh, squares, weights, coefficient)
    lengths, bounds = (_per_facet(mesh, table) for table in (heights, errors))
    volumes, volume_errors = (
        _summed(topology.edges, each[:, None] * ends, len(points))
        for each, ends in ((sums * squares / 12.0, shares), (doubts * squares / 12.0, np.abs(shares)))
    )
    size = np.sqrt(squares) / 4.0
    return Duals(lengths, bounds, sums * size, doubts * size, volumes, volume_errors)


def _power_sums(
    mesh: TetMesh, squares: Floats, weights: Floats, coefficient: Floats | None
) -> tuple[Floats, Floats, Floats, Floats]:
    """Heights (m, 4) and sums per edge (e,) of orthocenters, each with its bound; see the core's ``dual_edge_sums``."""
    edge_of = mesh.topology.tet_edges
    heights, errors, cotangents = quality.heights_and_cotangents(mesh.points, mesh.tets)
    heights, errors = orthocenters.shift_heights(mesh.points, mesh.tets, heights, errors, weights)
    cotangents = orthocenters.shift_cotangents(mesh.tets, cotangents, squares[edge_of], weights)
    if coefficient is not None:
        heights, errors = heights * coefficient[:, None], errors * np.abs(coefficient)[:, None]
    # Twice 12 orthoschemes per tet: one at either end of each edge of each facet; an edge is in two facets.
    per_edge, doubt = np.zeros((2, len(mesh.tets), 6))
    with np.errstate(invalid="ignore", over="ignore"):
        for column, (facet, edge) in enumerate(zip(np.arange(12) // 3, OPPOSITE_EDGES, strict=True)):
            cotangent, height = cotangents[:, column], heights[:, facet]
            per_edge[:, edge] += cotangent * height
            doubt[:, edge] += np.abs(cotangent) * errors[:, facet] + _EPS * (1.0 + cotangent**2) * np.abs(height)
    doubt[np.isnan(doubt)] = np.inf
    sums, doubts = (_summed(edge_of, table, len(squares)) for table in (per_edge, doubt))
    return heights, errors, sums, doubts


def hodge_star(mesh: TetMesh, k: int, of: Duals | None = None) -> Floats:
    """Diagonal of the discrete Hodge star on primal ``k``-forms: dual over primal measure, k = 0 .. 3.

    k = 0: dual volume per vertex (n,). k = 1: dual area over length per row of ``topology.edges`` (e,). k = 2: dual
    length over area per row of ``topology.facets`` (f,). k = 3: 1 / volume per tet (m,). Pass ``of`` where
    :func:`compute_duals` has been called already, or with weights or a coefficient; k = 3 has neither. The matrices
    between the degrees are in :mod:`wct_plugin.measure.exterior`. Raises :class:`ValueError` for another k.
    """
    if k == 3:
        return 1.0 / compiled_quality.volumes(mesh.points, mesh.tets)
    of = compute_duals(mesh) if of is None else of
    if k == 0:
        return of.volumes
    if k == 1:
        ends = mesh.points[mesh.topology.edges]
        areas: Floats = of.areas / np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        return areas
    if k == 2:
        unit = unit_scaling.exponent(mesh.points)
        coordinates = unit_scaling.rescaled(mesh.points, -unit).T
        first, second, third = (coordinates[:, corners] for corners in mesh.topology.facets.T)
        normals = np.cross(second - first, third - first, axis=0)  # along the long axis: a quarter of the time
        areas_doubled = unit_scaling.rescaled(np.sqrt(np.einsum("kf,kf->f", normals, normals)), 2 * unit)
        lengths: Floats = 2.0 * of.lengths / areas_doubled
        return lengths
    raise ValueError(f"k is {k}; a tetrahedral mesh has forms of degree 0, 1, 2 and 3")


def shortest_lengths(mesh: TetMesh, lengths: Floats) -> Floats:
    """(m,) the least of the dual ``lengths`` (f,) of each tet's four facets."""
    shortest: Floats = lengths[mesh.topology.tet_facets].min(axis=1)
    return shortest


def tiers(mesh: TetMesh, of: Quality | None = None) -> Tiers:
    """The tier of a mesh; pass ``of`` where :func:`wct_plugin.measure.compiled_quality.measure` was called already.

    Valid: all volumes are positive, as :class:`TetMesh` makes sure, and no two tets overlap, both decided exactly.

    Delaunay: across every interior facet, whatever the regions, the two heights of the circumcenters add up to
    h+ + h- >= -t. The tolerance t is 1e-9 of the two circumradii's mean plus the sum's own rounding error, so that
    cospherical points, for which the sum is exactly zero (a Cartesian grid, also one that was rotated and rounded),
    count as Delaunay. They have a dual edge of length zero and so are never one-sided.

    One-sided: every dual length of every region by itself, those at its boundary included, exceeds its rounding error:
    circumcenters are on their own side of interfaces. All duals inside a region are positive then, see the top of this
    module. 3WC and CWC: every tet has the flag. 3WC makes all heights positive, hence the
    mesh one-sided, CWC all duals of it positive. :mod:`wct_plugin.measure.negative_duals` counts those that are not.

    Raises :class:`wct_plugin.errors.InputError` where three or more tets share a facet.
    """
    of = compiled_quality.measure(mesh) if of is None else of
    well_centered_3 = bool(of.well_centered_3.all())
    completely = bool(of.completely_well_centered.all())
    valid = overlap(mesh) is None
    if well_centered_3:
        return Tiers(valid, True, True, True, completely)
    parts = region_parts.apart(mesh)
    tables = compiled_quality.heights(mesh.points, mesh.tets)  # of the tets, which are the same in the parts
    lengths, errors = (_per_facet(parts, table) for table in tables)
    if (lengths > errors).all():
        return Tiers(valid, True, True, False, False)
    lengths, errors = (_per_facet(mesh, table) for table in tables)
    return Tiers(valid, not _encroached(mesh, lengths, errors).any(), False, False, False)


def misses(mesh: TetMesh, of: Quality, *, one_sided: bool) -> Bools:
    """(m,) the tets that keep a mesh from being Delaunay, as :func:`tiers` has it, or from duals that are all positive.

    The latter is more than one-sided at the boundary: dual areas and volumes count, too, those of each region by
    itself. They are those at a facet, an edge or a vertex whose dual length, area or volume is not as it should be,
    beyond rounding. Where a mesh has several regions, Delaunay asks of each that no dual length or area is negative,
    ties left out: a solver's couplings across an edge add up region by region.
    """
    missing = np.zeros(len(mesh.tets), dtype=bool)
    if of.completely_well_centered.all():
        return missing
    parts = region_parts.apart(mesh)
    if not one_sided:
        if not of.well_centered_3.all():
            pairs = mesh.topology.interior_pairs
            missing[pairs[_encroached(mesh, *dual_lengths(mesh))][:, ::2]] = True
        return missing if parts is mesh else missing | _of_tets(parts, *negative(parts, compute_duals(parts)))
    dual = compute_duals(parts)
    at_facet, at_edge, at_vertex = (
        ~(dual.lengths > dual.errors),
        ~(dual.areas > dual.area_errors),
        ~(dual.volumes > dual.volume_errors),
    )
    missing |= _of_tets(parts, at_facet, at_edge) | at_vertex[parts.tets].any(axis=1)
    return missing


def _of_tets(mesh: TetMesh, at_facet: Bools, at_edge: Bools) -> Bools:
    """(m,) the tets at any of the facets (f,) and edges (e,)."""
    table = np.concatenate([at_facet[mesh.topology.tet_facets], at_edge[mesh.topology.tet_edges]], axis=1)
    found: Bools = np.logical_or.reduce(table, axis=1)
    return found


def negative(mesh: TetMesh, dual: Duals) -> tuple[Bools, Bools]:
    """Per facet (f,) and edge (e,) whether its dual is shorter or smaller than nothing, ties left out."""
    radii = compiled_quality.circumradii(mesh.points, mesh.tets)
    pairs, single = mesh.topology.half_facets
    radius = np.concatenate([np.maximum(radii[pairs[:, 0] >> 2], radii[pairs[:, 1] >> 2]), radii[single >> 2]])
    squares = _squared_lengths(mesh)
    return dual.lengths < -dual.errors - COSPHERICAL * radius, dual.areas < -dual.area_errors - COSPHERICAL * squares


def _encroached(mesh: TetMesh, lengths: Floats, errors: Floats) -> Bools:
    """Per interior facet whether a vertex beyond it lies inside the sphere of the tet before it, ties left out."""
    pairs = mesh.topology.interior_pairs
    radii = compiled_quality.circumradii(mesh.points, mesh.tets)
    slack = COSPHERICAL * (radii[pairs[:, 0]] + radii[pairs[:, 2]]) / 2.0 + errors[: len(pairs)]
    inside: Bools = ~(lengths[: len(pairs)] >= -slack)
    return inside


def _squared_lengths(mesh: TetMesh) -> Floats:
    """(e,) of the edges."""
    start, end = np.ascontiguousarray(mesh.topology.edges.T)
    squares = np.zeros(len(start))
    for values in np.ascontiguousarray(mesh.points.T):  # axis by axis: a third of the time
        squares += np.square(values[end] - values[start])
    return squares


def _summed(places: NDArray[np.int64], values: Floats, count: int) -> Floats:
    return np.bincount(places.ravel(), values.ravel(), count).astype(np.float64)


def _per_facet(mesh: TetMesh, table: Floats) -> Floats:
    """(f,) per row of ``topology.facets`` the sum over its one or two tets of ``table`` (m, 4)."""
    pairs, single = mesh.topology.half_facets
    flat = table.reshape(-1)
    return np.concatenate([flat[pairs[:, 0]] + flat[pairs[:, 1]], flat[single]])
