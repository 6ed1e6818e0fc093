"""Points that coincide exactly, and boundary facets that do: cracks and contacts, zipped up and unzipped again.

Boundary facets with the same corners that face each other are a pair. Their corners are joined while the mesh is made
anew: bodies in contact become regions with an interface, the two sides of a crack a sheet inside a region. Afterwards
the mesh is cut along them again. Bodies that share no vertex then are made anew one by one.
"""

import itertools
import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wct_plugin.core import _core
from wct_plugin.errors import OptionError, WctWarning
from wct_plugin.measure.conserved import CHANGE
from wct_plugin.mesh import Cells, TetMesh, unit_scaling
from wct_plugin.mesh.coincident_points import places
from wct_plugin.mesh.index_arrays import among, components, distinct_rows, find_rows
from wct_plugin.mesh.topology import FACETS
from wct_plugin.mesh.triangle_surfaces import areas, normals
from wct_plugin.meshing.cut_cells import copied_edges, copied_nodes, copies, repeated, together
from wct_plugin.meshing.transfer import locate
from wct_plugin.types import Bools, Ints

Merge = Literal["auto", "none", "all"]

#: Sets of facets that only live between zipping and unzipping: all pairs, sheets, one per side, tag and sets.
_PAIRS = "\0pairs"
#: Those that are sheets inside a region: they stay, as facets with no corner off a rim inside a body would be closed.
SHEETS = "\0sheets"
_SIDE = "\0side {}"
#: As far into its tet, as a part of the way to the centroid, a vertex is looked up on its own side of a crack.
_INWARD = 1e-3


class Part(NamedTuple):
    """A body, or several that are joined."""

    mesh: TetMesh
    points: Ints  #: (n,) where its points are in the mesh that was zipped up


class _Group(NamedTuple):
    """What facets of one side of pairs have in common."""

    side: int
    tag: int
    sets: tuple[str, ...]


def merged(mesh: TetMesh) -> TetMesh:
    """All points that coincide exactly joined, each group with the data of its first."""
    place = places(mesh.points)
    return mesh if place.max() + 1 == len(place) else _renumbered(mesh, place)


class Zipped:
    """A mesh with the pairs of its facets joined, in parts that share no vertex."""

    def __init__(self, mesh: TetMesh, pairs: Ints, joined: Ints) -> None:
        """``pairs`` (k, 2): rows of the boundary; ``joined`` (n,): where the points of the mesh go."""
        self._old, self._joined = mesh, joined
        boundary, half = mesh.topology.boundary, mesh.topology.boundary_half_facets
        self._first = boundary[pairs[:, 0]]
        piece = mesh.topology.components
        body = np.unique(np.column_stack([mesh.regions, piece]), axis=0, return_inverse=True)[1].reshape(-1)
        sheet = body[half[pairs[:, 0], 0]] == body[half[pairs[:, 1], 0]]
        regions = distinct_rows(mesh.regions[:, None]) if sheet.all() else body
        self._regions = np.zeros(int(regions.max()) + 1, dtype=np.int64)
        self._regions[regions] = mesh.regions
        facets, self._groups = _marked(mesh.facets, boundary, pairs, sheet, len(mesh.points))
        bare = replace(
            mesh,
            regions=regions,
            facets=facets,
            edges=_without_data(mesh.edges),
            nodes=_without_data(mesh.nodes),
            point_data={name: values for name, values in mesh.point_data.items() if values.dtype.kind == "f"},
            point_sets={},
            reference=None,
        )
        whole = _renumbered(bare, joined)
        label = _bodies(whole.tets, len(whole.points))
        origin = np.unique(joined, return_index=True)[1]
        self.parts: list[Part] = []
        for one in range(int(label.max()) + 1):
            rows = np.flatnonzero(label == one)
            place = np.full(len(label), -1, dtype=np.int64)
            place[rows] = np.arange(len(rows))
            part = replace(
                whole,
                tets=whole.tets[rows],
                regions=whole.regions[rows],
                cell_data={name: values[rows] for name, values in whole.cell_data.items()},
                tet_sets={name: place[at][place[at] >= 0] for name, at in whole.tet_sets.items()},
            )
            self.parts.append(Part(part, origin[np.unique(whole.tets[rows])]))

    def unzipped(self, made: Sequence[TetMesh]) -> TetMesh:
        """The parts made anew, in their order, put together and cut along the pairs again."""
        old, whole = self._old, together(made)
        self._warn_of_drops()
        tets, origin, halves = self._cut(whole)
        facets = self._facets(whole, tets, origin, halves)
        if len(halves):
            self._warn_of_area(whole, halves)
        points = whole.points[origin]
        return replace(
            old,
            points=points,
            tets=tets,
            regions=self._regions[whole.regions],
            facets=facets,
            edges=copied_edges(old, self._joined, whole, tets, origin),
            nodes=copied_nodes(whole.nodes, whole, tets, origin),
            point_data=self._point_data(whole, tets, origin, halves),
            cell_data=whole.cell_data,
            point_sets={},
            tet_sets=whole.tet_sets,
        )

    def _cut(self, whole: TetMesh) -> tuple[Ints, Ints, Ints]:
        """Tets with a copy of a vertex per component of its tets, where each copy is from, and both halves of pairs.

        The halves (k, 4) are tet, local facet of the first side, then those of the other.
        """
        topology, count = whole.topology, len(whole.points)
        rows = whole.facets.vertices[whole.facets.sets[_PAIRS]]
        inner = topology.interior_pairs
        if not len(rows):
            return whole.tets, np.arange(count), inner[:0]
        cut = among(topology.triangles_of(inner[:, :2]), rows, count)
        halves = self._sided(whole, inner[cut])
        zipped = np.zeros(count, dtype=bool)
        zipped[rows] = True
        corner = np.arange(whole.tets.size).reshape(-1, 4)
        # Each corner of a tet, and each vertex, is a node; vertices off the cut join all their corners.
        off = ~zipped[whole.tets]
        links = [np.column_stack([corner[off], whole.tets.size + whole.tets[off]])]
        through = inner[~cut]
        for k in range(3):
            here = corner[through[:, 0], FACETS[through[:, 1], k]]
            vertex = whole.tets.ravel()[here]
            across = corner[through[:, 2]][whole.tets[through[:, 2]] == vertex[:, None]]
            links.append(np.column_stack([here, across]))
        one, other = np.concatenate(links).T
        label = components(one, other, whole.tets.size + count)[: whole.tets.size]
        key = np.unique(np.column_stack([whole.tets.ravel(), label]), axis=0, return_inverse=True)
        return key[1].reshape(-1, 4), key[0][:, 0], halves

    def _sided(self, whole: TetMesh, inner: Ints) -> Ints:
        """Rows of interior facets with the half that is on the first side of its pair first."""
        unit = unit_scaling.exponent(self._old.points)
        old, new = (unit_scaling.rescaled(points, -unit) for points in (self._old.points, whole.points))
        triangles = whole.topology.triangles_of(inner[:, :2])
        nearest = _core.closest_points(old, self._first, new[triangles].mean(axis=1))[1]
        along = np.einsum("ij,ij->i", normals(new, triangles), normals(old, self._first)[nearest])
        return np.where((along > 0.0)[:, None], inner, inner[:, [2, 3, 0, 1]])

    def _facets(self, whole: TetMesh, tets: Ints, origin: Ints, halves: Ints) -> Cells:
        """The tagged facets, each side of a pair with its own."""
        given, count = whole.facets, len(whole.points)
        paired = np.sort(given.vertices[given.sets[_PAIRS]], axis=1)
        plain = find_rows(paired, np.sort(given.vertices, axis=1), count) < 0
        kept = given.select(plain)
        kept = repeated(kept, *copies(kept.vertices, whole.tets, tets, origin))
        vertices, tags = [kept.vertices], [kept.tags]
        sets: dict[str, list[Ints]] = {name: [kept.sets[name]] for name in self._old.facets.sets}
        there = np.sort(whole.topology.triangles_of(halves[:, :2]), axis=1)
        at = len(vertices[0])
        for k, group in enumerate(self._groups):
            members = np.unique(np.sort(given.vertices[given.sets[_SIDE.format(k)]], axis=1), axis=0)
            row = find_rows(there, members, count)
            half = halves[row[row >= 0], 2 * group.side : 2 * group.side + 2]
            vertices.append(tets[half[:, :1], FACETS[half[:, 1]]])
            tags.append(np.full(len(half), group.tag, dtype=np.int64))
            for name in group.sets:
                sets[name].append(np.arange(at, at + len(half)))
            at += len(half)
        return Cells(
            np.concatenate(vertices),
            np.concatenate(tags),
            {},
            {name: np.concatenate(one) for name, one in sets.items()},
        )

    def _point_data(self, whole: TetMesh, tets: Ints, origin: Ints, halves: Ints) -> dict[str, NDArray[Any]]:
        """What the old mesh says in each place, for each copy of a vertex on its own side of the pairs."""
        if not whole.point_data or not len(halves):
            return dict(whole.point_data)
        unit = unit_scaling.exponent(self._old.points)
        old = unit_scaling.scaled(self._old, -unit)
        points = unit_scaling.rescaled(whole.points[origin], -unit)
        several = np.flatnonzero(np.bincount(origin)[origin] > 1)
        tet_of = np.zeros(len(origin), dtype=np.int64)
        tet_of[tets.ravel()] = np.repeat(np.arange(len(tets)), 4)
        middle = points[tets[tet_of[several]]].mean(axis=1)
        points[several] += _INWARD * (middle - points[several])
        tet, weights = locate(old, points)
        return {
            name: np.einsum("ij,ij...->i...", weights, old.point_data[name][old.tets[tet]]) for name in whole.point_data
        }

    def _warn_of_drops(self) -> None:
        old = self._old
        lost = [f"point data {name!r}" for name, values in old.point_data.items() if values.dtype.kind != "f"]
        lost += [f"point set {name!r}" for name in old.point_sets]
        for kind, cells in (("triangle", old.facets), ("edge", old.edges), ("vertex", old.nodes)):
            lost += [f"{kind} data {name!r}" for name in cells.data]
        if lost:
            warnings.warn(f"resampling drops {', '.join(lost)}", WctWarning, stacklevel=5)

    def _warn_of_area(self, whole: TetMesh, halves: Ints) -> None:
        """A pair that is lost is named."""
        unit = unit_scaling.exponent(self._old.points)
        before, after = (
            float(areas(unit_scaling.rescaled(points, -unit), triangles).sum())
            for points, triangles in (
                (self._old.points, self._first),
                (whole.points, whole.topology.triangles_of(halves[:, :2])),
            )
        )
        if abs(after - before) > CHANGE * before:
            warnings.warn(
                f"the area of coincident pairs of facets changed by {100.0 * (after / before - 1.0):+.2f} %:"
                f" {len(self._first)} pairs before, {len(halves)} now",
                WctWarning,
                stacklevel=5,
            )


def zip_up(mesh: TetMesh, merge: Merge) -> Zipped | None:
    """The mesh with pairs of facets joined; None where no points coincide, or nothing follows from it.

    Raises :class:`OptionError` where more than half of the boundary is in pairs, unless ``merge`` says what to do.
    """
    place = places(mesh.points)
    sizes = np.bincount(place)
    if len(sizes) == len(place):
        return None
    several = int((sizes[place] > 1).sum())
    pairs = _pairs(mesh, place) if merge == "auto" else np.empty((0, 2), dtype=np.int64)
    facets = len(mesh.topology.boundary)
    if 4 * len(pairs) > facets:
        raise OptionError(
            f"{mesh.source or 'the mesh'}: {2 * len(pairs)} of {facets} boundary facets coincide in {len(pairs)} pairs,"
            f" as in a mesh taken apart; choose merge=all (joins the {several} coincident points)"
            " or merge=none (leaves them apart)"
        )
    pairs, dropped = _without_accidental(mesh, place, pairs)
    joined = _joined(mesh, place, pairs)
    if merge == "auto":
        lost = f", {dropped} between bodies that otherwise touch with other facets left apart" if dropped else ""
        warnings.warn(
            f"{several} coincident points in {int((sizes > 1).sum())} places: kept as {len(pairs)} pairs of"
            f" facets{lost}; merge=all joins them",
            WctWarning,
            stacklevel=4,
        )
    if not len(pairs) and _bodies(mesh.tets, len(mesh.points)).max() == 0:
        return None
    return Zipped(mesh, pairs, joined)


def _pairs(mesh: TetMesh, place: Ints) -> Ints:
    """(k, 2) rows of the boundary: facets with the same corners, two each, that face each other."""
    corners = place[mesh.topology.boundary]
    of = distinct_rows(np.sort(corners, axis=1))
    rows = np.flatnonzero(np.bincount(of)[of] == 2)
    two = rows[np.argsort(of[rows], kind="stable")].reshape(-1, 2)
    a, b, c = corners.T
    turn = (a > b) ^ (a > c) ^ (b > c)
    facing: Ints = two[turn[two[:, 0]] != turn[two[:, 1]]]
    return facing


def _joined(mesh: TetMesh, place: Ints, pairs: Ints) -> Ints:
    """(n,) the points numbered anew, equal where pairs join them."""
    sides = mesh.topology.boundary[pairs]
    one, other = np.take_along_axis(sides, np.argsort(place[sides], axis=2), axis=2).swapaxes(0, 1)
    return components(one.ravel(), other.ravel(), len(mesh.points))


def _without_accidental(mesh: TetMesh, place: Ints, pairs: Ints) -> tuple[Ints, int]:
    """The pairs but for those of two bodies that touch at other points too, their facets there being different ones."""
    if not len(pairs):
        return pairs, 0
    body = np.zeros(len(mesh.points), dtype=np.int64)
    body[mesh.tets] = _bodies(mesh.tets, len(mesh.points))[:, None]
    met = np.unique(np.column_stack([place, _joined(mesh, place, pairs), body]), axis=0)
    touching: set[tuple[int, int]] = set()
    for _, group in itertools.groupby(met.tolist(), key=lambda row: row[0]):
        for (_, one, a), (_, other, b) in itertools.combinations(group, 2):
            if one != other and a != b:
                touching.add((min(a, b), max(a, b)))
    ends = np.sort(body[mesh.topology.boundary[pairs][:, :, 0]], axis=1).tolist()
    keep = np.array([tuple(one) not in touching for one in ends])
    return pairs[keep], int((~keep).sum())


def _bodies(tets: Ints, count: int) -> Ints:
    """(m,) a number per tet, equal where a path through vertices joins two."""
    label = components(np.repeat(tets[:, 0], 3), tets[:, 1:].ravel(), count)
    return np.unique(label[tets[:, 0]], return_inverse=True)[1].reshape(-1)


def _renumbered(mesh: TetMesh, place: Ints) -> TetMesh:
    """The mesh on fewer points: point k becomes ``place[k]``, each with the data of the first that does."""
    first = np.unique(place, return_index=True)[1]
    facets, edges, nodes = (
        replace(cells, vertices=place[cells.vertices]) for cells in (mesh.facets, mesh.edges, mesh.nodes)
    )
    return replace(
        mesh,
        points=mesh.points[first],
        tets=place[mesh.tets],
        facets=facets,
        edges=edges,
        nodes=nodes,
        point_data={name: values[first] for name, values in mesh.point_data.items()},
        point_sets={name: np.unique(place[at]) for name, at in mesh.point_sets.items()},
    )


def _without_data(cells: Cells) -> Cells:
    return replace(cells, data={})


def _marked(facets: Cells, boundary: Ints, pairs: Ints, sheet: Bools, count: int) -> tuple[Cells, list[_Group]]:
    """The tagged facets and those of the pairs, in sets that say what each side of a pair had."""
    side = np.full(len(boundary), -1, dtype=np.int64)
    side[pairs] = [0, 1]
    row = find_rows(np.sort(boundary, axis=1), np.sort(facets.vertices, axis=1), count)
    on = np.where(row >= 0, side[row], -1) if len(boundary) else row
    names = list(facets.sets)
    member = np.zeros((len(facets), len(names)), dtype=np.int64)
    for k, name in enumerate(names):
        member[facets.sets[name], k] = 1
    rows = np.flatnonzero(on >= 0)
    kinds, of = np.unique(np.column_stack([on[rows], facets.tags[rows], member[rows]]), axis=0, return_inverse=True)
    groups = [
        _Group(int(kind[0]), int(kind[1]), tuple(name for name, at in zip(names, kind[2:], strict=True) if at))
        for kind in kinds
    ]
    tag = int(facets.tags.max(initial=0)) + 1
    sets = dict(facets.sets)
    sets |= {_SIDE.format(k): rows[of.reshape(-1) == k] for k in range(len(groups))}
    sets[_PAIRS] = len(facets) + np.arange(len(pairs))
    sets[SHEETS] = sets[_PAIRS][sheet]
    marked = Cells(
        np.concatenate([facets.vertices, boundary[pairs[:, 0]]]),
        np.concatenate([facets.tags, np.full(len(pairs), tag, dtype=np.int64)]),
        {},
        sets,
    )
    return marked, groups
