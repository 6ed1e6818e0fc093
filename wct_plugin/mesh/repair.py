"""Broken tets dropped or mended: those that are twice there, have a vertex twice, no volume, or are folded back.

A tet of zero volume has two sides. Where the domain is on one of them only, it goes. Where it is on both, the facets
of the two sides do not match; they are made to by cutting edges and facets in two, all round, at a vertex that lies on
them exactly, or else where two edges cross. So no volume changes, and no tag, for the parts have those of the whole.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, permutations
from typing import NamedTuple

import numpy as np

from wct_plugin.errors import NoMeshError
from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import exact_signs
from wct_plugin.mesh import faults
from wct_plugin.mesh.index_arrays import components
from wct_plugin.mesh.mesh import and_more
from wct_plugin.mesh.repairs import Repairs
from wct_plugin.mesh.topology import FACETS, crowded_facets
from wct_plugin.types import Bools, Floats, Ints

#: So many cuts may follow from each tet of zero volume inside.
_CUTS = 20
#: Six times the volume of a tet that is flat but for rounding, in cubes of its longest edge.
_THIN = 1e-9


class Part(NamedTuple):
    """Cells (k, d), and which of the given ones each is or is part of."""

    cells: Ints
    origin: Ints

    def where(self, keep: Bools) -> "Part":
        """Those where the mask holds."""
        return Part(self.cells[keep], self.origin[keep])


@dataclass(frozen=True)
class Mended:
    """Tets that make a mesh, with what was cut along with them; ``points`` has those that were added at its end."""

    points: Floats
    tets: Part
    others: tuple[Part, ...]
    ends: Ints  #: (a, 4) per added point the vertices whose mean it has the values of
    repairs: Repairs
    volumes: tuple[float, float]  #: before, of tets with numbers as coordinates, and after

    def describe(self) -> str:
        """What was done, in words."""
        before, after = self.volumes
        return f"{self.repairs}; volume {before:.12g} before, {after:.12g} now"


def mend(points: Floats, tets: Ints, others: tuple[Ints, ...] = ()) -> Mended:
    """Drop or mend broken tets (m, 4); facets, edges and vertices among ``others`` are cut with the tets.

    Raises :class:`NoMeshError`, with the list, for what cannot be mended.
    """
    found = faults.find(points, tets)
    if len(found.not_finite):
        bad = found.not_finite
        raise NoMeshError(f"tet {bad[0]}{and_more(bad)} has coordinates that are no numbers, which cannot be repaired")
    before = _volume(points, tets)
    keep = np.ones(len(tets), dtype=bool)
    keep[found.degenerate] = keep[found.repeated[:, 0]] = False
    given = Part(tets[keep], np.flatnonzero(keep))
    work = _Work(points, [given, *(Part(cells, np.arange(len(cells))) for cells in others)])
    dropped = work.without_flat()
    folded = work.without_folded()
    left = faults.find(work.points, work.tets)
    if left:
        raise NoMeshError(f"cannot be repaired, for there stay {_in_given_numbers(left, work.parts[0].origin)}")
    if not len(work.tets):
        raise NoMeshError("cannot be repaired, for no tet is left")
    repairs = Repairs(
        repeated=len(found.repeated),
        degenerate=len(found.degenerate),
        flat=dropped,
        folded=folded,
        mended=len(found.flat) - dropped,
        added_points=len(work.points) - len(points),
    )
    ends = np.array(work.ends, dtype=np.int64).reshape(-1, 4)
    after = _volume(work.points, work.tets)
    return Mended(work.points, work.parts[0], tuple(work.parts[1:]), ends, repairs, (before, after))


def _in_given_numbers(left: faults.Faults, origin: Ints) -> faults.Faults:
    crowded = left.crowded.copy()
    crowded[:, 3:] = origin[crowded[:, 3:]]
    names = ("degenerate", "repeated", "flat", "inverted")
    return replace(left, crowded=crowded, **{name: origin[getattr(left, name)] for name in names})


def _volume(points: Floats, tets: Ints) -> float:
    corners = points[tets]
    edges = corners[:, 1:] - corners[:, :1]
    return float(np.abs(np.linalg.det(edges)).sum() / 6.0) if len(tets) else 0.0


class _Work:
    """The tets, and all that is cut with them, while they are mended; the tets are the first part."""

    def __init__(self, points: Floats, parts: list[Part]) -> None:
        self.points, self.parts = points, parts
        self.ends: list[list[int]] = []
        self._flat = predicates.orientation(points, self.tets) == 0  # (m,), as the tets are now

    @property
    def tets(self) -> Ints:
        """(m, 4) the tets there are."""
        return self.parts[0].cells

    def without_flat(self) -> int:
        """Drop tets of zero volume where that leaves a mesh, cut the others away; how many were dropped.

        Those that can be neither stay.
        """
        dropped: set[int] = set()
        for _ in range(_CUTS * int(self._flat.sum()) + 1):
            gone = _on_one_side(self.points, self.tets, self._flat)
            dropped |= set(self.parts[0].origin[gone].tolist())
            self._keep(~gone)
            if not self._flat.any() or not self._cut_away(self.tets[np.argmax(self._flat)]):
                break
        return len(dropped)

    def _keep(self, keep: Bools) -> None:
        self.parts[0] = self.parts[0].where(keep)
        self._flat = self._flat[keep]

    def without_folded(self) -> int:
        """Drop tets that lie over others and whose loss leaves no void; how many.

        They are folded back over their neighbours at the boundary, or all but flat and one too many at their facets.
        """
        rows = np.flatnonzero(~self._flat)
        rows = rows[faults.folded(self.tets[rows], predicates.orientation(self.points, self.tets[rows]))]
        gone = np.zeros(len(self.tets), dtype=bool)
        gone[rows[(self._tets_at_facets(rows) == 1).any(axis=1)]] = True
        self._keep(~gone)
        crowded = np.unique(crowded_facets(self.tets, len(self.points))[:, 3:])
        corners = self.points[self.tets[crowded]]
        edges = corners[:, 1:] - corners[:, :1]
        thin = np.abs(np.linalg.det(edges)) <= _THIN * np.linalg.norm(edges, axis=2).max(axis=1, initial=0.0) ** 3
        sharing = self._tets_at_facets(crowded)
        extra = crowded[thin & ((sharing == 1) | (sharing > 2)).all(axis=1)]
        self._keep(~np.isin(np.arange(len(self.tets)), extra))
        return int(gone.sum()) + len(extra)

    def _tets_at_facets(self, rows: Ints) -> Ints:
        """(k, 4) how many tets there are at each facet of some."""
        near = self.tets[np.isin(self.tets, self.tets[rows]).sum(axis=1) >= 3]
        facets = np.sort(np.concatenate([self.tets[rows], near])[:, FACETS].reshape(-1, 3), axis=1)
        _, place, count = np.unique(facets, axis=0, return_inverse=True, return_counts=True)
        mine = place.reshape(-1)[: 4 * len(rows)].reshape(-1, 4)
        return count[mine] - np.bincount(mine.ravel(), minlength=len(count))[mine]

    def _cut_away(self, tet: Ints) -> bool:
        """Cut edges or facets so that a tet of zero volume has none left; False where others would lose theirs."""
        corners = self.points[tet]
        for one, other in combinations(range(4), 2):
            if (corners[one] == corners[other]).all():
                return self._apply(partial(_joined, one=int(tet[one]), other=int(tet[other])))
        for between, one, other in permutations(range(4), 3):
            if one < other and _is_between(corners[between], corners[one], corners[other]):
                edge = int(tet[one]), int(tet[other])
                return self._apply(partial(_cut, corners=edge, at=int(tet[between])))
        signs = _facet_signs(self.points, tet)
        if abs(signs.sum()) == 2:  # one facet covers the other three
            inside = int(np.argmax(signs == -np.sign(signs.sum())))
            facet = tuple(np.delete(tet, inside).tolist())
            return self._apply(partial(_cut, corners=facet, at=int(tet[inside])))
        two = (int(k) for k in np.flatnonzero(signs > 0))
        return self._cross(tet, *two)

    def _cross(self, tet: Ints, i: int, j: int) -> bool:
        """Cut the two diagonals of a flat quadrilateral where they cross; one of them ends at corners i and j."""
        k, m = (one for one in range(4) if one not in (i, j))
        one, other = (int(tet[i]), int(tet[j])), (int(tet[k]), int(tet[m]))
        at = _crossing(self.points[list(one)], self.points[list(other)])
        new = len(self.points)
        before = self.points
        self.points = np.vstack([self.points, at])
        if self._apply(lambda part: _cut(_cut(part, one, new), other, new)):
            self.ends.append([*one, *other])
            return True
        self.points = before
        return False

    def _apply(self, change: Callable[[Part], Part]) -> bool:
        """Change all parts alike, unless a tet that had volume would be turned round or flat."""
        changed = change(Part(self.tets, np.arange(len(self.tets))))
        new = np.flatnonzero((changed.cells != self.tets[changed.origin]).any(axis=1))
        had = predicates.orientation(self.points, self.tets[changed.origin[new]])
        if (predicates.orientation(self.points, changed.cells[new]) != had).any():
            return False
        self.parts = [change(part) for part in self.parts]
        self._flat = self._flat[changed.origin]
        return True


def _on_one_side(points: Floats, tets: Ints, flat: Bools) -> Bools:
    """(m,) the flat tets that go without a gap: all that they would lay bare is on one side of their common plane."""
    gone = np.zeros(len(tets), dtype=bool)
    near = np.flatnonzero(np.isin(tets, tets[flat]).sum(axis=1) >= 3)  # all that may have a facet of theirs
    if not flat.any():
        return gone
    facets = np.sort(tets[near][:, FACETS].reshape(-1, 3), axis=1)
    place = np.unique(facets, axis=0, return_inverse=True)[1].reshape(-1)
    thin = np.repeat(flat[near], 4)
    full = np.bincount(place[~thin], minlength=int(place.max()) + 1)  # tets with volume at each facet
    rows = np.flatnonzero(thin)
    order = rows[np.argsort(place[rows], kind="stable")]
    alike = place[order[1:]] == place[order[:-1]]
    group = components(order[:-1][alike] // 4, order[1:][alike] // 4, len(near))
    bare = np.flatnonzero(~thin & (full[place] == 1) & np.isin(place, place[rows]))
    opposite = dict(zip(place[bare].tolist(), tets[near].ravel()[bare].tolist(), strict=True))
    for one in np.unique(group[flat[near]]):
        members = np.flatnonzero(flat[near] & (group == one))
        sides = place[(4 * members[:, None] + np.arange(4)).ravel()]
        beyond = np.array([opposite[at] for at in sides.tolist() if at in opposite], dtype=np.int64)
        gone[near[members]] = _same_side(points, np.unique(tets[near[members]]), beyond)
    return gone


def _same_side(points: Floats, corners: Ints, opposite: Ints) -> bool:
    """Whether the points ``opposite`` are strictly on one side of the plane of all ``corners``, if these have one."""
    if not len(opposite):
        return True
    first = corners[0]
    far = corners[np.argmax(np.linalg.norm(points[corners] - points[first], axis=1))]
    arms = points[corners] - points[first]
    third = corners[np.argmax(np.linalg.norm(np.cross(arms, points[far] - points[first]), axis=1))]
    plane = np.array([first, far, third])
    asked = np.concatenate([corners, opposite])
    signs = predicates.orientation(points, np.column_stack([np.tile(plane, (len(asked), 1)), asked]))
    return bool((signs[: len(corners)] == 0).all() and abs(signs[len(corners) :].sum()) == len(opposite))


def _is_between(point: Floats, one: Floats, other: Floats) -> bool:
    """Whether a point is exactly on the segment between two others, and neither of them."""
    three = np.array([one, other, point])
    if exact_signs(predicates.normal, three, np.array([[0, 1, 2]])).values.any():
        return False
    low, high = np.minimum(one, other), np.maximum(one, other)
    return bool(((low <= point) & (point <= high)).all())


def _facet_signs(points: Floats, tet: Ints) -> Ints:
    """(4,) which way the facets of a flat tet run round, seen along an axis that its plane does not contain."""
    signs = exact_signs(predicates.normal, points, tet[FACETS]).values.astype(np.int64)
    seen: Ints = signs[:, np.argmax(np.abs(signs).sum(axis=0))]
    return seen


def _crossing(one: Floats, other: Floats) -> Floats:
    """The point of the first segment (2, 3) that is nearest to the line of the second."""
    u, v, w = one[1] - one[0], other[1] - other[0], other[0] - one[0]
    normal = np.cross(u, v)
    share = float(np.dot(np.cross(w, v), normal) / np.dot(normal, normal))
    at: Floats = one[0] + share * u
    return at


def _cut(part: Part, corners: tuple[int, ...], at: int) -> Part:
    """The cells with all of these corners cut into one for each, with the vertex ``at`` in its place.

    What would have the vertex twice is gone.
    """
    cells, origin = part
    has = np.isin(cells, corners).sum(axis=1) == len(corners)
    if not has.any():
        return part
    pieces = [Part(np.where(cells[has] == corner, at, cells[has]), origin[has]) for corner in corners]
    together = Part(
        np.concatenate([cells[~has], *(piece.cells for piece in pieces)]),
        np.concatenate([origin[~has], *(piece.origin for piece in pieces)]),
    )
    return _without_collapsed(together)


def _joined(part: Part, one: int, other: int) -> Part:
    """The cells with the vertex ``one`` in the place of ``other``."""
    return _without_collapsed(Part(np.where(part.cells == other, one, part.cells), part.origin))


def _without_collapsed(part: Part) -> Part:
    ordered = np.sort(part.cells, axis=1)
    return part.where((ordered[:, 1:] != ordered[:, :-1]).all(axis=1))
