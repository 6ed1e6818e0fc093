"""Creases of the surface that the search gave up, as :func:`wct_plugin.core._core.search_well_centered` says."""

from dataclasses import replace

import numpy as np

from wct_plugin.measure.released_creases import Released
from wct_plugin.mesh.index_arrays import components, find_rows
from wct_plugin.mesh.triangle_surfaces import pinched, surface_edges
from wct_plugin.meshing.reference import Reference
from wct_plugin.types import Ints


def measure_released(on: Reference, curves: Ints) -> Released:
    """Measure ``curves`` (r,), ids of :class:`wct_plugin.mesh.strata.Strata`."""
    segments = on.strata.segments[np.isin(on.strata.curve, curves)]
    ends = on.points[segments]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    return {"creases": len(curves), "length": float(length / on.diagonal)}


def measure_none(own: Reference) -> Released:
    """What is said of creases that became ordinary surface, where the mesh stays as it is."""
    return measure_released(own, np.empty(0, dtype=np.int64))


def without(on: Reference, curves: Ints, nodes: Ints) -> Reference:
    """The surface with ``curves`` (r,) given up: what the search's labels mean after it released them.

    Patches on either side of one are joined under the smallest of their numbers, all other numbers stay. Corners where
    nothing else meets become ordinary surface, but for ``nodes`` (k,), vertices that are kept.
    """
    if not len(curves):
        return on
    old, count = on.strata, len(on.points)
    gone = np.isin(old.curve, curves)
    edges, owners, starts, _, _ = surface_edges(old.triangles, count)
    across = starts[find_rows(edges, old.segments[gone], count)]  # creases by their angle have a triangle on each side
    group = components(old.patch[owners[across]], old.patch[owners[across + 1]], len(on.sides))
    _, least = np.unique(group, return_index=True)
    patch = least[group][old.patch]

    loose = np.zeros(count, dtype=bool)
    loose[old.segments[gone]] = True
    loose[old.segments[~gone]] = False
    loose[nodes] = False
    loose &= ~pinched(old.triangles, count)
    beside = np.empty(count, dtype=np.int64)
    beside[old.triangles] = patch[:, None]
    stratum = np.where(loose, 1, old.stratum).astype(np.int8)
    strata = replace(
        old,
        patch=patch,
        segments=old.segments[~gone],
        curve=old.curve[~gone],
        soft=old.soft[~gone],
        stratum=stratum,
        label=np.where(stratum == 1, beside, old.label),
    )
    return replace(on, strata=strata, folds=np.vstack([on.folds, old.segments[gone]]))
