"""The surface a resampled mesh must stay near: its strata, the regions on either side, and how exact it is itself."""

from dataclasses import dataclass, field

import numpy as np

from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.strata import Strata, find_strata, surface_strata
from wct_plugin.mesh.triangle_surfaces import bends
from wct_plugin.types import Floats, Ints

#: Tolerance where the user gives none, as a fraction of the bounding-box diagonal, unless the reference is coarser.
TOLERANCE = 1e-3


@dataclass(frozen=True, eq=False)
class Reference:
    """A surface in strata. ``sides`` (patches, 2): index of the region behind a patch's triangles and before them."""

    points: Floats
    strata: Strata
    sides: Ints  #: -1 stands for outside
    regions: Ints  #: region tags in the order of their indices
    carried: Ints  #: (patches,) the patch of the mesh's own surface whose tags each patch has
    folds: Ints = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    """(f, 2) edges that bend as creases do and are none any more"""

    @property
    def corners(self) -> Ints:
        """Indices of the corners."""
        return np.flatnonzero(self.strata.stratum == 3)

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal."""
        return float(np.linalg.norm(np.ptp(self.points[np.unique(self.strata.triangles)], axis=0)))

    def auto_tolerance(self) -> float:
        """Fraction of the diagonal: 1e-3, or the sag of the reference's own facets if that is larger."""
        return max(TOLERANCE, _facet_sag(self.points, self.strata) / self.diagonal)


def own_boundary(mesh: TetMesh, crease_angle: float) -> Reference:
    """The mesh's own boundary, interfaces and tagged facets as reference."""
    found = find_strata(mesh, crease_angle)
    topology = mesh.topology
    regions, index = np.unique(mesh.regions, return_inverse=True)
    behind = index[topology.boundary_half_facets[:, 0]]
    pairs = topology.interface_pairs
    sides = np.concatenate(
        [
            np.column_stack([behind, np.full(len(behind), -1)]),
            np.column_stack([index[pairs[:, 0]], index[pairs[:, 2]]]),
        ]
    )
    of_patch = np.full((int(found.patch.max()) + 1, 2), -1, dtype=np.int64)
    of_patch[found.patch[: len(sides)]] = sides
    return Reference(mesh.points, found, of_patch, regions, np.arange(len(of_patch)))


def given_surface(surface: SurfaceMesh, mesh: TetMesh, crease_angle: float) -> Reference:
    """A cleaned surface as reference of a mesh of one region without tags."""
    found = surface_strata(surface, crease_angle)
    patches = int(found.patch.max()) + 1
    nothing = np.zeros(patches, dtype=np.int64)
    return Reference(surface.points, found, np.tile([0, -1], (patches, 1)), np.unique(mesh.regions), nothing)


def _facet_sag(points: Floats, found: Strata) -> float:
    """How far facets of a smooth surface lie from it: 99 % quantile over the edges inside patches.

    A bend by the angle a between facets of edge l means a curvature of about a sqrt(3) / l, and facets that leave the
    surface by curvature l^2 / 6 in their middle.
    """
    edges, bend, inside = bends(points, found.triangles, found.patch)
    if not inside.any():
        return 0.0
    length = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    sag = np.radians(bend) * length * np.sqrt(3.0) / 6.0
    return float(np.quantile(sag[inside], 0.99))
