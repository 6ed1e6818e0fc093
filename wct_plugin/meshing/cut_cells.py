"""Meshes put together, and their tagged cells where vertices have several copies, as on either side of a cut."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.topology import EDGES, FACETS
from wct_plugin.types import Ints


def together(parts: Sequence[TetMesh]) -> TetMesh:
    """Meshes that share no vertex as one; they have the same data and sets."""
    first = parts[0]
    points = np.cumsum([0, *(len(one.points) for one in parts)])
    tets = np.cumsum([0, *(len(one.tets) for one in parts)])
    facets, edges, nodes = (
        _cells_together([getattr(one, kind) for one in parts], points) for kind in ("facets", "edges", "nodes")
    )
    return replace(
        first,
        points=np.concatenate([one.points for one in parts]),
        tets=np.concatenate([one.tets + at for one, at in zip(parts, points[:-1], strict=True)]),
        regions=np.concatenate([one.regions for one in parts]),
        facets=facets,
        edges=edges,
        nodes=nodes,
        point_data={name: np.concatenate([one.point_data[name] for one in parts]) for name in first.point_data},
        cell_data={name: np.concatenate([one.cell_data[name] for one in parts]) for name in first.cell_data},
        tet_sets={
            name: np.concatenate([one.tet_sets[name] + at for one, at in zip(parts, tets[:-1], strict=True)])
            for name in first.tet_sets
        },
    )


def _cells_together(parts: Sequence[Cells], points: Ints) -> Cells:
    starts = np.cumsum([0, *(len(one) for one in parts)])
    return Cells(
        np.concatenate([one.vertices + at for one, at in zip(parts, points[:-1], strict=True)]),
        np.concatenate([one.tags for one in parts]),
        {},
        {
            name: np.concatenate([one.sets[name] + at for one, at in zip(parts, starts[:-1], strict=True)])
            for name in parts[0].sets
        },
    )


def copies(cells: Ints, whole: Ints, tets: Ints, origin: Ints) -> tuple[Ints, Ints]:
    """Row of ``cells`` (k, d) and copy of it (c, d), for every copy in the cut ``tets`` of those ``whole`` (m, 4).

    Ascending by row and copy; the corners of a copy are in the order of its cell's.
    """
    count, width = len(origin), cells.shape[1]
    corners = {1: np.arange(4)[:, None], 2: EDGES, 3: FACETS}[width]
    touched = np.zeros(count, dtype=bool)
    touched[cells] = True
    near = touched[whole].sum(axis=1) >= width
    order = np.argsort(cells, axis=1)
    distinct = np.unique(np.take_along_axis(cells, order, axis=1), axis=0)
    row = find_rows(distinct, np.sort(whole[near][:, corners].reshape(-1, width), axis=1), count)
    ascending = np.sort(tets[near][:, corners].reshape(-1, width), axis=1)  # as their origins, which ascend with them
    found = np.unique(np.column_stack([row, ascending])[row >= 0], axis=0)
    starts = np.searchsorted(found[:, 0], np.arange(len(distinct) + 1))
    of = find_rows(distinct, np.take_along_axis(cells, order, axis=1), count)
    sizes = starts[of + 1] - starts[of]
    rows = np.repeat(np.arange(len(cells)), sizes)
    at = np.repeat(starts[of] - np.cumsum(sizes) + sizes, sizes) + np.arange(int(sizes.sum()))
    out = np.empty((len(rows), width), dtype=np.int64)
    np.put_along_axis(out, order[rows], found[at, 1:], axis=1)
    return rows, out


def copied_edges(old: TetMesh, joined: Ints, whole: TetMesh, tets: Ints, origin: Ints) -> Cells:
    """Tagged edges: all copies of them where the old mesh had a tag on several, one where it had not."""
    edges = whole.edges
    if not len(edges):
        return edges
    before = np.column_stack([old.edges.tags, np.sort(joined[old.edges.vertices], axis=1)])
    kinds, sizes = np.unique(before, axis=0, return_counts=True)
    twice = np.unique(kinds[sizes > 1, 0])
    ascending = np.column_stack([edges.tags, np.sort(edges.vertices, axis=1)])
    once = np.zeros(len(edges), dtype=bool)
    once[np.unique(ascending, axis=0, return_index=True)[1]] = True
    edges = edges.select(once)
    rows, made = copies(edges.vertices, whole.tets, tets, origin)
    keep = np.ones(len(rows), dtype=bool)
    keep[1:] = (rows[1:] != rows[:-1]) | np.isin(edges.tags[rows[1:]], twice)
    return repeated(edges, rows[keep], made[keep])


def copied_nodes(nodes: Cells, whole: TetMesh, tets: Ints, origin: Ints) -> Cells:
    """Tagged vertices; those in one place go to the copies there in turn."""
    if not len(nodes):
        return nodes
    rows, made = copies(nodes.vertices, whole.tets, tets, origin)
    starts = np.searchsorted(rows, np.arange(len(nodes) + 1))
    turn: dict[int, int] = {}
    at = []
    for k, vertex in enumerate(nodes.vertices[:, 0].tolist()):
        turn[vertex] = turn.get(vertex, -1) + 1
        at.append(starts[k] + min(turn[vertex], starts[k + 1] - starts[k] - 1))
    return replace(nodes, vertices=made[at])


def repeated(cells: Cells, rows: Ints, vertices: Ints) -> Cells:
    """Cells with the ``vertices`` (c, d), each with the tags and sets of one of the ``rows`` (c,)."""
    sets = {name: np.flatnonzero(np.isin(rows, members)) for name, members in cells.sets.items()}
    return Cells(vertices, cells.tags[rows], {}, sets)
