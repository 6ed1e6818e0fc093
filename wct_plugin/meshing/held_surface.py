"""Patches whose facets, and curves whose edges are given, to be held to the bit while everything else is made anew."""

from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from wct_plugin.core.domain import StratifiedMesh
from wct_plugin.core.requests import HeldFacets
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.meshing.reference import Reference
from wct_plugin.types import Bools, Floats, Ints


class HeldSurface(NamedTuple):
    """Facets of some patches of a reference, all they have, with the creases and corners at their rims.

    And edges of some curves, all they have, whose patches may not be held.
    """

    points: Floats  #: (n, 3)
    stratum: NDArray[np.int8]  #: (n,) of the reference: 1 patch, 2 crease, 3 corner
    label: Ints  #: (n,) patch, curve, or vertex of the reference
    facets: Ints  #: (f, 3) running as the triangles of the reference do
    patch: Ints  #: (f,)
    fixed: Ints  #: (k,) those patches whose facets the search leaves alone, too; of the others the vertices stay
    edges: Ints = np.empty((0, 2), dtype=np.int64)  #: (e, 2)
    curves: Ints = np.empty(0, dtype=np.int64)  #: (c,) those they are of

    @classmethod
    def of(cls, on: Reference, stays: Bools, fixed: Bools, curves: Ints) -> Self:
        """The reference's own facets of the patches that stay, and its own edges of the curves (c,)."""
        rows = stays[on.strata.patch]
        triangles, segments = on.strata.triangles[rows], on.strata.segments[np.isin(on.strata.curve, curves)]
        used, place = np.unique(np.concatenate([triangles.ravel(), segments.ravel()]), return_inverse=True)
        stratum = on.strata.stratum[used]
        return cls(
            on.points[used],
            stratum,
            np.where(stratum == 3, used, on.strata.label[used]),
            place[: triangles.size].reshape(-1, 3),
            on.strata.patch[rows],
            np.flatnonzero(fixed),
            place[triangles.size :].reshape(-1, 2),
            curves,
        )

    def all_curves(self, on: Reference) -> Ints:
        """Curves of the reference that stay: those given, and those that bound one of the patches."""
        return np.union1d(self.curves, rims(on, self.patch))

    def with_others(self, other: Self, near: float) -> Self:
        """What both hold; points of the other that are ``near`` one of these are the same."""
        from scipy.spatial import cKDTree  # here: importing a filter to see its options should not take it

        far, at = cKDTree(self.points).query(other.points, distance_upper_bound=near)
        new = ~np.isfinite(far)
        at[new] = len(self.points) + np.arange(new.sum())
        return type(self)(
            np.vstack([self.points, other.points[new]]),
            np.concatenate([self.stratum, other.stratum[new]]),
            np.concatenate([self.label, other.label[new]]),
            np.vstack([self.facets, at[other.facets]]),
            np.concatenate([self.patch, other.patch]),
            np.union1d(self.fixed, other.fixed),
            np.vstack([self.edges, at[other.edges]]),
            np.union1d(self.curves, other.curves),
        )

    def pinned(self, start: StratifiedMesh) -> StratifiedMesh:
        """The mesh, in which nothing moves the points that are held."""
        both = np.vstack([self.points, start.points])
        _, first, place = np.unique(both, axis=0, return_index=True, return_inverse=True)
        stays = first[place.reshape(-1)[len(self.points) :]] < len(self.points)
        return replace(
            start,
            stratum=np.where(stays, 3, start.stratum).astype(np.int8),
            label=np.where(stays, -1, start.label),
        )

    @property
    def request(self) -> HeldFacets:
        """What the core is asked to hold."""
        return HeldFacets(
            self.points, self.stratum.astype(np.int64), self.label, self.facets, self.patch, self.edges, self.curves
        )

    def is_in(self, start: StratifiedMesh, patches: Ints) -> bool:
        """Whether a mesh has, of these patches of its surface, all facets that are held, and no other."""
        both = np.vstack([self.points, start.points])
        place = np.unique(both, axis=0, return_inverse=True)[1].reshape(-1)
        own, there = place[: len(self.points)], place[len(self.points) :]
        own_facets = np.sort(own[self.facets[np.isin(self.patch, patches)]], axis=1)
        facets = np.sort(there[start.facets[np.isin(start.facet_patch, patches)]], axis=1)
        own_edges, edges = (np.sort(cells, axis=1) for cells in (own[self.edges], there[start.creases]))
        found = len(facets) == len(own_facets) and (find_rows(facets, own_facets, len(both)) >= 0).all()
        return bool(found and (find_rows(edges, own_edges, len(both)) >= 0).all())


def rims(on: Reference, patches: Ints) -> Ints:
    """Curves of the reference that bound one of the patches."""
    beside = on.strata.triangles[np.isin(on.strata.patch, patches)]
    edges = np.sort(beside[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    at = find_rows(edges, on.strata.segments, len(on.points)) >= 0
    return np.unique(on.strata.curve[at])
