"""The surface that is followed, where it is another than the mesh's own: its outside, volumes and areas on it."""

import numpy as np

from wct_plugin.measure.conserved import group_names
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.triangle_surfaces import areas, normals
from wct_plugin.meshing.reference import Reference
from wct_plugin.types import Bools, Floats, Ints

#: A patch is planar where the sum of its facets as vectors is as long as their areas together, but for so much.
_PLANAR = 1.0 - 1e-6


def outer(on: Reference) -> SurfaceMesh:
    """The part of a surface that has outside on one side."""
    outside = (on.sides < 0).sum(axis=1) == 1
    return SurfaceMesh(on.points, on.strata.triangles[outside[on.strata.patch]])


def enclosed_volumes(on: Reference) -> dict[str, float]:
    """By region tag, the volume between the surface's sides."""
    corners = on.points[on.strata.triangles] - on.points[on.strata.triangles].mean(axis=(0, 1))
    cones = np.einsum("ij,ij->i", np.cross(corners[:, 0], corners[:, 1]), corners[:, 2]) / 6.0
    behind, before = on.sides[on.strata.patch].T
    count = len(on.regions)
    volume = np.bincount(behind[behind >= 0], cones[behind >= 0], minlength=count)
    volume -= np.bincount(before[before >= 0], cones[before >= 0], minlength=count)
    return {str(tag): float(one) for tag, one in zip(on.regions, volume, strict=True)}


def region_volumes(on: Reference) -> Floats | None:
    """(regions,) of :func:`enclosed_volumes`; None where the surface encloses none, as one with holes may."""
    enclosed = np.array(list(enclosed_volumes(on).values()))
    return enclosed if (enclosed > 0.0).all() else None


def stretch(mesh: TetMesh, own: Reference, on: Reference) -> dict[str, float]:
    """By group of tagged facets, its area on the surface that is followed over that on the mesh's own facets."""
    on_area, own_area = patch_areas(on), patch_areas(own)
    out = {}
    for name, patches in patches_of_groups(mesh, own).items():
        area = float(own_area[patches].sum())
        if area:
            out[name] = float(on_area[np.isin(on.carried, patches)].sum()) / area
    return out


def patches_of_groups(mesh: TetMesh, own: Reference) -> dict[str, Ints]:
    """By group of tagged facets of the mesh, the patches of its own surface that it is."""
    if not len(mesh.facets):
        return {}
    row = find_rows(np.sort(own.strata.triangles, axis=1), np.sort(mesh.facets.vertices, axis=1), len(mesh.points))
    return {
        name: np.unique(own.strata.patch[row[member & (row >= 0)]])
        for name, member in group_names(mesh, mesh.facets).items()
    }


def planar_patches(on: Reference, area: Floats) -> Bools:
    """(patches,) which are planar; ``area`` (patches,) of each."""
    vectors = normals(on.points, on.strata.triangles) / 2.0
    sums = [np.bincount(on.strata.patch, axis, minlength=len(on.sides)) for axis in vectors.T]
    planar: Bools = np.linalg.norm(sums, axis=0) > _PLANAR * area
    return planar


def patch_areas(on: Reference) -> Floats:
    """(patches,) the area of each patch."""
    area = areas(on.points, on.strata.triangles)
    return np.asarray(np.bincount(on.strata.patch, area, minlength=len(on.sides)), dtype=np.float64)
