"""Cells that stand beside the tets of a mesh and stay as they are: hexahedra, wedges, pyramids, and what is on them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import NoMeshError
from wct_plugin.mesh import cell_kinds
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.mesh import (
    Cells,
    and_more,
    check_range,
    checked_data,
    checked_points,
    checked_sets,
    indices,
    store,
    store_mapping,
)
from wct_plugin.mesh.pickled import Pickled
from wct_plugin.mesh.topology import FACETS
from wct_plugin.types import Bools, Floats, Ints


@dataclass(frozen=True, eq=False)
class OtherCells(Pickled):
    """The other cells of a mesh, on points of their own, some of which are points of the tets.

    ``points`` (p, 3) all that they use; ``shared`` (p,) the point of the tets that each one is, -1 for none;
    ``cells`` by kind, in meshio's names (``hexahedron``, ``wedge``, ``pyramid``, ``quad``; ``triangle``, ``line`` and
    ``vertex`` where no tet has them), rows of ``points`` in VTK's order; ``point_data`` and ``point_sets`` of
    ``points``. Raises :class:`wct_plugin.errors.InputError` for coordinates that are not finite and indices out of
    range.
    """

    points: Floats
    shared: Ints
    cells: Mapping[str, Cells]
    point_data: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    point_sets: Mapping[str, Ints] = field(default_factory=dict)

    def __post_init__(self) -> None:
        points = checked_points(self.points)
        shared = indices(self.shared, "shared points")
        if shared.shape != (len(points),):
            raise NoMeshError(f"shared points have shape {shared.shape}; allowed is ({len(points)},)")
        for cells in self.cells.values():
            check_range(cells.vertices, len(points))
        store(self, "points", points)
        store(self, "shared", shared)
        store_mapping(self, "cells", self.cells)
        store_mapping(self, "point_data", checked_data(self.point_data, len(points), "point"))
        store_mapping(self, "point_sets", checked_sets(self.point_sets, len(points), "point"))

    def __repr__(self) -> str:
        counts = {"points": len(self.points)} | {kind: len(cells) for kind, cells in self.cells.items()}
        return f"<OtherCells: {', '.join(f'{count} {what}' for what, count in counts.items())}>"

    @property
    def volumes(self) -> dict[str, int]:
        """How many cells there are of each kind that has a volume."""
        return {kind: len(cells) for kind, cells in self.cells.items() if cell_kinds.dimension(kind) == 3}

    def describe(self) -> str:
        """The cells with a volume in words: ``52 wedge and 8 pyramid cells``."""
        return " and ".join(f"{count} {kind}" for kind, count in self.volumes.items()) + " cells"

    def renumbered(self, place: Ints) -> "OtherCells":
        """With point k of the tets at ``place[k]``; -1 where it is none any more."""
        return replace(self, shared=np.where(self.shared >= 0, place[self.shared], -1))

    def check_on(self, points: Floats) -> None:
        """Raise :class:`NoMeshError` unless the shared points are where the tets have them, to the bit."""
        ours = np.flatnonzero(self.shared >= 0)
        theirs = self.shared[ours]
        if len(theirs) and (theirs.max() >= len(points) or self.shared.min() < -1):
            raise NoMeshError(f"points shared with other cells must lie in 0..{len(points) - 1}, or be -1")
        moved = ours[(self.points[ours] != points[theirs]).any(axis=1)]
        if len(moved):
            raise NoMeshError(
                f"point {self.shared[moved[0]]} is shared with {self.describe()} and has moved{and_more(moved)};"
                " such points must stay"
            )

    def faces(self, corners: int) -> Ints:
        """(k, corners) the triangles or quadrilaterals round the cells with a volume, each once, in tets' points.

        Those with corners that are no points of the tets are left out.
        """
        found = [np.empty((0, corners), dtype=np.int64)]
        for kind, cells in self.cells.items():
            for face in cell_kinds.FACES.get(cell_kinds.base(kind), ()):
                if len(face) == corners:
                    found.append(self.shared[cells.vertices[:, face]])
        rows = np.concatenate(found)
        return rows[(rows >= 0).all(axis=1)]

    def edges(self) -> Ints:
        """(k, 2) the edges of the cells with a volume, each once, ends ascending, both of which tets have as points."""
        found = [np.empty((0, 2), dtype=np.int64)]
        for kind, cells in self.cells.items():
            for face in cell_kinds.FACES.get(cell_kinds.base(kind), ()):
                ring = [*face, face[0]]
                found += [self.shared[cells.vertices[:, ring[k : k + 2]]] for k in range(len(face))]
        rows = np.concatenate(found)
        return np.unique(np.sort(rows[(rows >= 0).all(axis=1)], axis=1), axis=0)


@dataclass(frozen=True)
class Contact:
    """Where the boundary of the tets touches other cells; masks of its facets (b,)."""

    facets: Bools  #: those that are triangles of other cells
    halves: Bools  #: those that lie in quadrilaterals of other cells, which meet several triangles there
    beside: Bools  #: of those that only share an edge or a vertex with other cells as many as hold it

    @property
    def all(self) -> Bools:
        """All of them."""
        return self.facets | self.halves | self.beside


def find_contact(boundary: Ints, others: OtherCells, count: int) -> Contact:
    """Where the boundary (b, 3) of tets on ``count`` points touches other cells."""
    ordered = np.sort(boundary, axis=1)
    matched = find_rows(np.sort(others.faces(3), axis=1), ordered, count) >= 0
    quads = np.sort(others.faces(4), axis=1)
    triangles = [np.delete(quads, corner, axis=1) for corner in range(4)]
    halves = ~matched & (find_rows(np.concatenate(triangles), ordered, count) >= 0)
    held = np.zeros(count, dtype=bool)
    held[boundary[matched | halves]] = True
    beside = np.zeros(len(boundary), dtype=bool)
    sides = np.sort(boundary[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    loose = np.setdiff1d(
        find_rows(sides, others.edges(), count), [-1, *find_rows(sides, sides[np.repeat(matched | halves, 3)], count)]
    )
    beside[loose // 3] = True
    held[boundary[beside]] = True
    touched = np.zeros(count, dtype=bool)
    touched[others.shared[others.shared >= 0]] = True
    alone = np.flatnonzero(touched & ~held)
    corner = find_rows(boundary.reshape(-1, 1), alone.reshape(-1, 1), count)
    beside[corner[corner >= 0] // 3] = True
    return Contact(matched, halves, beside)


def facets_at(tets: Ints, points: Bools) -> Ints:
    """(k, 3) the facets of the tets all of whose vertices are among ``points`` (n,), ascending; each tet's own."""
    facets = np.sort(tets[points[tets].sum(axis=1) >= 3][:, FACETS].reshape(-1, 3), axis=1)
    inside: Ints = facets[points[facets].all(axis=1)]
    return inside
