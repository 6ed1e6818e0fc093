"""Tets that came with mid nodes on a curved surface: their vertices go on it, and what is kept is measured on it."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from wct_plugin.core import _core
from wct_plugin.exact import predicates
from wct_plugin.measure import compiled_quality
from wct_plugin.measure.conserved import group_names
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.measure.fidelity import Fidelity, interface_rows
from wct_plugin.measure.goals import misses
from wct_plugin.measure.quantities import Quantity, quantity
from wct_plugin.measure.second_order import CurvedCells, middles_as_read
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.mid_nodes import find_middles
from wct_plugin.mesh.second_order import SecondOrder
from wct_plugin.mesh.strata import Strata, find_strata
from wct_plugin.types import Bools, Floats, Ints

#: A vertex is on a curved crease that is at most this far away, in the length of edges there.
_BESIDE = 0.15
#: Nearer than this, in the length of edges, a vertex is on the surface.
_THERE = 1e-9
#: How often vertices of bad tets are put back.
_TRIES = 8


def on_surface(mesh: TetMesh, goal: Literal["3wc", "cwc"], margin: float, crease_angle: float) -> TetMesh:
    """The mesh with the vertices of its surface on the curved one, and those inside moved for the goal.

    Vertices of tets that miss the goal then stay where they are: no more tets miss it than before.
    """
    of = mesh.second_order
    if of is None:
        return mesh
    strata = find_strata(mesh, crease_angle)
    target = _targets(mesh, of, strata)
    wants = (target != mesh.points).any(axis=1)
    before = misses(mesh, compiled_quality.measure(mesh), goal)
    for _ in range(_TRIES):
        points = _unturned(mesh, np.where(wants[:, None], target, mesh.points))
        wants &= (points != mesh.points).any(axis=1)
        if not wants.any():
            break
        made = _inside_moved(mesh.altered(points=points), strata, goal, margin)
        bad = misses(made, compiled_quality.measure(made), goal)
        if bad.sum() <= before.sum():
            return made
        wants[mesh.tets[bad & ~before]] = False
    return mesh


def _targets(mesh: TetMesh, of: SecondOrder, strata: Strata) -> Floats:
    """(n, 3) where the curved surface has the vertices of the surface."""
    points = np.array(mesh.points)
    ends = np.concatenate([mesh.topology.edges, mesh.topology.edges[:, ::-1]])
    length = np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1)
    size = np.bincount(ends[:, 0], length) / np.bincount(ends[:, 0])
    rows = np.flatnonzero(strata.stratum == 2)
    there = of.nearest_on_creases(points[rows])
    near = np.linalg.norm(there - points[rows], axis=1) <= _BESIDE * size[rows]
    near &= len(of.creases) > 0
    points[rows[near]] = there[near]
    rows = np.concatenate([rows[~near], np.flatnonzero(strata.stratum == 1)])
    points[rows] = of.nearest_on_facets(points[rows])
    there = np.linalg.norm(points - mesh.points, axis=1) <= _THERE * size
    points[there] = mesh.points[there]
    return points


def _unturned(mesh: TetMesh, points: Floats) -> Floats:
    """The points, but where tets would be turned round or flat those of the mesh."""
    while True:
        turned = mesh.tets[predicates.orientation(points, mesh.tets) <= 0]
        back = np.unique(turned)
        if not (points[back] != mesh.points[back]).any():
            return points
        points[back] = mesh.points[back]


def _inside_moved(mesh: TetMesh, strata: Strata, goal: Literal["3wc", "cwc"], margin: float) -> TetMesh:
    """The mesh with vertices inside moved for the goal."""
    pinned = replace(strata, stratum=np.where(strata.stratum > 0, 3, 0).astype(np.int8))
    points, _ = _core.move_vertices(mesh.points, mesh.tets, pinned, goal=goal, margin=margin, effort=1)
    return mesh.altered(points=points)


@dataclass(frozen=True)
class CurvedDomain:
    """A mesh as it came, and one made anew, both as they are curved."""

    old: TetMesh
    new: TetMesh  #: both with their second order

    def fidelity(self, straight: Fidelity) -> Fidelity:
        """What was measured on straight tets, measured on curved ones."""
        old, new = self._cells()
        boundary = old.surface(self.old.topology.boundary)
        diagonal = boundary.diagonal

        def apart(one: Ints, other: Ints) -> dict[str, float]:
            return measure_deviation(new.surface(one), old.surface(other), compiled=True).to_dict(diagonal)

        rows, new_rows = interface_rows(self.old), interface_rows(self.new)
        volumes = old.volumes(), new.volumes()
        return {
            "deviation": apart(self.new.topology.boundary, self.old.topology.boundary),
            "interfaces": {
                name: apart(self.new.topology.interfaces[new_rows[name]], self.old.topology.interfaces[rows[name]])
                if name in new_rows
                else None
                for name in straight["interfaces"]
            },
            "inside": straight["inside"],
            "volumes": {
                tag: quantity(
                    *(
                        float(volume[mesh.regions == int(tag)].sum())
                        for volume, mesh in zip(volumes, (self.old, self.new), strict=True)
                    )
                )
                for tag in straight["volumes"]
            },
        }

    def groups(self, straight: dict[str, Quantity]) -> dict[str, Quantity]:
        """The areas and lengths of groups, and the areas of interfaces, of curved cells."""
        before, after = (
            self._sizes(mesh, cells) for mesh, cells in zip((self.old, self.new), self._cells(), strict=True)
        )
        return {name: quantity(before[name], after.get(name, 0.0)) for name in straight}

    def _cells(self) -> tuple[CurvedCells, CurvedCells]:
        return CurvedCells(self.old, middles_as_read(self.old)), CurvedCells(self.new, find_middles(self.new).points)

    def _sizes(self, mesh: TetMesh, cells: CurvedCells) -> dict[str, float]:
        sizes: list[tuple[dict[str, Bools], Floats]] = [
            (group_names(mesh, mesh.facets), cells.areas(mesh.facets.vertices)),
            (group_names(mesh, mesh.edges), cells.lengths(mesh.edges.vertices)),
        ]
        out = {name: float(size[rows].sum()) for groups, size in sizes for name, rows in groups.items()}
        areas = cells.areas(mesh.topology.interfaces)
        return out | {f"interface {name}": float(areas[rows].sum()) for name, rows in interface_rows(mesh).items()}
