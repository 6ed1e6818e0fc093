"""Cells by kind become a :class:`TetMesh`: broken tets refused or repaired, other cells beside them, curved edges."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError, NoMeshError
from wct_plugin.io.corners import CurvedEdges
from wct_plugin.mesh import Cells, TetMesh, cell_kinds, faults, second_order
from wct_plugin.mesh.index_arrays import among
from wct_plugin.mesh.mesh import check_range
from wct_plugin.mesh.other_cells import OtherCells, facets_at, find_contact
from wct_plugin.mesh.repair import mend
from wct_plugin.mesh.repairs import Repairs
from wct_plugin.mesh.topology import EDGES
from wct_plugin.types import Bools, Floats, Ints

#: Kinds that hang on tets; their cells are the tets' where these have them.
_ON_TETS = ("triangle", "line", "vertex")


@dataclass
class Parts:
    """What a tet mesh is made of, on all points of a file: ``cells`` by kind, tets among them."""

    points: Floats
    cells: dict[str, Cells]
    point_data: dict[str, NDArray[Any]]
    point_sets: dict[str, Ints]

    @property
    def others(self) -> list[str]:
        """Kinds that are neither tets nor what hangs on them."""
        return [kind for kind, cells in self.cells.items() if kind not in ("tetra", *_ON_TETS) and len(cells)]


def assemble(parts: Parts, curved: CurvedEdges | None, notes: list[str], *, repair: bool, **more: Any) -> TetMesh:
    """Make the mesh; ``notes`` grows by what there is to say, ``more`` are further fields of the mesh.

    Raises :class:`NoMeshError`, which lists the faults, for broken tets unless ``repair`` mends them.
    """
    for cells in parts.cells.values():
        check_range(cells.vertices, len(parts.points))
    repairs = _repaired(parts, notes) if repair else Repairs()
    others = _others(parts) if parts.others else None
    tets = parts.cells["tetra"]
    try:
        mesh = TetMesh(
            parts.points,
            tets.vertices,
            tets.tags,
            facets=parts.cells["triangle"],
            edges=parts.cells["line"],
            nodes=parts.cells["vertex"],
            point_data=parts.point_data,
            cell_data=tets.data,
            point_sets=parts.point_sets,
            tet_sets=tets.sets,
            others=others,
            repairs=repairs,
            **more,
        )
        _ = mesh.topology.interior_pairs  # refuses facets of three tets
    except NoMeshError as error:
        found = _faults(parts.points, tets.vertices)
        if not found:
            raise
        able = not (repair or len(found.not_finite))
        raise NoMeshError(
            f"{error} (found: {found}; tets are counted from 0 in the order of the file;"
            f" {'option repair drops or mends such tets' if able else 'repair cannot mend these'})"
        ) from error
    if others:
        notes.extend(_said_of(mesh, others))
    if curved is not None:
        mesh = _with_second_order(mesh, curved)
    return mesh


def _faults(points: Floats, tets: Ints) -> faults.Faults | None:
    return faults.find(points, tets) if len(tets) else None


def _repaired(parts: Parts, notes: list[str]) -> Repairs:
    """Mend the tets, and what hangs on them."""
    tets = parts.cells["tetra"]
    if not _faults(parts.points, tets.vertices):
        return Repairs()
    done = mend(parts.points, tets.vertices, tuple(parts.cells[kind].vertices for kind in _ON_TETS))
    if done.repairs.mended and parts.others:
        kind = parts.others[0]
        raise InputError(f"tets of zero volume inside cannot be cut away beside {kind} cells, which would be cut too")
    parts.points = done.points
    parts.cells |= {
        kind: _taken(parts.cells[kind], part.cells, part.origin)
        for kind, part in zip(("tetra", *_ON_TETS), (done.tets, *done.others), strict=True)
    }
    for name, values in parts.point_data.items():
        ends = values[done.ends]
        added = ends.mean(axis=1) if values.dtype.kind == "f" else ends[:, 0]
        parts.point_data[name] = np.concatenate([values, added]) if len(ends) else values
    notes.append(f"repaired: {done.describe()}")
    return done.repairs


def _taken(cells: Cells, vertices: Ints, origin: Ints) -> Cells:
    """The cells ``origin`` (k,), again and again, on other vertices (k, d)."""
    where = {name: np.isin(origin, members) for name, members in cells.sets.items()}
    return Cells(
        vertices,
        cells.tags[origin],
        {name: values[origin] for name, values in cells.data.items()},
        {name: np.flatnonzero(there) for name, there in where.items()},
    )


def _others(parts: Parts) -> OtherCells:
    """Take what is not the tets' out of the parts: cells of other kinds, and what hangs on these alone."""
    count, tets = len(parts.points), parts.cells["tetra"].vertices
    ours, theirs = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
    ours[tets] = True
    for kind in parts.others:
        theirs[parts.cells[kind].vertices] = True
    cells = {kind: parts.cells.pop(kind) for kind in parts.others}
    for kind, held in (
        ("triangle", lambda rows: among(rows, facets_at(tets, theirs), count)),
        ("line", lambda rows: among(rows, tets[:, EDGES].reshape(-1, 2), count)),
        ("vertex", lambda rows: ours[rows[:, 0]]),
    ):
        given = parts.cells[kind]
        rows = np.flatnonzero(theirs[given.vertices].all(axis=1))
        beside = np.zeros(len(given), dtype=bool)
        beside[rows[~held(given.vertices[rows])]] = True
        if beside.any():
            cells[kind] = given.select(beside)
            parts.cells[kind] = given.select(~beside)
    used = np.flatnonzero(theirs)
    place = np.cumsum(theirs) - 1
    keep = ours | ~theirs  # points of nobody are for the mesh to drop and count
    made = OtherCells(
        parts.points[used],
        np.where(ours, np.cumsum(keep) - 1, -1)[used],
        {kind: replace(rows, vertices=place[rows.vertices]) for kind, rows in cells.items()},
        {name: values[used] for name, values in parts.point_data.items()},
        {name: place[ids[theirs[ids]]] for name, ids in parts.point_sets.items() if theirs[ids].any()},
    )
    _keep_points(parts, keep)
    return made


def _keep_points(parts: Parts, keep: Bools) -> None:
    """Leave out points that no cell of the parts uses; sets that have none left are gone."""
    place = np.cumsum(keep) - 1
    parts.points = parts.points[keep]
    parts.cells = {kind: replace(cells, vertices=place[cells.vertices]) for kind, cells in parts.cells.items()}
    parts.point_data = {name: values[keep] for name, values in parts.point_data.items()}
    parts.point_sets = {
        name: place[ids[keep[ids]]] for name, ids in parts.point_sets.items() if keep[ids].any() or not len(ids)
    }


def _said_of(mesh: TetMesh, others: OtherCells) -> list[str]:
    """What there is to say of the cells beside the tets."""
    lines = []
    if others.volumes:
        assert mesh.others is not None
        contact = find_contact(mesh.topology.boundary, mesh.others, len(mesh.points))
        lines.append(f"{others.describe()} stay as they are; {contact.facets.sum()} of their facets are those of tets")
        if contact.halves.any():
            lines.append(
                f"{contact.halves.sum()} facets of tets lie in quadrilaterals of other cells, where the mesh is not"
                " conforming"
            )
    flat = {kind: len(cells) for kind, cells in others.cells.items() if cell_kinds.dimension(kind) == 2}
    if flat and not others.volumes:
        lines.append(" and ".join(f"{count} {kind}" for kind, count in flat.items()) + " cells stay as they are")
    return lines


def _with_second_order(mesh: TetMesh, curved: CurvedEdges) -> TetMesh:
    """The mesh with its curved edges; its boundary is to stay near the curved one, if that is curved."""
    if not len(curved.ends):
        return replace(mesh, second_order=second_order.straight())
    found = second_order.with_surface(curved.ends, curved.middles, mesh)
    reference = second_order.curved_boundary(mesh, found) if found.curved else None
    return replace(mesh, second_order=found, reference=reference)
