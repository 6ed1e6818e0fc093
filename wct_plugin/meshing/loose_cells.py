"""Tagged triangles and lines of a mesh that are no facets and edges of its tets: nothing can keep them."""

import warnings
from dataclasses import replace
from typing import Any

import numpy as np

from wct_plugin.errors import WctWarning
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.mesh import and_more, show_row
from wct_plugin.mesh.other_cells import facets_at
from wct_plugin.types import Bools, Ints


def without(mesh: TetMesh) -> TetMesh:
    """The mesh without such cells, which a :class:`WctWarning` counts, naming the first of each kind, or it itself."""
    said: list[str] = []
    kept: dict[str, Any] = {}
    for name, word, cells in (("facets", "triangle", mesh.facets), ("edges", "line", mesh.edges)):
        on = _on(mesh, cells)
        if not on.all():
            said.append(_described(word, cells, ~on))
            kept[name] = cells.select(on)
    if not kept:
        return mesh
    warnings.warn(f"{mesh.source or 'the mesh'}: no tet has {', nor '.join(said)}: not kept", WctWarning, stacklevel=5)
    return replace(mesh, **kept)


def _on(mesh: TetMesh, cells: Cells) -> Bools:
    """(k,) which of the cells are facets or edges of tets."""
    if not len(cells):
        return np.empty(0, dtype=bool)
    touched = np.zeros(len(mesh.points), dtype=bool)
    touched[cells.vertices] = True
    there: Ints = facets_at(mesh.tets, touched) if cells.vertices.shape[1] == 3 else mesh.topology.edges
    found: Bools = find_rows(there, np.sort(cells.vertices, axis=1), len(mesh.points)) >= 0
    return found


def _described(word: str, cells: Cells, loose: Bools) -> str:
    rows = np.flatnonzero(loose)
    return f"{word} {rows[0]}, vertices {show_row(cells.vertices[rows[0]])}{and_more(rows)}"
