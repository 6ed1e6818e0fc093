"""Pairs of facets that are translates of each other, made so again while the surface is resampled.

One of each pair is the master. Where curves are shared by several pairs, as the edges of a box are by two, one of them
gives its points to all that it is a translate of. With these held, a first mesh is made; its facets of the masters,
translated, are the slaves', and with both held a second mesh is made.
"""

import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol, Self

import numpy as np

from wct_plugin.core.domain import StratifiedMesh
from wct_plugin.core.results import SearchResult
from wct_plugin.errors import WctWarning
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.strata import Strata
from wct_plugin.mesh.topology import FACETS
from wct_plugin.meshing.boundary_choice import Boundary, PatchChoices
from wct_plugin.meshing.held_surface import HeldSurface, rims
from wct_plugin.meshing.local_search import LocalSearch, best
from wct_plugin.meshing.local_tolerance import Tolerance
from wct_plugin.meshing.reference import Reference, own_boundary
from wct_plugin.meshing.restart import PartialRestart
from wct_plugin.meshing.surface_edges import Lengths
from wct_plugin.types import Floats, Ints

#: As near are points that are meant to be one, in diagonals.
_NEAR = 1e-9


#: How often a first mesh is made, as its facets may leave no choice where they come together as slaves.
_ATTEMPTS = 2


class Pair(Protocol):
    """Facets and their translates."""

    @property
    def master(self) -> Ints:
        """(k, 3) facets of the boundary."""

    @property
    def slave(self) -> Ints:
        """(k, 3) those that they are translated to, in any order."""

    @property
    def vertices(self) -> Ints:
        """(m, 2) each vertex of the master, and where it is translated to."""

    @property
    def translation(self) -> Floats:
        """(3,) from the master to the slave."""


class _Copy(NamedTuple):
    """A patch or curve that is a translate of another, which may be itself."""

    root: int
    offset: Floats  #: from the root
    vertex: Ints  #: (n,) of the reference: where the root's are translated to, -1 for others


class _Link(NamedTuple):
    """One step from a patch or curve to a translate of it."""

    start: int
    end: int
    offset: Floats
    vertex: Ints


class Unmatched(Exception):  # noqa: N818 - no error: it says why pairs cannot be kept
    """Pairs cannot be made to match again."""


def warn_unmatched(why: Unmatched) -> None:
    """Say that pairs are lost, and why."""
    warnings.warn(f"periodic pairs of facets cannot be made to match: {why}", WctWarning, stacklevel=3)


def marked(mesh: TetMesh, pairs: Sequence[Pair], crease_angle: float) -> tuple[TetMesh, Reference]:
    """The mesh and its own surface, cut along the rims of the pairs; both sides of a pair have the same corners."""
    count, old = len(mesh.points), mesh.facets
    sides = [np.sort(side, axis=1) for pair in pairs for side in (pair.master, pair.slave)]
    every = np.unique(np.concatenate(sides), axis=0)
    new = every[find_rows(np.sort(old.vertices, axis=1), every, count) < 0]
    cells = np.concatenate([old.vertices, new])
    tags = np.concatenate([old.tags, np.full(len(new), old.tags.max(initial=0) + 1)])
    rows = (find_rows(np.sort(cells, axis=1), side, count) for side in sides)
    sets = {f"given {name}": members for name, members in old.sets.items()}
    cut = replace(mesh, facets=Cells(cells, tags, {}, sets | {f"side {k}": row for k, row in enumerate(rows)}))
    while True:
        own = own_boundary(cut, crease_angle)
        corner = own.strata.stratum == 3
        before = corner.copy()
        for pair in pairs:
            one, other = pair.vertices.T
            corner[one] |= corner[other]
            corner[other] |= corner[one]
        if np.array_equal(corner, before):
            return cut, own
        nodes = np.union1d(cut.nodes.vertices.ravel(), np.flatnonzero(corner & ~before))
        cut = replace(cut, nodes=Cells(nodes[:, None]))


class PeriodicSurface:
    """The surface of a mesh with pairs: which patches and curves are translates of which."""

    def __init__(self, mesh: TetMesh, pairs: Sequence[Pair], wanted: Boundary, crease_angle: float) -> None:
        """Raises :class:`Unmatched` where patches, curves or corners of a pair have no counterpart."""
        self.mesh, self.own = marked(mesh, pairs, crease_angle)
        on, count = self.own, len(mesh.points)
        patches: list[_Link] = []
        curves: list[_Link] = []
        corners: list[_Link] = []
        for pair in pairs:
            there = np.full(count, -1, dtype=np.int64)
            there[pair.vertices[:, 0]] = pair.vertices[:, 1]
            offset = np.where(np.abs(pair.translation) > _NEAR * on.diagonal, pair.translation, 0.0)
            found = _links(pair, there, offset, on.strata)
            patches += found[0]
            curves += found[1]
            ends = pair.vertices[on.strata.stratum[pair.vertices[:, 0]] == 3]
            corners += [_Link(a, b, offset, there) for a, b in ends.tolist()]
        none = np.empty(0, dtype=np.int64)
        self.choices = PatchChoices(wanted, self.mesh, on.strata)
        classes = _classes(patches, count, none)
        for root in {copy.root for copy in classes.values()}:
            self.choices.level(np.array([patch for patch, copy in classes.items() if copy.root == root]))
        before = np.flatnonzero(self.choices.stays)
        self.patches = _classes(patches, count, before)
        self.curves = _classes(curves, count, rims(on, before))
        self._corners = _classes(corners, count, none)

    @property
    def firm(self) -> Ints:
        """Curves that bound a patch of a pair."""
        return rims(self.own, np.array(sorted(self.patches), dtype=np.int64))

    @property
    def shared(self) -> bool:
        """Whether a curve that bounds a master is a translate of another."""
        bounding = rims(self.own, np.array([copy.root for copy in self.patches.values()], dtype=np.int64))
        return any(self.curves[c].root != c for c in bounding.tolist() if c in self.curves)

    def matched(self, search: LocalSearch, plain: SearchResult, tolerance: Tolerance) -> list[SearchResult]:
        """What the search of the surface, resampled with matching pairs, leads to.

        ``plain``: where the search led without, from which come the curves that pairs share, and the sizes. Raises
        :class:`Unmatched` where there is no start with matching pairs, or none before it is stopped.
        """
        from scipy.spatial import cKDTree  # here: importing a filter to see its options should not take it

        lengths = Lengths(plain.mesh.size[cKDTree(plain.mesh.points).query(self.mesh.points)[1]])
        tried: list[SearchResult] = []
        for attempt in range(_ATTEMPTS):
            again = replace(search, seed=search.seed + attempt)
            try:
                tried += self._matched_once(again, plain, tolerance, lengths, anew=self.shared or attempt > 0)
            except Unmatched:
                if attempt + 1 == _ATTEMPTS and not tried:
                    raise
            if search.listen.stopped or (tried and not len(best(tried).stuck)):
                break
        return tried

    def _matched_once(
        self, search: LocalSearch, plain: SearchResult, tolerance: Tolerance, lengths: Lengths, *, anew: bool
    ) -> list[SearchResult]:
        """From a first mesh, plain or made ``anew`` with the curves that are shared, to others with its facets."""
        on, first, found = self.own, search, plain
        if anew:
            lines = self._lines(_Located.of(plain.mesh, on, search.held))
            first = _holding(search, lines, on)
            first.work.begin()  # each of the searches that follow one another may take as much
            start = first.first_start(on, tolerance, lengths)
            if start is None:
                raise Unmatched("no mesh was found with the curves that they share")
            found = best(first.run_finer(start, on, tolerance, lengths))
        located = _Located.of(found.mesh, on, first.held)
        taken = set() if search.held is None else set(search.held.patch.tolist())
        held = self._faces(located, self._lines(located), taken)
        second = _holding(search, held, on)
        second.work.begin()
        start = second.resampled(on, tolerance, lengths, restart=self._restart(found, held))
        if start is None:
            start = second.resampled(on, tolerance, lengths)
        if start is None:
            raise Unmatched("no mesh was found with facets that match")
        return second.run_finer(start, on, tolerance, lengths)

    def _restart(self, found: SearchResult, held: HeldSurface) -> PartialRestart:
        """What was found, to be made anew beside the patches that get other facets."""
        slaves = np.array([patch for patch, copy in self.patches.items() if copy.root != patch])
        corners = held.points[held.facets[np.isin(held.patch, slaves)]]
        edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean(axis=1)
        again = PartialRestart.around(found, corners.mean(axis=1), edge)
        curves = held.all_curves(self.own)
        patch = (again.stratum == 1) & np.isin(again.label, held.patch)
        return again.without(patch | ((again.stratum == 2) & np.isin(again.label, curves)))

    def _lines(self, found: "_Located") -> HeldSurface:
        """The curves of all classes, with the points that the first of each has, translated."""
        points: list[Floats] = []
        stratum: list[Ints] = []
        label: list[Ints] = []
        edges: list[Ints] = []
        count = 0
        for curve, copy in self.curves.items():
            ends = found.mesh.creases[found.mesh.crease_curve == copy.root]
            used, local = np.unique(ends, return_inverse=True)
            corner = found.stratum[used] == 3
            at = found.mesh.points[used] + copy.offset
            vertices = copy.vertex[found.label[used[corner]]]
            for row, vertex in zip(np.flatnonzero(corner).tolist(), vertices.tolist(), strict=True):
                at[row] = self._corner(vertex)
            points.append(at)
            stratum.append(np.where(corner, 3, 2))
            names = np.full(len(used), curve)
            names[corner] = vertices
            label.append(names)
            edges.append(local.reshape(-1, 2) + count)
            count += len(used)
        return _joined(
            np.concatenate(points),
            np.concatenate(stratum),
            np.concatenate(label),
            np.concatenate(edges),
            np.array(sorted(self.curves), dtype=np.int64),
        )

    def _corner(self, vertex: int) -> Floats:
        copy = self._corners[vertex]
        at: Floats = self.own.points[copy.root] + copy.offset
        return at

    def _faces(self, found: "_Located", lines: HeldSurface, taken: set[int]) -> HeldSurface:
        """The patches of all classes but for those ``taken``, with the facets of the first of each, translated."""
        on, mesh = self.own, found.mesh
        held = lines._replace(edges=lines.edges[:0], curves=lines.curves[:0])
        oriented = found.oriented(on)
        for patch, copy in self.patches.items():
            if patch in taken:
                continue
            rows = np.flatnonzero(mesh.facet_patch == copy.root)
            facets = oriented[rows] if self._same_way(patch, copy) else oriented[rows][:, ::-1]
            used, local = np.unique(facets, return_inverse=True)
            inner = found.stratum[used] == 1
            points = mesh.points[used] + copy.offset
            one = HeldSurface(
                points,
                found.stratum[used].astype(np.int8),
                np.where(inner, patch, -1),
                local.reshape(-1, 3),
                np.full(len(rows), patch),
                np.array([patch]),
            )
            before = len(held.points)
            held = held.with_others(one, _NEAR * on.diagonal)
            if (held.stratum[before:] != 1).any():
                raise Unmatched("the rims of two that should match differ")
        return held

    def _same_way(self, patch: int, copy: _Copy) -> bool:
        """Whether triangles of the patch run as the translated ones of its root do."""
        strata = self.own.strata
        own = strata.triangles[strata.patch == patch]
        moved = copy.vertex[strata.triangles[np.flatnonzero(strata.patch == copy.root)[0]]]
        row = own[find_rows(np.sort(own, axis=1), np.sort(moved)[None], len(self.own.points))[0]]
        return any(np.array_equal(np.roll(row, k), moved) for k in range(3))


class _Located(NamedTuple):
    """A mesh, and what each point of its surface is there: also those that were pinned."""

    mesh: StratifiedMesh
    stratum: Ints
    label: Ints

    @classmethod
    def of(cls, mesh: StratifiedMesh, on: Reference, held: HeldSurface | None) -> Self:
        stratum, label = mesh.stratum.astype(np.int64), mesh.label.copy()
        corners = on.corners
        known = HeldSurface(
            on.points[corners], np.full(len(corners), 3, dtype=np.int8), corners, *([np.empty(0, dtype=np.int64)] * 3)
        )
        for source in (known, held):
            if source is None:
                continue
            both = np.vstack([source.points, mesh.points])
            _, first, place = np.unique(both, axis=0, return_index=True, return_inverse=True)
            at = first[place.reshape(-1)[len(source.points) :]]
            there = (at < len(source.points)) & (mesh.stratum == 3) & (mesh.label < 0)
            stratum[there], label[there] = source.stratum[at[there]], source.label[at[there]]
        return cls(mesh, stratum, label)

    def oriented(self, on: Reference) -> Ints:
        """The facets, each running out of a tet of the region behind its patch."""
        mesh, count = self.mesh, len(self.mesh.points)
        out = mesh.tets[:, FACETS].reshape(-1, 3)
        region = np.repeat(mesh.regions, 4)
        behind = on.sides[mesh.facet_patch, 0]
        rows = find_rows(
            np.column_stack([np.sort(out, axis=1), region + 1]),
            np.column_stack([np.sort(mesh.facets, axis=1), behind + 1]),
            max(count, len(on.regions) + 1),
        )
        return np.where(rows[:, None] >= 0, out[rows], mesh.facets)


def _holding(search: LocalSearch, held: HeldSurface, on: Reference) -> LocalSearch:
    if search.held is not None:
        held = search.held.with_others(held, _NEAR * on.diagonal)
    return replace(search, held=held, fixed=held.fixed)


def _joined(points: Floats, stratum: Ints, label: Ints, edges: Ints, curves: Ints) -> HeldSurface:
    """Edges between points, of which those of one corner are one."""
    key = np.where(stratum == 3, label, len(label) + label.max(initial=0) + 1 + np.arange(len(label)))
    _, first, place = np.unique(key, return_index=True, return_inverse=True)
    nothing = np.empty(0, dtype=np.int64)
    return HeldSurface(
        points[first],
        stratum[first].astype(np.int8),
        label[first],
        nothing.reshape(0, 3),
        nothing,
        nothing,
        place.reshape(-1)[edges],
        curves,
    )


def _links(pair: Pair, there: Ints, offset: Floats, of: Strata) -> tuple[list[_Link], list[_Link]]:
    """From the patches and curves of a master to those of the slave."""
    count = len(there)
    rows = find_rows(np.sort(of.triangles, axis=1), np.sort(pair.master, axis=1), count)
    to = find_rows(np.sort(of.triangles, axis=1), np.sort(there[pair.master], axis=1), count)
    if (rows < 0).any() or (to < 0).any():
        raise Unmatched("a facet of one of them is no facet of the surface")
    patches = _one_to_one(of.patch[rows], of.patch[to], np.bincount(of.patch), "patches")
    edges = np.sort(of.triangles[rows][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    at = np.flatnonzero(find_rows(edges, of.segments, count) >= 0)
    moved = find_rows(of.segments, np.sort(there[of.segments[at]], axis=1), count)
    if (moved < 0).any():
        raise Unmatched("creases of one of them are none of the other")
    curves = _one_to_one(of.curve[at], of.curve[moved], np.bincount(of.curve), "creases")
    return [_Link(a, b, offset, there) for a, b in patches], [_Link(a, b, offset, there) for a, b in curves]


def _one_to_one(one: Ints, other: Ints, sizes: Ints, what: str) -> list[tuple[int, int]]:
    """Which label becomes which, where all that have one of them have one of the other."""
    found = np.unique(np.column_stack([one, other]), axis=0)
    of_one, of_other = np.bincount(one, minlength=len(sizes)), np.bincount(other, minlength=len(sizes))
    whole = (of_one[found[:, 0]] == sizes[found[:, 0]]) & (of_other[found[:, 1]] == sizes[found[:, 1]])
    if len(np.unique(found[:, 0])) < len(found) or len(np.unique(found[:, 1])) < len(found) or not whole.all():
        raise Unmatched(f"{what} of one of them are others of the other")
    return [(a, b) for a, b in found.tolist()]


def _classes(links: list[_Link], count: int, before: Ints) -> dict[int, _Copy]:
    """Each piece that is in a link, and the first one that it is a translate of; those ``before`` come first."""
    around: dict[int, list[_Link]] = {}
    for link in links:
        back = np.full(count, -1, dtype=np.int64)
        there = link.vertex >= 0
        back[link.vertex[there]] = np.flatnonzero(there)
        around.setdefault(link.start, []).append(link)
        around.setdefault(link.end, []).append(_Link(link.end, link.start, -link.offset, back))
    ends, chosen = {link.end for link in links}, set(before.tolist())
    found: dict[int, _Copy] = {}
    for root in sorted(around, key=lambda piece: (piece not in chosen, piece in ends, piece)):
        if root in found:
            continue
        found[root] = _Copy(root, np.zeros(3), np.arange(count))
        queue = [root]
        for piece in queue:
            here = found[piece]
            for link in around[piece]:
                if link.end not in found:
                    vertex = np.where(here.vertex >= 0, link.vertex[here.vertex], -1)
                    found[link.end] = _Copy(root, here.offset + link.offset, vertex)
                    queue.append(link.end)
    return found
