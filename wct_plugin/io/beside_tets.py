"""All of a mesh on one array of points, as files have it: the points of the tets, then those that only others use."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh
from wct_plugin.mesh.other_cells import OtherCells
from wct_plugin.types import Floats, Ints


def points_of(mesh: TetMesh | SurfaceMesh) -> Floats:
    """(n + a, 3) the points of the tets, then those of other cells alone."""
    others = _others(mesh)
    return np.array(mesh.points) if others is None else np.concatenate([mesh.points, others.points[others.shared < 0]])


def place_of(mesh: TetMesh) -> Ints:
    """(p,) where the points of the other cells are in :func:`points_of`; none without."""
    if mesh.others is None:
        return np.empty(0, dtype=np.int64)
    alone = mesh.others.shared < 0
    return np.where(alone, len(mesh.points) + np.cumsum(alone) - 1, mesh.others.shared)


def cells_of(mesh: TetMesh) -> dict[str, Cells]:
    """The other cells by kind, on :func:`points_of`."""
    if mesh.others is None:
        return {}
    place = place_of(mesh)
    return {
        kind: Cells(place[cells.vertices], cells.tags, cells.data, cells.sets)
        for kind, cells in mesh.others.cells.items()
    }


def tagged_cells(mesh: TetMesh) -> dict[str, Cells]:
    """All cells but the tets by kind, on :func:`points_of`: what is tagged on tets with the other cells of its kind."""
    beside = cells_of(mesh)
    own = {"triangle": mesh.facets, "line": mesh.edges, "vertex": mesh.nodes}
    every = {kind: together(cells, beside.pop(kind, None)) for kind, cells in own.items()} | beside
    return {kind: cells for kind, cells in every.items() if len(cells)}


def together(first: Cells, second: Cells | None) -> Cells:
    """Cells of one kind as one, with zeros (NaN in floats) where only the others have an array."""
    if second is None:
        return first
    data = {}
    for name in dict.fromkeys([*first.data, *second.data]):
        columns = [_filled(cells.data.get(name), like, len(cells)) for cells, like in _both(first, second, name)]
        data[name] = np.concatenate(columns)
    sets = {
        name: first.sets.get(name, np.empty(0, dtype=np.int64)) for name in dict.fromkeys([*first.sets, *second.sets])
    }
    for name, members in second.sets.items():
        sets[name] = np.concatenate([sets[name], members + len(first)])
    vertices = np.concatenate([first.vertices, second.vertices])
    return Cells(vertices, np.concatenate([first.tags, second.tags]), data, sets)


def point_data_of(mesh: TetMesh | SurfaceMesh) -> dict[str, NDArray[Any]]:
    """The point data on :func:`points_of`."""
    others = _others(mesh)
    if others is None:
        return dict(mesh.point_data)
    out = {}
    for name in dict.fromkeys([*mesh.point_data, *others.point_data]):
        own, theirs = mesh.point_data.get(name), others.point_data.get(name)
        like = own if own is not None else theirs
        rest = None if theirs is None else theirs[others.shared < 0]
        count = int((others.shared < 0).sum())
        out[name] = np.concatenate([_filled(own, like, len(mesh.points)), _filled(rest, like, count)])
    return out


def point_sets_of(mesh: TetMesh) -> dict[str, Ints]:
    """The point sets on :func:`points_of`."""
    sets = dict(mesh.point_sets)
    if mesh.others is not None:
        place = place_of(mesh)
        for name, members in mesh.others.point_sets.items():
            sets[name] = np.union1d(sets.get(name, np.empty(0, dtype=np.int64)), place[members])
    return sets


def _others(mesh: TetMesh | SurfaceMesh) -> OtherCells | None:
    return mesh.others if isinstance(mesh, TetMesh) else None


def _both(first: Cells, second: Cells, name: str) -> list[tuple[Cells, Any]]:
    like = first.data.get(name)
    like = second.data[name] if like is None else like
    return [(first, like), (second, like)]


def _filled(values: NDArray[Any] | None, like: Any, count: int) -> NDArray[Any]:
    """The values, or as many fillers as an array like the other one has."""
    if values is not None:
        return values
    return np.full((count, *like.shape[1:]), np.nan if like.dtype.kind == "f" else 0, dtype=like.dtype)
