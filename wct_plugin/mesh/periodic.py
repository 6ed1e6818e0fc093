"""Facets of the boundary that are translates of others, as on the sides of a periodic cell."""

from typing import NamedTuple

import numpy as np

from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.mesh import TetMesh
from wct_plugin.mesh.strata import find_strata
from wct_plugin.mesh.triangle_surfaces import normals
from wct_plugin.types import Floats, Ints

#: As near are points that are meant to be translates, in diagonals.
_NEAR = 1e-9


class PeriodicPair(NamedTuple):
    """Facets and their translates."""

    master: Ints  #: (k, 3)
    slave: Ints  #: (k, 3)
    vertices: Ints  #: (m, 2) each vertex of the master, and where it is translated to
    translation: Floats  #: (3,)


def find_periodic(mesh: TetMesh) -> list[PeriodicPair]:
    """Pairs of flat patches of the boundary that are translates of each other and face opposite ways."""
    of = find_strata(mesh)
    boundary = mesh.topology.boundary
    patch = of.patch[: len(boundary)]
    facing = normals(mesh.points, boundary)
    facing = facing / np.linalg.norm(facing, axis=1, keepdims=True)
    sides: list[tuple[Ints, Ints, Floats]] = []
    for one in np.unique(patch):
        rows = np.flatnonzero(patch == one)
        if np.abs(facing[rows] - facing[rows[0]]).max() < np.sqrt(_NEAR):
            sides.append((boundary[rows], np.unique(boundary[rows]), facing[rows[0]]))
    found: list[PeriodicPair] = []
    taken: set[int] = set()
    for k, (master, own, normal) in enumerate(sides):
        for other in range(k + 1, len(sides)):
            slave, there, opposite = sides[other]
            if other in taken or k in taken or np.abs(normal + opposite).max() > np.sqrt(_NEAR):
                continue
            pair = _matched(mesh, master, own, slave, there)
            if pair is not None:
                found.append(pair)
                taken |= {k, other}
    return found


def _matched(mesh: TetMesh, master: Ints, own: Ints, slave: Ints, there: Ints) -> PeriodicPair | None:
    from scipy.spatial import cKDTree  # here: importing a filter to see its options should not take it

    if len(master) != len(slave) or len(own) != len(there):
        return None
    points, near = mesh.points, _NEAR * mesh.diagonal
    translation = points[there].mean(axis=0) - points[own].mean(axis=0)
    far, at = cKDTree(points[there]).query(points[own] + translation)
    if far.max() > near or len(np.unique(at)) < len(at):
        return None
    translation = np.median(points[there[at]] - points[own], axis=0)
    translation[np.abs(translation) <= near] = 0.0
    to = np.full(len(points), -1)
    to[own] = there[at]
    rows = find_rows(np.sort(slave, axis=1), np.sort(to[master], axis=1), len(points))
    return None if (rows < 0).any() else PeriodicPair(master, slave, np.column_stack([own, to[own]]), translation)
