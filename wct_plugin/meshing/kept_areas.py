"""Whether a search kept the areas of plane groups and interfaces: where it did not, another start may."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from wct_plugin.core.results import SearchResult
from wct_plugin.measure.conserved import CHANGE
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.triangle_surfaces import areas
from wct_plugin.meshing.followed_surface import patch_areas, patches_of_groups, planar_patches
from wct_plugin.meshing.reference import Reference
from wct_plugin.types import Bools, Floats


@dataclass(frozen=True, eq=False)
class KeptAreas:
    """The areas of groups and interfaces on the surface that is followed, of those that are plane all over.

    Where the area of a curved one is another, its facets are too few: any other start has it so.
    """

    members: Bools  #: (groups, patches) whether the patch is of the group
    wanted: Floats  #: (groups,) the area it has

    @classmethod
    def of(cls, mesh: TetMesh, own: Reference, on: Reference) -> Self:
        """Those of the mesh, whose own surface is ``own``, on the surface ``on``."""
        groups = [np.isin(on.carried, patches) for patches in patches_of_groups(mesh, own).values()]
        pairs = np.sort(on.sides, axis=1)
        between = (pairs[:, 0] >= 0) & (pairs[:, 0] < pairs[:, 1])
        groups += [(pairs == pair).all(axis=1) for pair in np.unique(pairs[between], axis=0)]
        members, area = np.array(groups, dtype=bool).reshape(-1, len(on.sides)), patch_areas(on)
        wanted = members @ area
        asked = (wanted > 0.0) & ~members[:, ~planar_patches(on, area)].any(axis=1)
        return cls(members[asked], wanted[asked])

    def holds(self, found: SearchResult) -> bool:
        """Whether none changed by more than is allowed; not asked where creases between patches were given up."""
        if len(found.released) or not len(self.wanted):
            return True
        mesh = found.mesh
        area = np.bincount(mesh.facet_patch, areas(mesh.points, mesh.facets), minlength=self.members.shape[1])
        return bool((np.abs(self.members @ area - self.wanted) <= CHANGE * self.wanted).all())
