"""Patches whose facets are given, to be held to the bit while everything else is made anew."""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.meshing.reference import Reference
from wct_plugin.meshing.search_mesh import SearchMesh
from wct_plugin.types import Bools, Floats, Ints


class HeldSurface(NamedTuple):
    """Facets of some patches of a reference, all they have, with the creases and corners at their rims."""

    points: Floats  #: (n, 3)
    stratum: NDArray[np.int8]  #: (n,) of the reference: 1 patch, 2 crease, 3 corner
    label: Ints  #: (n,) patch, curve, or vertex of the reference
    facets: Ints  #: (f, 3) running as the triangles of the reference do
    patch: Ints  #: (f,)
    fixed: Ints  #: (k,) those patches whose facets the search leaves alone, too; of the others the vertices stay

    @classmethod
    def of(cls, on: Reference, stays: Bools, fixed: Bools) -> Self:
        """The reference's own facets of the patches that stay."""
        rows = stays[on.strata.patch]
        used, facets = np.unique(on.strata.triangles[rows], return_inverse=True)
        stratum = on.strata.stratum[used]
        return cls(
            on.points[used],
            stratum,
            np.where(stratum == 3, used, on.strata.label[used]),
            facets.reshape(-1, 3),
            on.strata.patch[rows],
            np.flatnonzero(fixed),
        )

    def curves(self, on: Reference) -> Ints:
        """Curves of the reference that bound one of the patches."""
        beside = on.strata.triangles[np.isin(on.strata.patch, self.patch)]
        edges = np.sort(beside[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        at = find_rows(edges, on.strata.segments, len(on.points)) >= 0
        return np.unique(on.strata.curve[at])

    def is_in(self, start: SearchMesh, patches: Ints) -> bool:
        """Whether a mesh has, of these patches of its surface, all facets that are held, and no other."""
        both = np.vstack([self.points, start["points"]])
        place = np.unique(both, axis=0, return_inverse=True)[1].reshape(-1)
        own, there = place[: len(self.points)], place[len(self.points) :]
        own_facets = np.sort(own[self.facets[np.isin(self.patch, patches)]], axis=1)
        facets = np.sort(there[start["facets"][np.isin(start["facet_patch"], patches)]], axis=1)
        return len(facets) == len(own_facets) and bool((find_rows(facets, own_facets, len(both)) >= 0).all())
