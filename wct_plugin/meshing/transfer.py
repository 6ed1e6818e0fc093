"""Carrying what hangs on a mesh over to a resampled one: tags, sets, data, names."""

import warnings
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.core.domain import StratifiedMesh
from wct_plugin.errors import WctWarning
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.index_arrays import find_rows, masks
from wct_plugin.mesh.strata import Strata
from wct_plugin.meshing.reference import Reference
from wct_plugin.types import Floats, Ints


def in_strata_of_mesh(found: StratifiedMesh, on: Reference) -> StratifiedMesh:
    """What the core made of the domain of a reference, in the strata of the mesh that came in, with its region tags."""
    return replace(found, regions=on.regions[found.regions], facet_patch=on.carried[found.facet_patch])


def carry(old: TetMesh, strata: Strata, new: StratifiedMesh) -> TetMesh:
    """Give the ``new`` mesh, as of :func:`in_strata_of_mesh`, the old one's facets and edges, sets, names and data.

    A tagged patch or curve of the surface keeps its tags and sets; tagged vertices go to the new point in their place.
    Point data are interpolated linearly in the old tets. Cell data that are constant on each region stay so, and sets
    that are unions of regions too; others are those of the old tet at the new one's centroid. What cannot be carried
    is named in a :class:`WctWarning`.
    """
    lost = []
    facets = _cells_by_label(old.facets, strata.triangles, strata.patch, new.facets, new.facet_patch)
    edges = _cells_by_label(old.edges, strata.segments, strata.curve, new.creases, new.crease_curve)
    for kind, cells in (("triangle", old.facets), ("edge", old.edges), ("vertex", old.nodes)):
        lost += [f"{kind} data {name!r}" for name in cells.data]
    lost += [f"point set {name!r}" for name in old.point_sets]
    nodes = _nodes(old, new)
    point_data: Mapping[str, NDArray[Any]] = {}
    if old.point_data:
        tet, weights = locate(old, new.points)
        point_data = {
            name: np.einsum("ij,ij...->i...", weights, values[old.tets[tet]])
            for name, values in old.point_data.items()
            if values.dtype.kind == "f"
        }
        lost += [f"point data {name!r}" for name in old.point_data if name not in point_data]
    cell_data, tet_sets = _of_tets(old, new)
    if lost:
        warnings.warn(f"resampling drops {', '.join(lost)}", WctWarning, stacklevel=2)
    return TetMesh(
        new.points,
        new.tets,
        new.regions,
        facets,
        edges,
        nodes,
        point_data,
        cell_data,
        {},
        tet_sets,
        old.names,
        old.tag_name,
        old.reference,
        old.source,
        old.repairs,
        old.periodic,
        second_order=old.second_order,
        region_name=old.region_name,
        element_types=old.element_types,
        mends=False,
    )


def _of_tets(old: TetMesh, new: StratifiedMesh) -> tuple[dict[str, NDArray[Any]], dict[str, Ints]]:
    """Cell data and tet sets of the new mesh."""
    count = len(old.tets)
    inside = masks(old.tet_sets, count)
    columns = [*old.cell_data.values(), *inside.values()]
    if not columns:
        return {}, {}
    _, first, region = np.unique(old.regions, return_index=True, return_inverse=True)
    example = first[np.searchsorted(old.regions[first], new.regions)]  # a tet of the region, for each new tet
    exact = [_same(values, values[first[region.ravel()]]) for values in columns]
    nearest = example if all(exact) else locate(old, new.points[new.tets].mean(axis=1))[0]
    carried = [values[example if alike else nearest] for values, alike in zip(columns, exact, strict=True)]
    found, members = carried[: len(old.cell_data)], carried[len(old.cell_data) :]
    return (
        dict(zip(old.cell_data, found, strict=True)),
        {name: np.flatnonzero(mask) for name, mask in zip(inside, members, strict=True)},
    )


def _same(one: NDArray[Any], other: NDArray[Any]) -> bool:
    return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")


def locate(mesh: TetMesh, queries: Floats) -> tuple[Ints, Floats]:
    """The tet (q,) that holds each query point (q, 3), and the point's barycentric coordinates (q, 4) in it.

    A point outside the mesh gets the tet it is least outside of among those around, its coordinates cut to 0..1.
    """
    from scipy.spatial import cKDTree  # here: importing a filter to see its options should not take it

    corners = mesh.points[mesh.tets]
    inverse = np.linalg.inv((corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1))
    tree = cKDTree(corners.mean(axis=1))
    found = np.zeros(len(queries), dtype=np.int64)
    best = np.full(len(queries), -np.inf)
    weights = np.zeros((len(queries), 4))
    pending, width = np.arange(len(queries)), 8
    while len(pending) and width <= 128:
        near = tree.query(queries[pending], k=min(width, len(mesh.tets)))[1].reshape(len(pending), -1)
        local = np.einsum("qkij,qkj->qki", inverse[near], queries[pending][:, None] - corners[near, 0])
        every = np.concatenate([1.0 - local.sum(axis=2, keepdims=True), local], axis=2)
        least = every.min(axis=2)
        which = least.argmax(axis=1)
        rows = np.arange(len(pending))
        better = least[rows, which] > best[pending]
        chosen = pending[better]
        found[chosen] = near[rows, which][better]
        best[chosen] = least[rows, which][better]
        weights[chosen] = every[rows, which][better]
        pending = pending[best[pending] < -1e-9]
        width *= 4
    weights = np.clip(weights, 0.0, 1.0)
    return found, weights / weights.sum(axis=1, keepdims=True)


def _cells_by_label(tagged: Cells, cells: Ints, label: Ints, new_cells: Ints, new_label: Ints) -> Cells:
    """Tag the new cells of every label that old tagged cells cover; a cell of two tags is there twice, as it was."""
    if not len(tagged):
        return tagged
    width = cells.shape[1]
    points = 1 + max(int(cells.max(initial=0)), int(tagged.vertices.max(initial=0)))
    row = find_rows(np.sort(cells, axis=1), np.sort(tagged.vertices, axis=1), points)
    old_label = np.full(len(tagged), -1, dtype=np.int64)
    old_label[row >= 0] = label[row[row >= 0]]
    rows: list[Ints] = []
    tags: list[Ints] = []
    names = {
        name: set(zip(tagged.tags[members].tolist(), old_label[members].tolist(), strict=True))
        for name, members in tagged.sets.items()
    }
    sets: dict[str, list[Ints]] = {name: [] for name in names}
    count = 0
    for tag in np.unique(tagged.tags).tolist():
        for one in np.unique(old_label[tagged.tags == tag]).tolist():
            if one < 0:
                continue
            members = new_cells[new_label == one]
            rows.append(members)
            tags.append(np.full(len(members), tag, dtype=np.int64))
            for name, pairs in names.items():
                if (tag, one) in pairs:
                    sets[name].append(np.arange(count, count + len(members)))
            count += len(members)
    return Cells(
        np.concatenate([np.empty((0, width), dtype=np.int64), *rows]),
        np.concatenate([np.empty(0, dtype=np.int64), *tags]),
        {},
        {name: np.concatenate([np.empty(0, dtype=np.int64), *parts]) for name, parts in sets.items()},
    )


def _nodes(old: TetMesh, new: StratifiedMesh) -> Cells:
    if not len(old.nodes):
        return old.nodes
    from scipy.spatial import cKDTree

    place = cKDTree(new.points).query(old.points[old.nodes.vertices[:, 0]])[1]
    return Cells(place.reshape(-1, 1).astype(np.int64), old.nodes.tags, {}, old.nodes.sets)
