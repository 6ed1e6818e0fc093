"""What the connectivity round a vertex on a flat patch or a straight crease rules out for acute facets.

The vertex v slides on its patch or crease, or stays, and so do its neighbours on the surface; tets and facets stay as
they are. A patch counts as flat, and a crease as straight, only if its points are exactly on one plane or line.
Everything here is about angles at v; its neighbours are taken as vectors from it, and two of them are *joined* if they
are in a facet with v.

Theorems
--------
**Few facets.** The angles of the facets of one flat patch at v, between two of its creases or all round v, add up to
what the patch fills there: 360 degrees inside it, 180 at a straight crease, and t at a corner that stays, between two
creases that are straight or whose next vertices stay. *If k facets are all acute, k > 360 / 90, 180 / 90 or t / 90,*
since they add up to less than 90 k degrees. So 5 are needed inside, 3 at a crease, and 2 at the corner of a box.

**Spanned plane.** *Let v be inside a flat patch, s_1 ... s_k its neighbours there in turn, all round, and d any other
neighbour that is joined to at least one of every two that follow each other. Then not all facets at v are acute.* If
they are, two that follow each other are less than 90 degrees apart, so those joined to d follow each other less than
180 degrees apart. Let e be the part of d in the plane; d . s = e . s > 0 for all s joined to d, so e is not 0. -e is
between two successive ones, -e = p s + q t with p, q >= 0, so -|e|^2 = -e . d = p s . d + q t . d >= 0, which is false.

**Along a crease.** *Let v be on a straight crease with its neighbours a and b on it. Connect a neighbour to a if they
are joined, to b likewise, and two neighbours on two flat patches at the crease if they are joined and their half-planes
from the crease are at least 90 degrees apart. If that connects a with b, not all facets at v are acute.* Let z be the
coordinate along the crease, from a to b. If all are acute, a neighbour x joined to a has x . a > 0, that is z(x) < 0,
and one joined to b has z(x) > 0. For x and y on two patches x . y = z(x) z(y) + c with c <= 0, the product of the parts
at right angles to the crease, so x . y > 0 makes the signs of z(x) and z(y) the same. On the way from a to b the sign
would have to change, or one neighbour to have both. In that shortest case the angles a-v-x and x-v-b add up to 180
degrees.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import Polynomial, exact_signs
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.index_arrays import components
from wct_plugin.mesh.strata import Strata
from wct_plugin.obstructions.fixed_vertices import straight
from wct_plugin.obstructions.reason import Reason
from wct_plugin.obstructions.stars import Stars
from wct_plugin.types import Bools, Ints

FEW_FACETS = "too few facets of a flat patch: the angles that they share out here leave one of them 90° or more"
SPANNED = "a neighbour off a flat patch, joined to neighbours on all sides on it, is at 90° or more from one of them"
ALONG_CREASE = "facets lead from one neighbour on a straight crease to the other in too few steps for acute angles"


def reasons(mesh: TetMesh, of: Strata, stars: Stars, held: Bools, near: Bools, *, frees: str) -> Iterator[Reason]:
    """Why the facets at a surface vertex cannot all be acute in this connectivity.

    ``stars`` are those of the mesh's tets, ``held`` (n,) the vertices that stay, ``near`` (n,) those to look at.
    """
    look = _Surface(mesh, of, held)
    for v in np.flatnonzero(near & (of.stratum > 0)).tolist():
        sectors = look.sectors(v)
        if not sectors:
            continue
        tets = tuple(stars.at(v).tolist())
        if any(look.too_few(v, sector) for sector in sectors):
            yield Reason(((v,),), FEW_FACETS, tets, frees)
        links = stars.links(v)
        joined = np.concatenate([links[:, [0, 1]], links[:, [0, 2]], links[:, [1, 2]]])
        if of.stratum[v] == 1:
            for d in _spanning(sectors[0].ring[:-1], joined):
                yield Reason(((v,), tuple(sorted((v, d)))), SPANNED, tets, frees)
        elif look.leads_along(v, sectors, joined):
            yield Reason(((v,),), ALONG_CREASE, tets, frees)


class _Sector(NamedTuple):
    """Facets of one flat patch at a vertex, from crease to crease or all round: its neighbours there, in turn."""

    patch: int
    ring: list[int]  #: the first one again at the end if they go all round


class _Surface:
    """The flat patches and straight creases of a mesh, and what they are like at a vertex."""

    def __init__(self, mesh: TetMesh, of: Strata, held: Bools) -> None:
        self._points, self._of, self._held = mesh.points, of, held
        self._stars = Stars(of.triangles, len(mesh.points))
        self._flat = _flat(mesh, of)
        self._straight = {
            tuple(segment): bool(is_so) for segment, is_so in zip(of.segments.tolist(), straight(mesh, of), strict=True)
        }

    def _on_crease(self, v: int, x: int) -> bool:
        return (min(v, x), max(v, x)) in self._straight

    def _is_straight(self, v: int, x: int) -> bool:
        return self._straight.get((min(v, x), max(v, x)), False)

    def _sign(self, polynomial: Polynomial, *cell: int) -> int:
        return int(exact_signs(polynomial, self._points, np.array([cell])).values[0, 0])

    def sectors(self, v: int) -> list[_Sector]:
        """Those of all flat patches at a vertex."""
        rows, links = self._stars.at(v), self._stars.links(v)
        found = []
        for patch in sorted(set(self._of.patch[rows].tolist())):
            if self._flat[patch]:
                found += [_Sector(patch, ring) for ring in self._walks(v, links[self._of.patch[rows] == patch])]
        return found

    def _walks(self, v: int, links: Ints) -> Iterator[list[int]]:
        beside: dict[int, list[int]] = {}
        for one, two in links.tolist():
            beside.setdefault(one, []).append(two)
            beside.setdefault(two, []).append(one)
        used: set[tuple[int, int]] = set()
        ends = sorted(x for x in beside if self._on_crease(v, x))
        for start in [*ends, *sorted(set(beside) - set(ends))]:  # rings without a crease come last
            for second in beside[start]:
                if (start, second) in used:
                    continue
                ring = [start]
                last, here = start, second
                while True:
                    used |= {(last, here), (here, last)}
                    ring.append(here)
                    if here == start or self._on_crease(v, here):
                        break
                    last, here = here, next(x for x in beside[here] if (here, x) not in used)
                yield ring

    def too_few(self, v: int, sector: _Sector) -> bool:
        """Whether the facets of a sector cannot all be acute."""
        first, second, last = sector.ring[0], sector.ring[1], sector.ring[-1]
        facets = len(sector.ring) - 1
        if first == last:
            return not self._on_crease(v, first) and facets < 5
        if self._of.stratum[v] == 2:
            return facets < 3 and self._passes_straight(v, first, last)
        fixed = [self._held[x] or self._is_straight(v, x) for x in (first, last)]
        if not (self._held[v] and all(fixed)) or facets not in (2, 3):  # one facet alone is a held angle
            return False
        turn = self._sign(predicates.fold, v, first, second, last)
        if facets == 2:
            return turn <= 0  # 180 degrees or more
        return turn < 0 and self._sign(predicates.corners, v, first, last) >= 0  # 270 or more

    def _passes_straight(self, v: int, a: int, b: int) -> bool:
        both = self._is_straight(v, a) and self._is_straight(v, b)
        return both and self._sign(predicates.corners, v, a, b) < 0

    def leads_along(self, v: int, sectors: list[_Sector], joined: Ints) -> bool:
        """Whether facets at a vertex of a straight crease connect its neighbours on the crease."""
        rows = sorted({x for sector in sectors for x in (sector.ring[0], sector.ring[-1])})
        if self._of.stratum[v] != 2 or len(rows) != 2 or not self._passes_straight(v, *rows):
            return False
        a, b = rows
        flat = {x for sector in sectors for x in sector.ring[1:-1]}
        links = [
            (x, y)
            for x, y in joined.tolist()
            if {x, y} & {a, b} or ({x, y} <= flat and self._sign(predicates.fold, v, b, x, y) <= 0)
        ]
        names, places = np.unique(np.array(links), return_inverse=True)
        one, other = places.reshape(-1, 2).T
        part = components(one, other, len(names))
        ends = np.searchsorted(names, rows)
        return bool(part[ends[0]] == part[ends[1]])


def _flat(mesh: TetMesh, of: Strata) -> Bools:
    """(p,) which patches are exactly in one plane."""
    patches, first = np.unique(of.patch, return_index=True)
    plane = of.triangles[first[np.searchsorted(patches, of.patch)]]
    out = np.ones(int(patches.max(initial=-1)) + 1, dtype=bool)
    for vertex in of.triangles.T:
        off = exact_signs(predicates.volume, mesh.points, np.column_stack([plane, vertex])).values[:, 0] != 0
        out[of.patch[off]] = False
    return out


def _spanning(ring: list[int], joined: Ints) -> Iterator[int]:
    """The vertices off a ``ring`` that are joined to one of every two that follow each other on it."""
    on = set(ring)
    met: dict[int, set[int]] = {}
    for one, two in joined.tolist():
        for d, s in ((one, two), (two, one)):
            if s in on and d not in on:
                met.setdefault(d, set()).add(s)
    for d in sorted(met):
        if all({s, t} & met[d] for s, t in zip(ring, ring[1:] + ring[:1], strict=True)):
            yield d
