"""The surfaces inside and around a mesh: patches, creases and corners."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wct_plugin.mesh import unit_scaling
from wct_plugin.mesh.index_arrays import components, distinct_rows, find_rows
from wct_plugin.mesh.mesh import Cells, SurfaceMesh, TetMesh
from wct_plugin.mesh.topology import FACETS
from wct_plugin.mesh.triangle_surfaces import (
    angle_between,
    bend_angles,
    on_several_sheets,
    sheets_of_edges,
    surface_edges,
    turned_triangles,
)
from wct_plugin.types import Bools, Floats, Ints

#: Names of the values of :attr:`Strata.stratum` and of :func:`places_of`.
PLACES = ("interior", "boundary", "crease", "corner")
#: A crease that turns by more than this at a vertex, in degrees, has a corner there.
CORNER_TURN = 45.0
#: A sharp crease with a free end is noise of the tessellation if it is shorter than this many local edge lengths.
DANGLING = 4.0
#: Sharp creases round up to so many triangles inside one patch are noise too: no shape has so few on its side.
SPECK = 4


@dataclass(frozen=True, eq=False)
class Strata:
    """What a vertex may do: move freely, on its patch, along its curve, or not at all.

    The surface is the boundary, the interfaces between regions and the tagged facets inside a region.
    """

    triangles: Ints
    """(t, 3) boundary (outward), then interfaces, then tagged facets inside a region; a patch's all wind alike"""
    turned: Bools  #: (t,) of the triangles that wind the other way in :func:`labelled_surface`
    patch: Ints  #: (t,) patch id of each triangle, from 0
    segments: Ints  #: (s, 2) crease edges, ends ascending
    curve: Ints  #: (s,) curve id of each segment, from 0; a closed loop without corners is one curve
    soft: Bools  #: (s,) segments that only their angle makes creases
    stratum: NDArray[np.int8]  #: (n,) 0 interior, 1 patch, 2 crease, 3 corner: see :data:`PLACES`
    label: Ints  #: (n,) patch id of a patch point, curve id of a crease point, -1 otherwise

    @property
    def soft_curves(self) -> Ints:
        """Curves that only their angle makes creases, all along."""
        return np.setdiff1d(self.curve, self.curve[~self.soft])


def find_strata(mesh: TetMesh, crease_angle: float = 40.0) -> Strata:
    """Patches, crease curves and corners of a mesh.

    A crease is an edge where the surface bends by more than ``crease_angle`` degrees, where other than two surface
    triangles meet, where facet tags, facet sets or the regions on either side change, or that is tagged itself
    (``mesh.edges``, inside the mesh too). Short dangling creases, and rims of one to four triangles inside a patch,
    that only their angle makes are dropped: they are noise of the tessellation. A corner is a crease vertex where
    other than two creases meet or the crease turns by more than 45 degrees, where the tags of tagged edges change, a
    tagged vertex (``mesh.nodes``), or a vertex where sheets of the surface touch that share no edge.
    """
    return _strata(mesh.points, *labelled_surface(mesh), *_user_edges(mesh), mesh.nodes.vertices.ravel(), crease_angle)


def surface_strata(surface: SurfaceMesh, crease_angle: float = 40.0) -> Strata:
    """Patches, crease curves and corners of a surface by itself, by the same rules; its tags are its facets' tags."""
    nothing = np.empty(0, dtype=np.int64)
    return _strata(
        surface.points, surface.triangles, surface.tags, nothing.reshape(0, 2), nothing, nothing, crease_angle
    )


def _strata(
    points: Floats,
    triangles: Ints,
    signature: Ints,
    user: Ints,
    user_signature: Ints,
    nodes: Ints,
    crease_angle: float,
) -> Strata:
    points, count = unit_scaling.normalized(points), len(points)
    edges, owners, starts, sizes, forward = surface_edges(triangles, count)

    first, second = owners[starts], owners[starts + sizes - 1]
    paired = sizes == 2
    hard = ~paired | (signature[first] != signature[second])
    same_way = forward[starts] == forward[starts + sizes - 1]
    bend = bend_angles(points, triangles, first, second, same_way)
    sharp = paired & (bend > np.radians(crease_angle))
    edge_keys, user_keys = edges @ [count, 1], user @ [count, 1]
    hard |= np.isin(edge_keys, user_keys)
    loose = ~np.isin(user_keys, edge_keys)  # tagged edges away from every surface

    pinned = on_several_sheets(triangles, sheets_of_edges(triangles, owners, starts, sizes, edges), count)
    pinned[nodes] = True
    crease = hard | sharp
    size = _local_size(points, edges)
    while True:  # a speck may be the end of a crease, and hide another speck
        crease[crease] = _without_dangling(points, edges[crease], hard[crease], pinned, size)
        specks = _speck_rims(first, second, paired, crease, hard, len(triangles))
        if not specks.any():
            break
        crease &= ~specks
    segments = np.concatenate([edges[crease], user[loose]])
    soft = np.concatenate([~hard[crease], np.zeros(int(loose.sum()), dtype=bool)])
    segment_keys = segments @ [count, 1]
    order = np.argsort(segment_keys)
    segments, segment_keys, soft = segments[order], segment_keys[order], soft[order]

    tag = np.full(len(segments), -1, dtype=np.int64)
    tag[np.searchsorted(segment_keys, user_keys)] = user_signature
    corner = _corners(points, segments, tag) | pinned
    curve = _chains(segments, corner, count)

    smooth = paired & ~crease
    patch = components(first[smooth], second[smooth], len(triangles))
    turned = turned_triangles(first[smooth], second[smooth], same_way[smooth], patch)
    triangles = np.where(turned[:, None], triangles[:, ::-1], triangles)
    stratum = np.zeros(count, dtype=np.int8)
    label = np.full(count, -1, dtype=np.int64)
    stratum[triangles] = 1
    label[triangles] = patch[:, None]
    stratum[segments] = 2
    label[segments] = curve[:, None]
    stratum[corner] = 3
    label[corner] = -1
    for values in (triangles, turned, patch, segments, curve, soft, stratum, label):
        values.setflags(write=False)
    return Strata(triangles, turned, patch, segments, curve, soft, stratum, label)


def places_of(mesh: TetMesh, of: Strata) -> NDArray[np.int8]:
    """(m,) where each tet sits: the highest stratum among its vertices, an index into :data:`PLACES`."""
    places: NDArray[np.int8] = of.stratum[mesh.tets].max(axis=1)
    return places


def labelled_surface(mesh: TetMesh) -> tuple[Ints, Ints]:
    """All triangles of :class:`Strata`, and a label that is equal where regions, facet tags and facet sets are."""
    topology, count = mesh.topology, len(mesh.points)
    boundary, interfaces = topology.boundary, topology.interfaces
    inner, inner_tets = tagged_inside(mesh)
    triangles = np.concatenate([boundary, interfaces, inner])

    outside = np.iinfo(np.int64).min
    region = mesh.regions[topology.boundary_half_facets[:, 0]]
    sides = [
        np.column_stack([np.full(len(boundary), outside), region]),
        np.sort(mesh.regions[topology.interface_pairs[:, ::2]], axis=1),
        np.repeat(mesh.regions[inner_tets][:, None], 2, axis=1),
    ]
    groups = _groups(triangles, mesh.facets, count)
    return triangles, distinct_rows(np.column_stack([np.concatenate(sides), groups]))


def tagged_inside(mesh: TetMesh) -> tuple[Ints, Ints]:
    """The tagged facets (k, 3) inside a region, oriented out of their first tet, and that tet (k,)."""
    tagged = np.unique(np.sort(mesh.facets.vertices, axis=1), axis=0)
    pairs = mesh.topology.interior_pairs
    touched = np.zeros(len(mesh.points), dtype=bool)
    touched[tagged] = True
    if len(tagged):
        near = touched[mesh.tets].sum(axis=1) >= 3
        pairs = pairs[near[pairs[:, 0]] & near[pairs[:, 2]]]
        pairs = pairs[mesh.regions[pairs[:, 0]] == mesh.regions[pairs[:, 2]]]
    else:
        pairs = pairs[:0]
    facets = mesh.tets[pairs[:, :1], FACETS[pairs[:, 1]]]
    found = find_rows(tagged, np.sort(facets, axis=1), len(mesh.points)) >= 0
    return facets[found], pairs[found, 0]


def _groups(cells: Ints, tagged: Cells, count: int) -> Ints:
    """(k, g) per cell the groups (tag values, then sets) it belongs to, ascending, filled up with -1."""
    place_of = find_rows(np.sort(cells, axis=1), np.sort(tagged.vertices, axis=1), count)
    values, group = np.unique(tagged.tags, return_inverse=True)
    pairs = [np.column_stack([place_of, group])]
    for k, name in enumerate(sorted(tagged.sets)):
        members = place_of[tagged.sets[name]]
        pairs.append(np.column_stack([members, np.full(len(members), len(values) + k)]))
    belongs = np.unique(np.concatenate(pairs), axis=0)
    belongs = belongs[belongs[:, 0] >= 0]
    starts = np.searchsorted(belongs[:, 0], np.arange(len(cells) + 1))
    width = int(np.diff(starts).max(initial=0))
    out = np.full((len(cells), width), -1, dtype=np.int64)
    out[belongs[:, 0], np.arange(len(belongs)) - starts[belongs[:, 0]]] = belongs[:, 1]
    return out


def _user_edges(mesh: TetMesh) -> tuple[Ints, Ints]:
    """The tagged edges that are edges of the mesh, each once, and a label equal where tags and sets are equal."""
    if not len(mesh.edges):
        return np.empty((0, 2), dtype=np.int64), np.empty(0, dtype=np.int64)
    edges = np.unique(np.sort(mesh.edges.vertices, axis=1), axis=0)
    edges = edges[find_rows(mesh.topology.edges, edges, len(mesh.points)) >= 0]
    return edges, distinct_rows(_groups(edges, mesh.edges, len(mesh.points)))


def _local_size(points: Floats, edges: Ints) -> Floats:
    """(n,) mean length of the surface edges at each vertex, 0 away from the surface."""
    lengths = np.repeat(np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1), 2)
    degree = np.bincount(edges.ravel(), minlength=len(points))
    mean: Floats = np.bincount(edges.ravel(), lengths, minlength=len(points)) / np.maximum(degree, 1)
    return mean


def _without_dangling(points: Floats, segments: Ints, hard: Bools, pinned: Bools, size: Floats) -> Bools:
    """(s,) which segments stay when short chains of sharp segments with a free end are cut off, again and again."""
    keep = np.ones(len(segments), dtype=bool)
    lengths = np.linalg.norm(points[segments[:, 0]] - points[segments[:, 1]], axis=1)
    while True:
        rows = np.flatnonzero(keep)
        ends = segments[rows]
        degree = np.bincount(ends.ravel(), minlength=len(points))
        breaks = (degree != 2) | pinned
        breaks[ends[hard[rows]]] = True
        chain = _chains(ends, breaks, len(points))
        total = np.bincount(chain, lengths[rows])
        scale = np.bincount(chain, size[ends].mean(axis=1)) / np.bincount(chain)
        free = np.bincount(chain, ((degree == 1) & ~pinned)[ends].any(axis=1)) > 0
        fixed = np.bincount(chain, hard[rows]) > 0
        cut = (free & ~fixed & (total < DANGLING * scale))[chain]
        if not cut.any():
            return keep
        keep[rows[cut]] = False


def _speck_rims(first: Ints, second: Ints, paired: Bools, crease: Bools, hard: Bools, count: int) -> Bools:
    """(e,) the edges between a patch of at most ``SPECK`` triangles and the one larger patch all round it."""
    smooth = paired & ~crease
    patch = components(first[smooth], second[smooth], count)
    sizes = np.bincount(patch)
    one, other = patch[first], patch[second]
    rim = crease & (~paired | (one != other))
    ends = np.concatenate([one[rim], other[rim]])
    beside = np.concatenate([other[rim], one[rim]])
    around = np.unique(np.column_stack([ends, beside]), axis=0)
    speck = (sizes <= SPECK) & (np.bincount(around[:, 0], minlength=len(sizes)) == 1)
    speck[ends[np.tile((hard | ~paired)[rim], 2)]] = False
    speck[around[sizes[around[:, 1]] <= SPECK, 0]] = False
    gone: Bools = rim & (speck[one] | speck[other])
    return gone


def _corners(points: Floats, segments: Ints, tag: Ints) -> Bools:
    """(n,) where other than two segments meet, two meet at a sharp turn, or two of different tags meet."""
    degree = np.bincount(segments.ravel(), minlength=len(points))
    out: Bools = (degree > 0) & (degree != 2)
    through, (a, b) = _through(segments, degree == 2)
    ends_a, ends_b = (segments[s].sum(axis=1) - through for s in (a, b))
    turn = angle_between(points[through] - points[ends_a], points[ends_b] - points[through])
    out[through[(turn > np.radians(CORNER_TURN)) | (tag[a] != tag[b])]] = True
    return out


def _through(segments: Ints, smooth: Bools) -> tuple[Ints, Ints]:
    """The ``smooth`` vertices on exactly two segments, and these two (2, k)."""
    ends = segments.ravel()
    order = np.argsort(ends, kind="stable")
    order = order[smooth[ends[order]]]
    return ends[order[::2]], (order // 2).reshape(-1, 2).T


def _chains(segments: Ints, breaks: Bools, count: int) -> Ints:
    """(s,) chain ids: segments that meet at a vertex of exactly two segments that is no break are in one chain."""
    smooth = (np.bincount(segments.ravel(), minlength=count) == 2) & ~breaks
    _, (a, b) = _through(segments, smooth)
    return components(a, b, len(segments))
