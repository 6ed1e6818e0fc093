"""The surface a resampled mesh must stay near: its strata, the regions on either side, and how exact it is itself."""

from dataclasses import dataclass, field

import numpy as np

from wct_plugin.core.domain import StratifiedSurface
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.index_arrays import distinct_rows
from wct_plugin.mesh.strata import Strata, find_strata, surface_strata, tagged_inside
from wct_plugin.mesh.triangle_surfaces import normals
from wct_plugin.types import Floats, Ints

#: Tolerance where the user gives none, as a fraction of the bounding-box diagonal, unless the reference is coarser.
TOLERANCE = 1e-3


@dataclass(frozen=True, eq=False)
class Reference:
    """A surface in strata. ``sides`` (patches, 2): index of the region behind a patch's triangles and before them.

    Of a sheet inside a region, both are that region's.
    """

    points: Floats
    strata: Strata
    sides: Ints  #: -1 stands for outside
    regions: Ints  #: region tags in the order of their indices
    carried: Ints  #: (patches,) the patch of the mesh's own surface whose tags each patch has
    folds: Ints = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    """(f, 2) edges that bend as creases do and are none any more"""
    flat: float = 0.0
    """As far, a length, off a plane or line vertices may be that count as on it, if more than 1e-9 of its extent"""

    @property
    def corners(self) -> Ints:
        """Indices of the corners."""
        return np.flatnonzero(self.strata.stratum == 3)

    @property
    def surface(self) -> StratifiedSurface:
        """What the core is to stay near."""
        of = self.strata
        return StratifiedSurface(
            points=self.points,
            triangles=of.triangles,
            patch=of.patch,
            segments=of.segments,
            curve=of.curve,
            sides=self.sides,
            corners=self.corners,
            folds=self.folds,
            flat=self.flat,
        )

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
    within = tagged_inside(mesh)[1]
    sides = np.concatenate(
        [
            np.column_stack([behind, np.full(len(behind), -1)]),
            np.column_stack([index[pairs[:, 0]], index[pairs[:, 2]]]),
            np.column_stack([index[within], index[within]]),
        ]
    )
    sides[found.turned] = sides[found.turned, ::-1]
    of_patch = np.empty((int(found.patch.max()) + 1, 2), dtype=np.int64)
    of_patch[found.patch] = sides
    return Reference(mesh.points, found, of_patch, regions, np.arange(len(of_patch)))


def given_surface(surface: SurfaceMesh, mesh: TetMesh, crease_angle: float) -> Reference:
    """A cleaned surface as reference of a mesh of one region without tags."""
    found = surface_strata(surface, crease_angle)
    patches = int(found.patch.max()) + 1
    nothing = np.zeros(patches, dtype=np.int64)
    return Reference(surface.points, found, np.tile([0, -1], (patches, 1)), np.unique(mesh.regions), nothing)


def _facet_sag(points: Floats, found: Strata) -> float:
    """How far facets of a smooth surface lie from it: 99 % quantile over the facets.

    The smooth surface is the one with the vertex normals n of each patch, weighted by angle (Thuermer and Wuethrich,
    *Computing vertex normals from polygonal facets*, 1998). Along an edge e from vertex i to j the normal turns by
    d_ij = (n_j - n_i) . e, and a surface whose normals turn so lies sum b_i b_j d_ij / 2 over the three edges above the
    facet, b being barycentric coordinates: an eighth of d in the middle of an edge, an eighteenth of their sum at the
    centroid. Only what bends along an edge counts: on the long strips of a cylinder that is their width.
    """
    corners = points[found.triangles]
    normal = normals(points, found.triangles)
    size = np.linalg.norm(normal, axis=1)
    flat = size == 0.0
    if flat.all():
        return 0.0
    normal = normal / np.where(flat, 1.0, size)[:, None]
    smooth = _corner_normals(found, corners, normal)
    turned = np.roll(smooth, -1, axis=1) - smooth
    bend = np.einsum("tki,tki->tk", turned, np.roll(corners, -1, axis=1) - corners)
    sag = np.maximum(np.abs(bend).max(axis=1) / 8.0, np.abs(bend.sum(axis=1)) / 18.0)
    return float(np.quantile(sag[~flat], 0.99))


def _corner_normals(found: Strata, corners: Floats, normal: Floats) -> Floats:
    """(t, 3, 3) unit normals at the corners of the triangles, as smooth as their patch: each on its triangle's side.

    Triangles of sheets inside run either way, so normals are averaged as lines: the main axis of their tensors' sum.
    """
    arms = [np.roll(corners, shift, axis=1) - corners for shift in (-1, 1)]
    across = np.linalg.norm(np.cross(arms[0], arms[1]), axis=2)
    angle = np.arctan2(across, np.einsum("tki,tki->tk", arms[0], arms[1]))
    wedges = np.column_stack([found.triangles.ravel(), np.repeat(found.patch, 3)])
    of = distinct_rows(wedges)
    tensors = np.zeros((int(of.max()) + 1, 3, 3))
    np.add.at(tensors, of, angle.ravel()[:, None, None] * np.repeat(normal[:, :, None] * normal[:, None, :], 3, axis=0))
    axis = np.linalg.eigh(tensors)[1][:, :, 2][of].reshape(corners.shape)
    side = np.einsum("tki,ti->tk", axis, normal)
    out: Floats = axis * np.where(side < 0.0, -1.0, 1.0)[:, :, None]
    return out
