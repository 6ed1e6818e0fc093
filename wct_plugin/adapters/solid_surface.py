"""Can a surface be filled? Points welded, planar, repeated or collapsed triangles, open edges, and hollow shells."""

from dataclasses import dataclass

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.exact import predicates
from wct_plugin.mesh import SurfaceMesh
from wct_plugin.mesh.index_arrays import components
from wct_plugin.mesh.mesh import and_more, show_row
from wct_plugin.mesh.triangle_surfaces import enclosed_volume, surface_edges, thickness
from wct_plugin.types import Floats, Ints

_FLAT = 1e-9  # thickness over diagonal below which a surface counts as planar


def check_thick(surface: SurfaceMesh, who: str) -> None:
    """Raise :class:`InputError` for a planar surface: meshers die on one, so that ``who`` is not asked."""
    thick = thickness(surface.points, surface.triangles)
    if thick <= _FLAT:
        raise InputError(
            f"{label(surface)}the surface is planar, {thick:.1e} of its diagonal thick; "
            f"{who} needs one that encloses a volume"
        )


def weld(surface: SurfaceMesh) -> tuple[Floats, Ints]:
    """The points (n, 3) that triangles use, each place once, and the triangles (k, 3) on them.

    Raises :class:`InputError` for a triangle with two corners in one place, and for one that repeats another.
    """
    corners = surface.points[surface.triangles].reshape(-1, 3) + 0.0  # no negative zeros
    points, inverse = np.unique(corners, axis=0, return_inverse=True)
    triangles = inverse.reshape(-1, 3).astype(np.int64)
    ordered = np.sort(triangles, axis=1)
    same = ordered[:, 1:] == ordered[:, :-1]
    collapsed = np.flatnonzero(same.any(axis=1))
    if len(collapsed):
        double = points[ordered[collapsed[0], np.argmax(same[collapsed[0]])]]
        raise InputError(
            f"{label(surface)}triangle {collapsed[0]} has two corners at {show_row(double)}{and_more(collapsed)}; "
            "its three corners must differ"
        )
    _, first, inverse = np.unique(ordered, axis=0, return_index=True, return_inverse=True)
    repeats = np.flatnonzero(first[inverse.ravel()] != np.arange(len(ordered)))
    if len(repeats):
        twin = first[inverse.ravel()[repeats[0]]]
        where = show_row(points[triangles[twin]].mean(axis=0))
        raise InputError(
            f"{label(surface)}triangle {repeats[0]} repeats triangle {twin}, at {where}{and_more(repeats)}; "
            "each may occur once"
        )
    return points, triangles


def open_edge(points: Floats, triangles: Ints) -> str | None:
    """A description of the first edge that is a side of one triangle only, or None where there is none."""
    edges, owners, starts, sizes, _ = surface_edges(triangles, len(points))
    single = np.flatnonzero(sizes == 1)
    if not len(single):
        return None
    start, end = points[edges[single[0]]]
    one = int(owners[starts[single[0]]])
    return f"the edge from {show_row(start)} to {show_row(end)} is a side of triangle {one} only{and_more(single)}"


def flat_pieces(points: Floats, triangles: Ints, tags: Ints) -> Ints:
    """(k,) a number per triangle, from 0, equal for neighbours of one tag that are coplanar, exactly."""
    edges, owners, starts, sizes, _ = surface_edges(triangles, len(points))
    pair = starts[sizes == 2]
    first, second = owners[pair], owners[pair + 1]
    apex = triangles[second].sum(axis=1) - edges[sizes == 2].sum(axis=1)  # of the second, the corner off the edge
    flat = predicates.orientation(points, np.column_stack([triangles[first], apex])) == 0
    flat &= tags[first] == tags[second]
    return components(first[flat], second[flat], len(triangles))


@dataclass(frozen=True, eq=False)
class Shell:
    """A closed piece of a surface, no edge of it with other than two triangles, all facing the same side."""

    corners: Floats  #: (k, 3, 3)
    volume: float  #: negative where the triangles face inward

    def encloses(self, point: Floats) -> bool:
        """Is ``point`` (3,) inside? By the solid angle under which the shell is seen from there."""
        a, b, c = np.moveaxis(self.corners - point, 1, 0)
        la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        products = [np.einsum("ij,ij->i", first, second) for first, second in ((a, b), (b, c), (c, a))]
        height = np.einsum("ij,ij->i", np.cross(a, b), c)
        angle = np.arctan2(height, la * lb * lc + products[0] * lc + products[1] * la + products[2] * lb)
        return bool(abs(angle.sum()) > np.pi)  # 2 pi inside, 0 outside: half the solid angle


def shells(points: Floats, triangles: Ints) -> list[Shell]:
    """The closed, oriented pieces of a surface; pieces with open edges or more than two triangles at one are none."""
    _, owners, starts, sizes, forward = surface_edges(triangles, len(points))
    turns = np.add.reduceat(np.where(forward, 1, -1), starts)
    sound = (sizes == 2) & (turns == 0)
    leader = np.repeat(owners[starts], sizes)  # every triangle of an edge is joined to the first
    piece = components(leader, owners, len(triangles))
    bad = piece[owners[starts[~sound]]]
    members = [np.flatnonzero(piece == one) for one in np.setdiff1d(piece, bad)]
    return [Shell(points[triangles[own]], enclosed_volume(points, triangles[own])) for own in members]


def in_cavity(point: Floats, walls: list[Shell]) -> bool:
    """Whether ``point`` (3,) lies in a hollow: the smallest shell around it faces inward."""
    around = [wall.volume for wall in walls if wall.encloses(point)]
    return bool(around) and min(around, key=abs) < 0


def label(surface: SurfaceMesh) -> str:
    """What a message about the surface begins with."""
    return f"{surface.source}: " if surface.source else ""
