"""In which order formats count the nodes of a cell, where they do not count as meshio, which is mostly VTK's way."""

import numpy as np
from numpy.typing import NDArray

from wct_plugin.mesh import cell_kinds

#: gmsh: corners as VTK has them, mid nodes by edge of the smaller corners first.
_GMSH = {
    "tetra10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    "hexahedron20": [*range(8), 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14],
    "hexahedron27": [*range(8), 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14, 24, 22, 20, 21, 23, 25, 26],
    "wedge15": [*range(6), 6, 8, 12, 7, 13, 14, 9, 11, 10],
    "pyramid13": [*range(5), 5, 8, 9, 6, 10, 7, 11, 12],
}
#: MED: the first face of a volume is seen from outside where VTK's is from inside.
_MED = {
    "tetra": [0, 2, 1, 3], "pyramid": [0, 3, 2, 1, 4], "wedge": [0, 2, 1, 3, 5, 4],
    "hexahedron": [0, 3, 2, 1, 4, 7, 6, 5],
}  # fmt: skip
#: VTK's linear wedge is mirrored, as its quadratic one and all others' are not.
_VTK = {"wedge": [0, 2, 1, 3, 5, 4]}
#: Exodus and Nastran: the edges between bottom and top before those of the top; which of their nodes is each of VTK's.
_SIDES_FIRST = {
    "hexahedron20": [*range(12), *range(16, 20), *range(12, 16)],
    "hexahedron27": [*range(12), *range(16, 20), *range(12, 16), 23, 24, 25, 26, 21, 22, 20],
    "wedge15": [*range(9), *range(12, 15), *range(9, 12)],
}


def in_vtk(kind: str, cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cells (k, d) with their nodes as VTK itself counts them; of cells that count so, as all others do."""
    return cells[:, _VTK[kind]] if kind in _VTK else cells


def from_sides_first(kind: str, cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cells (k, d) of an Exodus or Nastran file with their nodes as meshio counts them."""
    return cells[:, _SIDES_FIRST[kind]] if kind in _SIDES_FIRST else cells


def in_gmsh(kind: str, cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cells (k, d) with their nodes as gmsh counts them."""
    return cells[:, _GMSH[kind]] if kind in _GMSH else cells


def from_gmsh(kind: str, cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cells (k, d) of a gmsh file with their nodes as meshio counts them."""
    return cells[:, np.argsort(_GMSH[kind])] if kind in _GMSH else np.ascontiguousarray(cells)


def in_med(kind: str, cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cells (k, d) with their nodes as MED counts them; of cells that count so, as meshio does."""
    base = cell_kinds.base(kind)
    if base not in _MED:
        return cells
    order = list(_MED[base])
    if cells.shape[1] > len(order):
        edges = [frozenset(edge) for edge in cell_kinds.EDGES[base]]
        order += [len(order) + edges.index(frozenset((order[i], order[j]))) for i, j in cell_kinds.EDGES[base]]
    return cells[:, order]
