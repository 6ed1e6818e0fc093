"""Whether what was read is a mesh at all: indices in range, finite points, arrays as long as what they belong to."""

from typing import Any

import numpy as np

from benchmarks.fuzz.judge.exact import not_positive


def _indices(what: str, rows: Any, width: int, count: int) -> list[str]:
    rows = np.asarray(rows)
    if rows.ndim != 2 or rows.shape[1] != width or rows.dtype != np.int64:
        return [f"{what} are {rows.dtype} of shape {rows.shape}"]
    if rows.size and (rows.min() < 0 or rows.max() >= count):
        return [f"{what} have an index out of 0..{count - 1}"]
    return []


def _lengths(what: str, arrays: Any, count: int) -> list[str]:
    return [
        f"{what} {name!r} has {len(values)} rows for {count}" for name, values in arrays.items() if len(values) != count
    ]


def _members(what: str, sets: Any, count: int) -> list[str]:
    faults = []
    for name, members in sets.items():
        ids = np.asarray(members)
        if ids.ndim != 1 or ids.dtype.kind not in "iu" or (ids.size and (ids.min() < 0 or ids.max() >= count)):
            faults.append(f"{what} {name!r} has members out of 0..{count - 1}")
    return faults


def faults_of(mesh: Any) -> list[str]:
    """The faults of a mesh of tets or triangles that a reader gave."""
    points = np.asarray(mesh.points)
    if points.dtype != np.float64 or points.ndim != 2 or points.shape[1] != 3:
        return [f"points are {points.dtype} of shape {points.shape}"]
    faults = [] if np.isfinite(points).all() else ["a point is not finite"]
    faults += _lengths("point data", mesh.point_data, len(points))
    if hasattr(mesh, "triangles"):
        faults += _indices("triangles", mesh.triangles, 3, len(points))
        faults += _lengths("tags", {"": mesh.tags}, len(mesh.triangles))
        return faults + _lengths("triangle data", mesh.cell_data, len(mesh.triangles))
    faults += _indices("tets", mesh.tets, 4, len(points))
    for what, cells, width in (("facets", mesh.facets, 3), ("edges", mesh.edges, 2), ("nodes", mesh.nodes, 1)):
        faults += _indices(what, cells.vertices, width, len(points))
        faults += _lengths(f"tags of {what}", {"": cells.tags}, len(cells.vertices))
        faults += _lengths(f"data of {what}", cells.data, len(cells.vertices))
        faults += _members(f"set of {what}", cells.sets, len(cells.vertices))
    faults += _lengths("regions", {"": mesh.regions}, len(mesh.tets))
    faults += _lengths("tet data", mesh.cell_data, len(mesh.tets))
    faults += _members("set of tets", mesh.tet_sets, len(mesh.tets))
    faults += _members("set of points", mesh.point_sets, len(points))
    if faults:
        return faults
    if len(np.unique(mesh.tets)) != len(points):
        faults.append("a point is in no tet")
    if len(np.unique(np.sort(mesh.tets, axis=1), axis=0)) != len(mesh.tets):
        faults.append("a tet is there twice")
    flat = not_positive(points, np.asarray(mesh.tets))
    return faults + ([f"tet {flat[0]} is not positively oriented"] if flat else [])
