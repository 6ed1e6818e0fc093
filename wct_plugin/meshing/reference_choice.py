"""Which surface a resampled boundary follows: the one given, cut along the mesh's tags, or else the mesh's own."""

import warnings

import numpy as np

from wct_plugin.core import _core
from wct_plugin.errors import NeighbourError, WctWarning
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.strata import labelled_surface, surface_strata
from wct_plugin.mesh.triangle_surfaces import areas, bends
from wct_plugin.meshing.reference import TOLERANCE, Reference, given_surface
from wct_plugin.meshing.reference_fit import bounds, clean, facing_out
from wct_plugin.meshing.reference_repair import composite
from wct_plugin.types import Bools, Floats, Ints

#: The area of a group of tagged facets on the reference may differ by this much from that of the mesh's own facets.
_AREA = 0.1


def choose(
    mesh: TetMesh,
    own: Reference,
    surface: SurfaceMesh,
    crease_angle: float,
    tolerance: float | None,
    exact: float = 0.0,
) -> tuple[Reference, str]:
    """The reference to follow: ``surface``, or the mesh's ``own`` and why.

    A mesh of one region without tags takes the surface as it is, or made whole where it bounds the mesh only in part.
    Facets tagged on the boundary cut it: every triangle of the surface gets the tags of the nearest facet, if the
    borders between tags then run where they do on the mesh. ``exact``: of the surface, as of :func:`clean`.
    """
    if len(own.regions) > 1:
        return own, "the mesh has several regions"
    if len(mesh.edges) or len(mesh.nodes):
        return own, "the mesh has tagged edges or vertices"
    triangles, label = labelled_surface(mesh)
    if len(triangles) > len(mesh.topology.boundary):
        return own, "the mesh has tagged facets inside"
    whole, apart = facing_out(clean(surface, exact), own), (tolerance or TOLERANCE) * surface.diagonal
    if not bounds(whole, own):
        partly = "it does not bound the mesh, but has holes, or lies inside or apart from it in places"
        try:
            mended = composite(whole, mesh, own, apart)
        except NeighbourError as error:
            return own, f"{partly}, and {error}"
        if mended is None:
            return own, partly
        whole = mended
    if not len(mesh.facets):
        return given_surface(whole, mesh, crease_angle), ""
    cut = _cut(whole, mesh, own, label, crease_angle, apart)
    return (cut, "") if cut else (own, "tags of the mesh change where the surface has no edges to follow")


def warn_of_own_facets(reason: str) -> None:
    """Say that the mesh's own surface is followed, and why."""
    said = f"the boundary is resampled on the mesh's own facets, not on the reference: {reason}"
    warnings.warn(said, WctWarning, stacklevel=3)


def _cut(
    surface: SurfaceMesh, mesh: TetMesh, own: Reference, label: Ints, crease_angle: float, tolerance: float
) -> Reference | None:
    """The surface with a crease wherever the tags change, or None where that does not fit the mesh."""
    centroids = surface.points[surface.triangles].mean(axis=1)
    _, nearest, _ = _core.closest_points(mesh.points, own.strata.triangles, centroids)
    taken = label[nearest]
    sums = [
        np.bincount(one, areas(points, triangles), minlength=int(label.max()) + 1)
        for one, points, triangles in (
            (taken, surface.points, surface.triangles),
            (label, mesh.points, own.strata.triangles),
        )
    ]
    if (np.abs(sums[0] - sums[1]) > _AREA * sums[1]).any():
        return None
    both = np.unique(np.column_stack([surface.tags, taken]), axis=0, return_inverse=True)[1].reshape(-1)
    strata = surface_strata(SurfaceMesh(surface.points, surface.triangles, both), crease_angle)
    border, sharp = _borders(surface.points, surface.triangles, taken, crease_angle)
    own_border, _ = _borders(mesh.points, own.strata.triangles, label, crease_angle)
    # A border along a crease adds none. Elsewhere it must run where the mesh has it, or it would be jagged.
    slack = max(tolerance, own.auto_tolerance() * own.diagonal)
    if _farthest(surface.points, border[~sharp], mesh.points, own_border) > tolerance:
        return None
    if _farthest(mesh.points, own_border, surface.points, border) > 2.0 * slack:
        return None
    patches = int(strata.patch.max()) + 1
    carried = np.zeros(patches, dtype=np.int64)
    of_label = np.zeros(int(label.max()) + 1, dtype=np.int64)
    of_label[label[::-1]] = own.strata.patch[::-1]
    carried[strata.patch] = of_label[taken]
    return Reference(surface.points, strata, np.tile([0, -1], (patches, 1)), own.regions, carried)


def _borders(points: Floats, triangles: Ints, label: Ints, crease_angle: float) -> tuple[Ints, Bools]:
    """Edges (e, 2) between triangles of different labels, and which of them bend by more than ``crease_angle``."""
    edges, bend, same = bends(points, triangles, label)
    return edges[~same], bend[~same] > crease_angle


def _farthest(points: Floats, edges: Ints, on: Floats, segments: Ints) -> float:
    """Farthest that sample points of ``edges`` are from ``segments``; 0 without edges, infinite without segments."""
    if not len(edges):
        return 0.0
    if not len(segments):
        return np.inf
    along = np.linspace(0.0, 1.0, 5)[:, None, None]
    samples = (points[edges[:, 0]] * (1.0 - along) + points[edges[:, 1]] * along).reshape(-1, 3)
    flat = np.column_stack([segments, segments[:, 1]])  # a segment is a triangle with two corners in one place
    return float(_core.closest_points(on, flat, samples)[2].max())
