"""How well a given surface fits a mesh: cleaned, turned to face out, whether it bounds the mesh, how far it is."""

import warnings

import numpy as np

from wct_plugin.core import _core
from wct_plugin.errors import InputError, WctWarning
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.index_arrays import components
from wct_plugin.mesh.triangle_surfaces import normals, surface_edges
from wct_plugin.meshing.reference import Reference
from wct_plugin.types import Bools, Floats, Ints

#: A reference is another body, or in another unit, where both surfaces are farther off than this share of its diagonal.
_ANOTHER = 0.1
#: How deep in or far off the mesh's boundary a chord across a bend could explain, as a fraction of the mesh's edge.
CHORD = 0.25


def check_near(surface: SurfaceMesh, mesh: TetMesh) -> None:
    """Raise :class:`InputError` for a surface that cannot be meant, as it is far from the mesh's boundary, both ways.

    Scans have holes that the mesher closed, and sheets that run on inside: far one way only is no reason.
    """
    boundary = mesh.topology.boundary
    ends, here = mesh.points[np.unique(boundary)], surface.points[np.unique(surface.triangles)]
    off = _core.closest_points(surface.points, surface.triangles, ends)[2].max()
    apart = min(off, _core.closest_points(mesh.points, boundary, here)[2].max())
    if apart > _ANOTHER * surface.diagonal:
        raise InputError(
            f"{surface.source or 'the reference'}: {apart / surface.diagonal:.2g} of its diagonal from the boundary of"
            f" {mesh.source or 'the mesh'}; allowed is {_ANOTHER:g}: it is another body, or in another unit of length"
        )


def clean(surface: SurfaceMesh, exact: float = 0.0) -> SurfaceMesh:
    """The surface with points merged that are equal but for rounding, flat and repeated triangles dropped.

    ``exact``, a length: how exact coordinates are. Points that differ by more than rounding to that may are not merged.

    Raises :class:`InputError` where all of them are flat.
    """
    from scipy.spatial import cKDTree  # here: importing a filter to see its options should not take it

    points, place = np.unique(surface.points, axis=0, return_inverse=True)
    # Rounding moves each coordinate by a step of twice that at most.
    pairs = cKDTree(points).query_pairs(2.0 * np.sqrt(3.0) * exact, output_type="ndarray")
    seam = components(pairs[:, 0], pairs[:, 1], len(points))
    if (apart := len(points) - int(seam.max(initial=-1)) - 1) > 0:
        said = (
            f"{surface.source or 'the reference'}: {apart} points differ from others by rounding only; they are merged"
        )
        warnings.warn(said, WctWarning, stacklevel=2)
    first = np.unique(seam, return_index=True)[1]
    points, triangles = points[first], seam[place.reshape(-1)][surface.triangles]
    area = np.linalg.norm(normals(points, triangles), axis=1)
    sound = area > 1e-14 * surface.diagonal**2
    if not sound.any():
        raise InputError(f"{surface.source or 'the reference'}: all triangles have zero area; at least one must not")
    triangles, tags = triangles[sound], surface.tags[sound]
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    triangles, tags = triangles[np.sort(first)], tags[np.sort(first)]
    used, place = np.unique(triangles, return_inverse=True)
    return SurfaceMesh(points[used], place.reshape(-1, 3), tags)


def facing_out(surface: SurfaceMesh, own: Reference) -> SurfaceMesh:
    """The surface with every triangle turned so that the mesh whose own boundary is ``own`` lies behind it.

    Files run the triangles of a cavity either way, and some run every face its own. What hangs together over edges of
    two triangles is turned as one, as most of its area near the mesh's boundary says.
    """
    count = len(surface.triangles)
    _, owners, starts, sizes, forward = surface_edges(surface.triangles, len(surface.points))
    pairs = starts[sizes == 2]
    first, second = owners[pairs], owners[pairs + 1]
    other = count * (forward[pairs] == forward[pairs + 1])
    # Each triangle is there as it is and, at + count, turned; pieces of this double surface are turned consistently.
    piece = components(
        np.concatenate([first, first + count]), np.concatenate([second + other, second + count - other]), 2 * count
    )

    shell, far = _shell(own, CHORD)
    normal = normals(surface.points, surface.triangles)
    centroids = surface.points[surface.triangles].mean(axis=1)
    _, nearest, apart = _core.closest_points(own.points, shell, centroids)
    outward = normals(own.points, shell)[nearest]
    vote = np.einsum("ij,ij->i", normal, outward / np.linalg.norm(outward, axis=1)[:, None])
    vote[apart > far[nearest]] = 0.0
    votes = np.bincount(piece, np.concatenate([vote, -vote]))
    turned = votes[piece[count:]] > votes[piece[:count]]
    triangles = np.where(turned[:, None], surface.triangles[:, ::-1], surface.triangles)
    return SurfaceMesh(surface.points, triangles, surface.tags)


def bounds(surface: SurfaceMesh, own: Reference, deep: float = CHORD) -> bool:
    """Whether a given surface is the boundary of the mesh whose own boundary is ``own``: closed, and all of it.

    Scans have holes that the mesher closed, and sheets that run on inside the body. Where a facet of either lies deeper
    in or farther off the other than ``deep``, a fraction of the mesh's edge, the surface bounds nothing.
    """
    if open_edges(surface):
        return False
    return bool(near(surface, own, deep).all()) and covers(surface, own, deep)


def open_edges(surface: SurfaceMesh) -> int:
    """How many edges have surface on one side only."""
    return int((surface_edges(surface.triangles, len(surface.points))[3] % 2).sum())


def near(surface: SurfaceMesh, own: Reference, deep: float) -> Bools:
    """(t,) which triangles of the surface are no deeper in or farther off the mesh than ``deep``."""
    shell, far = _shell(own, deep)
    centroids = surface.points[surface.triangles].mean(axis=1)
    _, nearest, in_or_off = _core.closest_points(own.points, shell, centroids)
    within: Bools = in_or_off <= far[nearest]
    return within


def covers(surface: SurfaceMesh, own: Reference, deep: float) -> bool:
    """Whether no facet of the mesh's own boundary is farther off the surface than ``deep``."""
    shell, far = _shell(own, deep)
    _, _, bare = _core.closest_points(surface.points, surface.triangles, own.points[shell].mean(axis=1))
    return bool((bare <= far).all())


def _shell(own: Reference, deep: float) -> tuple[Ints, Floats]:
    """The facets with outside on one side (not sheets within), and ``deep`` of the longest edge round each of them."""
    outer = own.strata.triangles[((own.sides < 0).sum(axis=1) == 1)[own.strata.patch]]
    corners = own.points[outer]
    edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    around = np.zeros(len(own.points))
    np.maximum.at(around, outer.ravel(), np.repeat(edge, 3))
    return outer, deep * around[outer].max(axis=1)


def gap(own: Reference, surface: SurfaceMesh, tolerance: float) -> float:
    """How far the mesh's own boundary is from the surface where it follows it at all, at most half the tolerance.

    Facets beyond the tolerance close a hole of the surface, and those beside them lead there: both follow nothing.
    """
    triangles = own.strata.triangles
    corners = _core.closest_points(surface.points, surface.triangles, own.points)[2][triangles]
    middle = _core.closest_points(surface.points, surface.triangles, own.points[triangles].mean(axis=1))[2]
    far = np.maximum(corners.max(axis=1), middle)
    off = np.zeros(len(own.points), dtype=bool)
    off[triangles[far > tolerance]] = True
    follows = ~off[triangles].any(axis=1)
    return float(min(far[follows].max(initial=0.0), tolerance / 2))


def apart_at(on: Reference, own: Reference) -> Floats:
    """How far the surface ``on`` and the mesh's own boundary are apart, both ways, at each point of the surface (n,).

    At all corners of a triangle it is what it is anywhere on it.
    """
    triangles, own_triangles = on.strata.triangles, own.strata.triangles
    off = _core.closest_points(own.points, own_triangles, on.points)[2]
    far = np.maximum(
        off[triangles].max(axis=1),
        _core.closest_points(own.points, own_triangles, on.points[triangles].mean(axis=1))[2],
    )
    places = np.concatenate([own.points[np.unique(own_triangles)], own.points[own_triangles].mean(axis=1)])
    _, at, back = _core.closest_points(on.points, triangles, places)
    np.maximum.at(far, at, back)
    np.maximum.at(off, triangles, far[:, None])
    return off
