"""Partial restarts: the part of a mesh that was resampled, stitched to the tets that stay."""

from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np

from wct_plugin.core import _core
from wct_plugin.core.domain import StratifiedMesh
from wct_plugin.core.results import SearchResult
from wct_plugin.mesh.index_arrays import components, find_rows
from wct_plugin.types import Bools, Ints


def stitched(fresh: StratifiedMesh, lost: Ints, result: SearchResult) -> StratifiedMesh | None:
    """The ``fresh`` mesh, with the tets of the search's ``result`` wherever both have the same points.

    Where points stay, Delaunay tets stay only inside a convex domain: beside a gap, points across it may lie in the
    spheres of well-centered tets, so that these are not among the fresh ones. None where the domain is not represented
    in what stays of the fresh mesh: it has one of the points ``lost`` (l,), or another Euler characteristic.
    """
    old = result.mesh
    both = np.vstack([old.points, fresh.points])
    _, first, place = np.unique(both, axis=0, return_index=True, return_inverse=True)
    name = first[place.reshape(-1)]  # a number for each place: the old point's, where there is one
    of_fresh = name[len(old.points) :]
    tets, known = of_fresh[fresh.tets], old.tets
    new = find_rows(np.sort(known, axis=1), np.sort(tets, axis=1), len(both)) < 0
    missing = find_rows(np.sort(tets, axis=1), np.sort(known, axis=1), len(both)) < 0
    parts = _Parts.of(np.vstack([tets[new], known[missing]]), len(both))
    kept = np.zeros(len(both), dtype=bool)
    kept[of_fresh[of_fresh < len(old.points)]] = True
    kept[known[result.stuck]] = False
    parts = parts.without(np.flatnonzero(~kept))

    of_old = parts.number[of_fresh] >= 0
    if (lost < 0).any() or not of_old[lost].all():
        return None
    gone, back = new & parts.inside(tets), missing & parts.inside(known)
    at = np.full(len(both), -1, dtype=np.int64)
    at[of_fresh] = np.arange(len(of_fresh))
    out_tets = np.vstack([fresh.tets[~gone], at[known[back]]])
    regions = np.concatenate([fresh.regions[~gone], old.regions[back]])
    characteristic = _core.euler_characteristics(known, old.regions)
    if not np.array_equal(_core.euler_characteristics(out_tets, regions), characteristic):
        return None
    same = np.where(of_old, of_fresh, 0)  # the old point
    facets, facet_patch = parts.exchange(at, of_fresh, (fresh.facets, old.facets), (fresh.facet_patch, old.facet_patch))
    creases, crease_curve = parts.exchange(
        at, of_fresh, (fresh.creases, old.creases), (fresh.crease_curve, old.crease_curve)
    )
    return replace(
        fresh,
        tets=out_tets,
        regions=regions,
        stratum=np.where(of_old, old.stratum[same], fresh.stratum),
        label=np.where(of_old, old.label[same], fresh.label),
        facets=facets,
        facet_patch=facet_patch,
        creases=creases,
        crease_curve=crease_curve,
    )


class _Parts(NamedTuple):
    """Where two meshes differ: ``number`` (n,) per point the part it is in, -1 for none.

    Tets of either that are not in the other belong to one part where they share points, so that each part may be taken
    from either mesh, whatever the others are taken from.
    """

    number: Ints

    @classmethod
    def of(cls, tets: Ints, count: int) -> Self:
        number = components(tets[:, :3].ravel(), tets[:, 1:].ravel(), count)
        there = np.zeros(count, dtype=bool)
        there[tets] = True
        return cls(np.where(there, number, -1))

    def without(self, points: Ints) -> "_Parts":
        """But for the parts with any of these points."""
        return _Parts(np.where(np.isin(self.number, self.number[points]), -1, self.number))

    def inside(self, cells: Ints) -> Bools:
        """(k,) which cells (k, corners) have all their points in one part."""
        part = self.number[cells]
        one: Bools = (part[:, 0] >= 0) & (part == part[:, :1]).all(axis=1)
        return one

    def exchange(
        self, at: Ints, of_fresh: Ints, cells: tuple[Ints, Ints], labels: tuple[Ints, Ints]
    ) -> tuple[Ints, Ints]:
        """Fresh cells outside the parts and old ones inside, with their labels."""
        outside, within = ~self.inside(of_fresh[cells[0]]), self.inside(cells[1])
        return (
            np.vstack([cells[0][outside], at[cells[1][within]]]),
            np.concatenate([labels[0][outside], labels[1][within]]),
        )
