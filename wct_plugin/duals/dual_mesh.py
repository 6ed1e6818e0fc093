"""The circumcentric dual as polyhedra: a cell per vertex and region, the vertex's Voronoi cell cut off at the boundary.

The faces between two cells are those about an edge, with the circumcenters of the tets round it as corners; at the
boundary they end with the circumcenters of two triangles and the midpoint of the edge. The boundary itself, and every
interface between regions, is tiled: each triangle is in three parts, from its circumcenter and the midpoints of its
edges. A vertex on an interface so has a cell in each region, of one material each; they share its index.

Such cells are what they look like if every dual length is positive, also those from a tet to a triangle of the boundary
or an interface, and these triangles are acute: see :mod:`wct_plugin.measure.duals`. Other meshes are refused.
"""

from dataclasses import dataclass

import numpy as np

from wct_plugin.certify.overlapping_tets import overlap
from wct_plugin.duals.fans import find_fans
from wct_plugin.errors import InputError
from wct_plugin.measure import duals, quality
from wct_plugin.mesh import TetMesh, unit_scaling
from wct_plugin.mesh.index_arrays import components
from wct_plugin.mesh.topology import FACETS, OPPOSITE_EDGES
from wct_plugin.types import Bools, Floats, Ints

#: Cosines of angles of triangles below this are those of right angles, rounded.
_RIGHT = 1e-14


@dataclass(frozen=True, eq=False)
class DualMesh:
    """Polyhedra by their faces: those between two cells first, by owner and neighbour, then the boundary's."""

    points: Floats  #: (p, 3)
    corners: Ints  #: points of the faces, one after the other, counter-clockwise seen from outside their owner
    starts: Ints  #: (f + 1,) where the corners of each face begin
    owner: Ints  #: (f,) cell behind each face
    neighbour: Ints  #: (i,) cell before each face that has one, larger than the owner
    facets: Ints  #: (f - i,) row of the mesh's ``topology.boundary`` that each other face is a part of
    vertex: Ints  #: (c,) vertex of the mesh for each cell, ascending
    region: Ints  #: (c,) region tag of the tets it is in
    volumes: Floats  #: (c,) dual volumes; those of one vertex add up to its own


def make_dual_mesh(mesh: TetMesh) -> DualMesh:
    """Make the dual of a mesh.

    Raises
    ------
    InputError
        Where its cells would be tangled, with counts and the goal that mends it.
    """
    labels, vertex, region = _cells(mesh)
    apart = TetMesh(mesh.points[vertex], labels, mesh.regions)
    _check(mesh, apart)
    points, facet_point, edge_point, vertex_point = _points(mesh)
    between = _about_edges(mesh, apart, facet_point, edge_point)
    walls = _tiles(mesh, labels, mesh.topology.interface_pairs, facet_point, edge_point, vertex_point)
    skin = _tiles(mesh, labels, mesh.topology.boundary_half_facets, facet_point, edge_point, vertex_point)
    inner = _joined(between, walls)
    order = np.lexsort((inner.neighbour, inner.owner))
    faces = _joined(inner.ordered(order), skin)
    return DualMesh(
        points,
        faces.corners,
        np.concatenate([[0], np.cumsum(faces.sizes)]),
        faces.owner,
        inner.neighbour[order],
        np.repeat(np.arange(len(mesh.topology.boundary)), 3),
        vertex,
        region,
        duals.compute_duals(apart).volumes,
    )


@dataclass(frozen=True, eq=False)
class _Faces:
    corners: Ints
    sizes: Ints
    owner: Ints
    neighbour: Ints  #: as long as ``owner``, or empty

    def ordered(self, order: Ints) -> "_Faces":
        starts = np.cumsum(self.sizes) - self.sizes
        sizes = self.sizes[order]
        inside = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
        corners = self.corners[np.repeat(starts[order], sizes) + inside]
        return _Faces(corners, sizes, self.owner[order], self.neighbour[order])


def _joined(one: _Faces, other: _Faces) -> _Faces:
    return _Faces(
        np.concatenate([one.corners, other.corners]),
        np.concatenate([one.sizes, other.sizes]),
        np.concatenate([one.owner, other.owner]),
        np.concatenate([one.neighbour, other.neighbour]),
    )


def _cells(mesh: TetMesh) -> tuple[Ints, Ints, Ints]:
    """(m, 4) the cell at each corner of each tet, and the vertex and region of each cell, ascending.

    A cell is what hangs together round a vertex, through facets inside one region.
    """
    pairs = mesh.topology.interior_pairs
    pairs = pairs[mesh.regions[pairs[:, 0]] == mesh.regions[pairs[:, 2]]]
    rows, columns = [], []
    for k in range(3):
        corner = FACETS[pairs[:, 1], k]
        same = mesh.tets[pairs[:, 2]] == mesh.tets[pairs[:, 0], corner][:, None]
        rows.append(4 * pairs[:, 0] + corner)
        columns.append(4 * pairs[:, 2] + same.argmax(axis=1))
    labels = components(np.concatenate(rows), np.concatenate(columns), 4 * len(mesh.tets))
    _, first = np.unique(labels, return_index=True)
    vertex, region = mesh.tets.ravel()[first], mesh.regions[first // 4]
    order = np.lexsort((region, vertex))
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return rank[labels].reshape(-1, 4), vertex[order], region[order]


def _check(mesh: TetMesh, apart: TetMesh) -> None:
    """Raise :class:`InputError` unless the cells are embedded; ``apart`` has every region by itself."""
    lengths, errors = duals.dual_lengths(apart)
    positive = lengths > errors
    inner = len(apart.topology.interior_pairs)
    blunt = ~_acute(apart.points[apart.topology.boundary])
    counts = {
        "facets inside whose dual edge is not positive": int((~positive[:inner]).sum()),
        "facets of the boundary or an interface that lie before the circumcenter of their tet": int(
            (~positive[inner:]).sum()
        ),
        "triangles of the boundary or an interface that are not acute": int(blunt.sum()),
    }
    who = mesh.source or "the mesh"
    if any(counts.values()):
        said = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
        goal = "cwc" if blunt.any() else "3wc"
        raise InputError(f"{who}: its dual cells are tangled: {said}; goal {goal} of meshing_well_centered mends this")
    if tangled := overlap(mesh):
        raise InputError(f"{who}: its dual cells are tangled: tets {tangled[0]} and {tangled[1]} overlap")


def _acute(triangles: Floats) -> Bools:
    """(k,) whether every angle of each triangle is less than a right one."""
    edges = np.roll(triangles, -1, axis=1) - triangles
    units = edges / np.linalg.norm(edges, axis=2, keepdims=True)
    acute: Bools = (np.einsum("kci,kci->kc", units, np.roll(units, -1, axis=1)) < -_RIGHT).all(axis=1)
    return acute


def _points(mesh: TetMesh) -> tuple[Floats, Ints, Ints, Ints]:
    """The points of the dual, and which is that of each facet, edge and vertex of the boundary and interfaces.

    The circumcenters of the tets come first, then those of the triangles, the midpoints and the vertices.
    """
    topology = mesh.topology
    pairs, walls = topology.interior_pairs, topology.interface_pairs
    border = np.arange(len(pairs), len(topology.facets))
    facets = np.concatenate([topology.tet_facets[walls[:, 0], walls[:, 1]], border])
    edges = np.unique(topology.facet_edges[facets])
    vertices = np.unique(topology.facets[facets])
    unit = unit_scaling.exponent(mesh.points)
    places = unit_scaling.rescaled(mesh.points, -unit)
    parts = [
        quality.circumcenters(places, mesh.tets),
        _triangle_centers(places[np.sort(topology.facets[facets], axis=1)]),
        places[topology.edges[edges]].mean(axis=1),
        places[vertices],
    ]
    numbers, begin = [], len(mesh.tets)
    for chosen, count in (
        (facets, len(topology.facets)),
        (edges, len(topology.edges)),
        (vertices, len(mesh.points)),
    ):
        table = np.full(count, -1)
        table[chosen] = begin + np.arange(len(chosen))
        numbers.append(table)
        begin += len(chosen)
    return unit_scaling.rescaled(np.concatenate(parts), unit), numbers[0], numbers[1], numbers[2]


def _triangle_centers(triangles: Floats) -> Floats:
    """(k, 3) circumcenters: weights sin 2α at the corners, here as a² (b² + c² - a²)."""
    edges = np.roll(triangles, -2, axis=1) - np.roll(triangles, -1, axis=1)  # opposite each corner
    squares = np.einsum("kci,kci->kc", edges, edges)
    weights = squares * (squares.sum(axis=1, keepdims=True) - 2.0 * squares)
    weights /= weights.sum(axis=1, keepdims=True)
    # From the first corner, so that coordinates far from zero cost no digits.
    centers: Floats = triangles[:, 0] + np.einsum("kc,kci->ki", weights, triangles - triangles[:, :1])
    return centers


def _about_edges(mesh: TetMesh, apart: TetMesh, facet_point: Ints, edge_point: Ints) -> _Faces:
    """The faces between cells of two vertices of one region."""
    fans = find_fans(apart)
    topology = mesh.topology
    sizes = np.where(fans.closed, fans.sizes, fans.sizes + 3)
    starts = np.cumsum(sizes) - sizes
    corners = np.empty(sizes.sum(), dtype=np.int64)
    inside = np.arange(len(fans.wedges)) - np.repeat(np.cumsum(fans.sizes) - fans.sizes, fans.sizes)
    tets = fans.wedges // 6
    corners[np.repeat(starts + ~fans.closed, fans.sizes) + inside] = tets
    # The facets and edges of the mesh that those of the separate regions are: tets and their corners are the same.
    of_facet = np.empty(len(apart.topology.facets), dtype=np.int64)
    of_facet[apart.topology.tet_facets] = topology.tet_facets
    of_edge = np.empty(len(apart.topology.edges), dtype=np.int64)
    of_edge[apart.topology.tet_edges] = topology.tet_edges
    ends = ~fans.closed
    corners[starts[ends]] = facet_point[of_facet[fans.enter[ends]]]
    corners[starts[ends] + fans.sizes[ends] + 1] = facet_point[of_facet[fans.leave[ends]]]
    corners[starts[ends] + fans.sizes[ends] + 2] = edge_point[of_edge[fans.edges[ends]]]
    owner, neighbour = apart.topology.edges[fans.edges].T
    return _Faces(corners, sizes, owner, neighbour)


def _tiles(
    mesh: TetMesh, labels: Ints, half_facets: Ints, facet_point: Ints, edge_point: Ints, vertex_point: Ints
) -> _Faces:
    """Three faces per facet, out of its tet; with the tet and facet beyond, into the cells there."""
    tet, local = half_facets[:, 0], half_facets[:, 1]
    corner = FACETS[local]
    across = mesh.topology.tet_edges[tet[:, None], OPPOSITE_EDGES.reshape(4, 3)[local]]  # opposite each corner
    vertices = mesh.tets[tet[:, None], corner]
    center = np.broadcast_to(facet_point[mesh.topology.tet_facets[tet, local]][:, None], corner.shape)
    tiles = np.stack(
        [
            vertex_point[vertices],
            edge_point[np.roll(across, -2, axis=1)],  # to the next corner
            center,
            edge_point[np.roll(across, -1, axis=1)],
        ],
        axis=2,
    ).reshape(-1, 4)
    owner = labels[tet[:, None], corner].ravel()
    neighbour = np.empty(0, dtype=np.int64)
    if half_facets.shape[1] == 4:
        beyond = half_facets[:, 2]
        place = (mesh.tets[beyond][:, None, :] == vertices[:, :, None]).argmax(axis=2)
        neighbour = labels[beyond[:, None], place].ravel()
        turned = owner > neighbour
        tiles[turned] = tiles[turned][:, ::-1]
        owner, neighbour = np.minimum(owner, neighbour), np.maximum(owner, neighbour)
    return _Faces(tiles.ravel(), np.full(len(tiles), 4), owner, neighbour)
