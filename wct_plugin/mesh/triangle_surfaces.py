"""Triangle surfaces by themselves: edges, sheets, bends, normals, enclosed volume."""

import numpy as np

from wct_plugin.mesh import unit_scaling
from wct_plugin.mesh.index_arrays import components
from wct_plugin.types import Bools, Floats, Ints

#: The three edges of a triangle, as it winds.
SIDES = np.array([[0, 1], [1, 2], [2, 0]])


def bends(points: Floats, triangles: Ints, label: Ints) -> tuple[Ints, Floats, Bools]:
    """Edges (e, 2) between two triangles, how much the surface bends there in degrees, and if both labels are equal."""
    edges, owners, starts, sizes, forward = surface_edges(triangles, len(points))
    paired = sizes == 2
    first, second = owners[starts[paired]], owners[starts[paired] + 1]
    same_way = forward[starts[paired]] == forward[starts[paired] + 1]
    bend = np.degrees(bend_angles(unit_scaling.normalized(points), triangles, first, second, same_way))
    return edges[paired], bend, label[first] == label[second]


def normals(points: Floats, triangles: Ints) -> Floats:
    """(t, 3) normals of triangles (t, 3) on ``points`` (n, 3), twice their area long."""
    corners = points[triangles]
    out: Floats = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return out


def areas(points: Floats, triangles: Ints) -> Floats:
    """(t,) areas of triangles (t, 3) on ``points`` (n, 3)."""
    out: Floats = np.linalg.norm(normals(points, triangles), axis=1) / 2.0
    return out


def enclosed_volume(points: Floats, triangles: Ints) -> float:
    """Volume inside a closed surface of outward triangles (k, 3) on ``points`` (n, 3); negative if they run inward."""
    corners = points[triangles] - points[triangles].mean(axis=(0, 1))  # near the origin nothing cancels
    return float(np.einsum("ij,ij->", np.cross(corners[:, 0], corners[:, 1]), corners[:, 2]) / 6.0)


def thickness(points: Floats, triangles: Ints) -> float:
    """Extent across the plane that triangles (k, 3) lie nearest to, as a fraction of the diagonal of their box."""
    used = unit_scaling.normalized(points[np.unique(triangles)])
    used = used - used.mean(axis=0)
    _, axes = np.linalg.eigh(used.T @ used)
    return float(np.ptp(used @ axes[:, 0]) / (np.linalg.norm(np.ptp(used, axis=0)) or 1.0))


def surface_edges(triangles: Ints, count: int) -> tuple[Ints, Ints, Ints, Ints, Bools]:
    """Every edge (e, 2) once, and its triangles: ``owners[starts[k] : starts[k] + sizes[k]]``.

    ``forward`` goes with ``owners``: does the triangle run through the edge from its smaller end to its larger?
    """
    ends = triangles[:, SIDES].reshape(-1, 2)
    forward = ends[:, 0] < ends[:, 1]
    ends = np.sort(ends, axis=1)
    keys = ends @ [count, 1]
    order = np.argsort(keys, kind="stable")
    _, starts, sizes = np.unique(keys[order], return_index=True, return_counts=True)
    return ends[order[starts]], order // 3, starts, sizes, forward[order]


def bend_angles(points: Floats, triangles: Ints, first: Ints, second: Ints, same_way: Bools) -> Floats:
    """Angle in radians between two triangles' normals; they disagree on a side where both run the same way."""
    across = normals(points, triangles)
    a, b = across[first], across[second] * np.where(same_way, -1.0, 1.0)[:, None]
    return angle_between(a, b)


def angle_between(a: Floats, b: Floats) -> Floats:
    """Angle in radians between the rows of (k, 3) and (k, 3), accurate near 0 and pi."""
    angle: Floats = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ij,ij->i", a, b))
    return angle


def turned_triangles(first: Ints, second: Ints, same_way: Bools, patch: Ints) -> Bools:
    """(t,) which triangles have to be turned over for every patch (t,) to wind as its first triangle does.

    Triangles ``first[k]`` and ``second[k]`` share an edge, and run through it the ``same_way`` where they disagree on
    a side. A patch with one side only, like a Moebius strip, stays as it is.
    """
    count = len(patch)
    if not same_way.any():
        return np.zeros(count, dtype=bool)
    # Node t stands for the triangle as it is and t + count for the triangle turned over: linked are those that agree.
    other = second + count * same_way
    sheet = components(
        np.concatenate([first, first + count]), np.concatenate([other, (other + count) % (2 * count)]), 2 * count
    )
    leader = np.unique(patch, return_index=True)[1][patch]
    out: Bools = (sheet[:count] != sheet[leader]) & (sheet[count:] == sheet[leader])
    return out


def pinched(triangles: Ints, count: int) -> Bools:
    """(count,) vertices of triangles (t, 3) where several sheets touch without sharing an edge."""
    return on_several_sheets(triangles, sheets(triangles, count), count)


def sheets(triangles: Ints, count: int) -> Ints:
    """(3 t,) a number per corner of triangles (t, 3), from 0, equal round a vertex where they share edges there."""
    edges, owners, starts, sizes, _ = surface_edges(triangles, count)
    return sheets_of_edges(triangles, owners, starts, sizes, edges)


def on_several_sheets(triangles: Ints, sheet: Ints, count: int) -> Bools:
    """(count,) which vertices have corners of several sheets."""
    _, one = np.unique(sheet, return_index=True)
    several: Bools = np.bincount(triangles.ravel()[one], minlength=count) > 1
    return several


def sheets_of_edges(triangles: Ints, owners: Ints, starts: Ints, sizes: Ints, edges: Ints) -> Ints:
    """The same from :func:`surface_edges`."""
    follows = np.ones(len(owners), dtype=bool)
    follows[starts] = False  # link each triangle of an edge to the one before it
    later = np.flatnonzero(follows)
    edge = np.repeat(np.arange(len(edges)), sizes)[later]
    links = []
    for end in edges[edge].T:
        links.append(
            [3 * t + np.argmax(triangles[t] == end[:, None], axis=1) for t in (owners[later], owners[later - 1])]
        )
    rows, columns = np.concatenate(links, axis=1)
    return components(rows, columns, 3 * len(triangles))
