"""A surface that bounds a mesh only in part, made whole: its holes closed, what runs on inside the body cut off."""

import warnings

import numpy as np

from wct_plugin.adapters.meshlab import run as meshlab
from wct_plugin.core import _core
from wct_plugin.errors import WctWarning
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.index_arrays import components
from wct_plugin.mesh.strata import SPECK
from wct_plugin.mesh.triangle_surfaces import sheets, surface_edges
from wct_plugin.meshing.reference import Reference
from wct_plugin.meshing.reference_fit import bounds, clean, covers, near, open_edges
from wct_plugin.types import Bools, Floats, Ints

#: How far the surface may be from the mesh's boundary, as a fraction of the mesh's edge: in holes and where triangles
#: cross, the mesher had no surface to keep to but took or left whole tets, which is exact to half an edge.
_DEEP = 0.5
#: Of the facets with which the mesher closed holes, so many in specks make a crumple, not a shape to keep.
_CRUMPLED = 0.05
#: Farther from the given surface than this fraction of its diagonal, a triangle is not part of it.
_APART = 1e-6

_CLOSE = "meshing_close_holes"
_UNITE = "generate_boolean_union"


def composite(surface: SurfaceMesh, mesh: TetMesh, own: Reference, tolerance: float) -> SurfaceMesh | None:
    """The surface put together so that it bounds the mesh whose own boundary is ``own``, or None where it does not.

    Pieces that are nowhere near the mesh's boundary go. MeshLab closes the holes, and where that is not all, unites the
    surface with itself, exactly: what has the body on both sides goes, cut along the lines where triangles cross. The
    result is taken if it is a closed manifold with the handles and pieces of the mesh, everywhere near the mesh's own
    boundary and that near it. Fills must be within ``tolerance``, a length, of the mesh's own and these of them, unless
    the mesher only crumpled its facets where they are not; they are warned of. ``surface`` is cleaned. Raises
    :class:`wct_plugin.errors.NeighbourError` where MeshLab fails.
    """
    made = _beside(surface, own)
    if made is None:
        return None
    if rim := open_edges(made):
        made = _made(made, _CLOSE, maxholesize=rim + 1, refinehole=True)
    if np.array_equal(made.triangles, surface.triangles) or not _bounds_alone(made, mesh, own):
        if open_edges(made) or not covers(made, own, _DEEP):  # nor will less of it
            return None
        made = _made(made, _UNITE)
        if not _bounds_alone(made, mesh, own):
            return None
    fill = _pieces(made, _off(made, surface))
    if (fill >= 0).any():
        far = _farthest(made, fill, own, tolerance)
        if far is None:
            return None
        warnings.warn(
            f"the reference has holes, which were closed: up to {far / surface.diagonal:.2e} of the diagonal from the"
            " mesh's own facets",
            WctWarning,
            stacklevel=2,
        )
    return SurfaceMesh(made.points, made.triangles, _tags(made, fill, surface), source=surface.source)


def _beside(surface: SurfaceMesh, own: Reference) -> SurfaceMesh | None:
    """The pieces of the surface that come near the mesh's boundary anywhere, if there are any."""
    _, owners, starts, sizes, _ = surface_edges(surface.triangles, len(surface.points))
    piece = components(owners, np.repeat(owners[starts], sizes), len(surface.triangles))
    kept = surface.triangles[np.isin(piece, piece[near(surface, own, _DEEP)])]
    return SurfaceMesh(surface.points, kept, source=surface.source) if len(kept) else None


def _made(surface: SurfaceMesh, name: str, **arguments: int | bool) -> SurfaceMesh:
    """What one of MeshLab's filters makes of a surface, cleaned."""
    made, _ = meshlab.run(surface, [meshlab.Step(name, f"MeshLab's {name}", dict(arguments))])
    return clean(made)


def _off(made: SurfaceMesh, surface: SurfaceMesh) -> Bools:
    """(t,) which triangles are not part of the given surface: those that fill its holes."""
    apart = _core.closest_points(surface.points, surface.triangles, _centroids(made))[2]
    return apart > _APART * surface.diagonal


def _bounds_alone(made: SurfaceMesh, mesh: TetMesh, own: Reference) -> bool:
    """Whether a surface is the boundary of the mesh, and a sound one."""
    _, _, starts, sizes, forward = surface_edges(made.triangles, len(made.points))
    if (sizes != 2).any() or np.add.reduceat(np.where(forward, 1, -1), starts).any():
        return False
    vertices = int(sheets(made.triangles, len(made.points)).max()) + 1
    if vertices - len(sizes) + len(made.triangles) != _boundary_characteristic(mesh):
        return False
    return bounds(made, own, _DEEP)


def _boundary_characteristic(mesh: TetMesh) -> int:
    """Euler characteristic of the boundary, pulled apart where sheets of it touch: minus twice that of the open inside.

    A region's own, with its boundary as it is, is another number where sheets touch.
    """
    boundary = mesh.topology.boundary
    edges = len(mesh.topology.edges) - len(surface_edges(boundary, len(mesh.points))[0])
    vertices = len(mesh.points) - int(mesh.topology.boundary_points.sum())
    return 2 * (len(mesh.tets) - len(mesh.topology.interior_pairs) + edges - vertices)


def _pieces(made: SurfaceMesh, fill: Bools) -> Ints:
    """(t,) for each of the triangles that fill holes the number of its hole, from 0, and -1 for the others."""
    _, owners, starts, _, _ = surface_edges(made.triangles, len(made.points))
    inside = fill[owners[starts]] & fill[owners[starts + 1]]
    piece = components(owners[starts][inside], owners[starts + 1][inside], len(made.triangles))
    out = np.full(len(fill), -1, dtype=np.int64)
    out[fill] = np.unique(piece[fill], return_inverse=True)[1].reshape(-1)
    return out


def _farthest(made: SurfaceMesh, fill: Ints, own: Reference, tolerance: float) -> float | None:
    """How far fills and the mesh's own facets there are apart; None if beyond the tolerance where no crumple is.

    How much of a fill is specks differs from hole to hole and from one run of a mesher to the next: all the holes where
    the two part are judged together.
    """
    facets = own.strata.triangles
    speck = (np.bincount(own.strata.patch) <= SPECK)[own.strata.patch]
    hole = fill[_core.closest_points(made.points, made.triangles, own.points[facets].mean(axis=1))[1]]
    apart = np.array(
        [
            max(
                _apart(made.points, made.triangles[fill == one], own.points, facets),
                _apart(own.points, facets[hole == one], made.points, made.triangles),
            )
            for one in range(int(fill.max()) + 1)
        ]
    )
    parting = np.flatnonzero(apart > tolerance)
    there = speck[np.isin(hole, parting)]
    if len(parting) and not there.sum() > _CRUMPLED * len(there):
        return None
    return float(apart.max())


def _apart(points: Floats, triangles: Ints, others: Floats, on: Ints) -> float:
    """How far triangles are from those ``on`` other points: of their corners and centroids the farthest."""
    corners = points[triangles]
    samples = np.concatenate([corners.reshape(-1, 3), corners.mean(axis=1)])
    return float(_core.closest_points(others, on, samples)[2].max(initial=0.0))


def _tags(made: SurfaceMesh, fill: Ints, surface: SurfaceMesh) -> Ints:
    """(t,) the tags of the given surface; the fill of a hole gets the one that most of its triangles are nearest to."""
    _, nearest, _ = _core.closest_points(surface.points, surface.triangles, _centroids(made))
    tags = surface.tags[nearest]
    for one in range(int(fill.max()) + 1):
        values, count = np.unique(tags[fill == one], return_counts=True)
        tags[fill == one] = values[np.argmax(count)]
    return tags


def _centroids(surface: SurfaceMesh) -> Floats:
    centroids: Floats = surface.points[surface.triangles].mean(axis=1)
    return centroids
