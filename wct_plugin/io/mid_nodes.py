"""Tets of second order as files have them: nodes in the middle of edges after all others, with values of their own."""

from pathlib import Path

import numpy as np

from wct_plugin.errors import OptionError, OutputError
from wct_plugin.io import beside_tets
from wct_plugin.io.formats import FORMATS, Format
from wct_plugin.io.meshio_writers import Content
from wct_plugin.mesh import SurfaceMesh, TetMesh, cell_kinds
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.mid_nodes import find_middles
from wct_plugin.types import Ints

#: Kinds that get mid nodes.
_RAISED = ("tetra", "triangle", "line")
#: Kinds that have none in a format.
_STAYS = (("line", "Nastran"),)


def check_order(path: str | Path, form: Format, order: int | None, *, volume: bool) -> None:
    """Raise :class:`OptionError` for orders that there are not, :class:`OutputError` where the format has them not."""
    if order not in (None, 1, 2):
        raise OptionError(f"option 'order' is {order!r}; allowed are 1 and 2")
    if order == 2 and not volume:
        raise OptionError(f"{path}: option 'order' is for tets; a surface has order 1")
    if order == 2 and not form.second_order:
        able = " ".join(suffix for one in FORMATS if one.second_order for suffix in one.suffixes)
        raise OutputError(f"{path}: {form.name} cannot carry cells of order 2; allowed are {able}")


def are_wanted(path: str | Path, form: Format, mesh: TetMesh | SurfaceMesh, order: int | None) -> bool:
    """Whether mid nodes are to be written; raises as :func:`check_order`, and for cells beside tets of order 1."""
    check_order(path, form, order, volume=isinstance(mesh, TetMesh))
    if not isinstance(mesh, TetMesh):
        return False
    straight = [kind for kind in (mesh.others.volumes if mesh.others else {}) if kind == cell_kinds.base(kind)]
    if order == 2 and straight and mesh.second_order is None:
        raise OutputError(f"{path}: tets of order 2 do not fit the {straight[0]} cells beside them, which have order 1")
    return form.second_order and (order == 2 or (order is None and mesh.second_order is not None))


def put(content: Content, mesh: TetMesh, form: Format) -> str:
    """Give tets, triangles and lines of the content mid nodes, new points with values; says how many are where."""
    made = find_middles(mesh)
    raised = [kind for kind, _ in content.cells if kind in _RAISED and (kind, form.name) not in _STAYS]
    rows = np.concatenate([_edges(kind, cells) for kind, cells in content.cells if kind in raised])
    edges = np.unique(np.sort(rows, axis=1), axis=0)
    count = len(content.points)
    node = _of_other_cells(mesh, edges, count)
    new = np.flatnonzero(node < 0)
    node[new] = count + np.arange(len(new))
    ends = edges[new]
    middles = content.points[ends].mean(axis=1)
    at = find_rows(mesh.topology.edges, ends, count)
    middles[at >= 0] = made.points[at[at >= 0]]
    content.points = np.concatenate([content.points, middles])
    for name, values in content.point_data.items():
        one, other = values[ends[:, 0]], values[ends[:, 1]]
        between = (0.5 * one + 0.5 * other).astype(values.dtype) if values.dtype.kind == "f" else one * (one == other)
        content.point_data[name] = np.concatenate([values, between.astype(values.dtype)])
    inner = np.zeros(count, dtype=bool)
    inner[: len(mesh.points)] = ~mesh.topology.boundary_points
    on_boundary = find_rows(_edges("triangle", mesh.topology.boundary), ends, count) >= 0
    for name, members in content.point_sets.items():
        has = np.zeros(count, dtype=bool)
        has[members] = True
        both = has[ends].all(axis=1) & (on_boundary | has[inner].any())
        content.point_sets[name] = np.concatenate([members, node[new[both]]])
    for k, (kind, cells) in enumerate(content.cells):
        if kind in raised:
            row = find_rows(edges, np.sort(_edges(kind, cells), axis=1), count)
            middle = node[row].reshape(len(cells), -1)
            content.cells[k] = cell_kinds.second_order(kind), np.column_stack([cells, middle])
    content.groups = {
        cell_kinds.second_order(kind) if kind in raised else kind: groups for kind, groups in content.groups.items()
    }
    return made.describe(len(new))


def _edges(kind: str, cells: Ints) -> Ints:
    """(k e, 2) the edges of cells, ends as the cell has them."""
    return cells[:, np.array(cell_kinds.EDGES[kind])].reshape(-1, 2)


def _of_other_cells(mesh: TetMesh, edges: Ints, count: int) -> Ints:
    """(e,) the mid node that other cells have on an edge already, or -1."""
    node = np.full(len(edges), -1, dtype=np.int64)
    for kind, cells in beside_tets.cells_of(mesh).items():
        plain = cell_kinds.base(kind)
        if cell_kinds.is_second_order(kind) and plain in cell_kinds.EDGES:
            ends = np.sort(_edges(plain, cells.vertices), axis=1)
            first, many = cell_kinds.corners(kind), len(cell_kinds.EDGES[plain])
            row = find_rows(ends, edges, count)
            node[row >= 0] = cells.vertices[:, first : first + many].ravel()[row[row >= 0]]
    return node
