"""Tets, triangles and lines with mid nodes become those of their corners; where tets were curved is remembered."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.mesh import cell_kinds
from wct_plugin.mesh.mesh import check_range
from wct_plugin.mesh.second_order import find_curved
from wct_plugin.types import Bools, Floats

#: Kinds that tets are made of, and kinds beside them that are tagged.
_TAKEN = ("tetra", "triangle", "line")


@dataclass(frozen=True, eq=False)
class CurvedEdges:
    """Edges of tets with mid nodes that are not straight."""

    ends: Floats  #: (e, 2, 3)
    middles: Floats  #: (e, 3)


def corners_only(raw: RawMesh) -> tuple[RawMesh, CurvedEdges | None]:
    """The mesh with the corners of its tets, triangles and lines alone; None where no tet has mid nodes.

    Points that were mid nodes of these alone are gone. Cells of other kinds keep all of theirs. What there is to say
    goes to the notes.
    """
    fine = [block for block in raw.cells if _is_fine(block)]
    if not fine:
        return raw, None
    for block in raw.cells:
        check_range(np.asarray(block.data), len(raw.points))
    blocks = [_with_corners(block) if _is_fine(block) else block for block in raw.cells]
    notes = raw.notes
    second = [block for block in fine if cell_kinds.base(block.type) == "tetra"]
    curved = None
    if second and all(cell_kinds.is_second_order(block.type) for block in second):
        points = np.asarray(raw.points, dtype=np.float64)
        ends, middles = zip(*(_edges(points, block) for block in second), strict=True)
        curved = CurvedEdges(*find_curved(np.concatenate(ends), np.concatenate(middles)))
        count = sum(map(len, second))
        said = f"; {len(curved.ends)} of their edges are curved" if len(curved.ends) else ""
        notes.append(f"the corners of {count} {second[0].type} cells are taken, mid nodes made anew when written{said}")
    for block in fine if curved is None else ():
        notes.append(f"of {len(block)} {block.type} cells the corners alone are taken")
    keep = _used(len(raw.points), blocks) | ~_used(len(raw.points), raw.cells)
    if any(not name.startswith("gmsh:") for name in raw.point_data) and not keep.all():
        notes.append(f"point data of {(~keep).sum()} nodes between corners are left out")
    return _with_points(replace(raw, cells=blocks), keep), curved


def _is_fine(block: RawBlock) -> bool:
    return len(block) > 0 and block.type not in _TAKEN and cell_kinds.base(block.type) in _TAKEN


def _with_corners(block: RawBlock) -> RawBlock:
    plain = cell_kinds.base(block.type)
    return RawBlock(plain, np.asarray(block.data)[:, : cell_kinds.corners(plain)])


def _edges(points: Floats, block: RawBlock) -> tuple[Floats, Floats]:
    cells = np.asarray(block.data)
    edges = np.array(cell_kinds.EDGES["tetra"])
    ends, middles = points[cells[:, edges]].reshape(-1, 2, 3), points[cells[:, 4 : 4 + len(edges)]].reshape(-1, 3)
    return ends, middles


def _used(count: int, blocks: list[RawBlock]) -> Bools:
    used = np.zeros(count, dtype=bool)
    for block in blocks:
        if len(block):
            used[np.asarray(block.data)] = True
    return used


def _with_points(raw: RawMesh, keep: Bools) -> RawMesh:
    """The mesh on some of its points."""
    place = np.cumsum(keep) - 1

    def still(members: Any) -> NDArray[np.int64]:
        ids = np.asarray([] if members is None else members, dtype=np.int64)
        return place[ids[keep[ids]]]

    return replace(
        raw,
        points=np.asarray(raw.points)[keep],
        cells=[RawBlock(block.type, place[np.asarray(block.data)]) for block in raw.cells],
        point_data={name: np.asarray(values)[keep] for name, values in raw.point_data.items()},
        point_sets={name: still(members) for name, members in raw.point_sets.items()},
    )
