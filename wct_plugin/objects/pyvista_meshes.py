"""Pyvista's datasets, and VTK's, as meshes and back."""

from typing import Any

import numpy as np
import pyvista as pv

from wct_plugin.errors import InputError
from wct_plugin.io import mid_nodes
from wct_plugin.io.assembly import NAME, TAGS
from wct_plugin.io.formats import PYVISTA
from wct_plugin.io.node_orders import in_vtk
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.io.writer import contents
from wct_plugin.mesh import SurfaceMesh, TetMesh, cell_kinds
from wct_plugin.objects.assembled import assembled, not_carried

#: VTK's types of cells by meshio's names, and the number of points each has.
_TYPES = {
    "tetra": 10, "triangle": 5, "line": 3, "vertex": 1, "quad": 9, "hexahedron": 12, "wedge": 13, "pyramid": 14,
    "tetra10": 24, "triangle6": 22, "line3": 21, "quad8": 23, "hexahedron20": 25, "wedge15": 26, "pyramid13": 27,
    "quad9": 28, "hexahedron27": 29,
}  # fmt: skip
_WIDTHS = {kind: cell_kinds.nodes(kind) for kind in _TYPES}
#: Types of any number of points, which are one of these where the number fits: polygon, polyline, polyvertex.
_ANY_NUMBER = {7: "triangle", 4: "line", 2: "vertex"}


def from_pyvista(dataset: pv.DataSet) -> TetMesh | SurfaceMesh:
    """Make a mesh of a dataset: tets with the triangles, lines and vertices beside them, or a surface of triangles.

    Arrays go by the conventions of VTU files: integer tags from the first of the conventional cell arrays
    (``gmsh:physical``, ``medit:ref``, ...) that is there, ``set:NAME`` arrays as named sets; where no tet has a tag,
    regions from an array of a usual name (``material``, ...).

    Parameters
    ----------
    dataset : pyvista.UnstructuredGrid or pyvista.PolyData
        What to take, or VTK's own; it is left as it is.

    Raises
    ------
    InputError
        For cells of unknown kinds, and for volumes without a tet.
    """
    dataset = dataset if isinstance(dataset, pv.DataSet) else pv.wrap(dataset)
    grid = dataset if isinstance(dataset, pv.UnstructuredGrid) else dataset.cast_to_unstructured_grid()
    what = type(dataset).__name__
    if not grid.n_cells:
        raise InputError(f"{what}: has no cells")
    types, starts = np.array(grid.celltypes), np.asarray(pv.convert_array(grid.GetCells().GetOffsetsArray()))
    for code, kind in _ANY_NUMBER.items():
        types[(types == code) & (np.diff(starts) == _WIDTHS[kind])] = _TYPES[kind]
    for code in np.setdiff1d(types, list(_TYPES.values())).tolist():
        raise InputError(
            f"{what}: has {(types == code).sum()} {pv.CellType(code).name.lower()} cells; "
            f"allowed are {', '.join(_TYPES)} (triangulate() makes these of most others)"
        )
    connectivity = np.asarray(grid.cell_connectivity)
    present = [(kind, code) for kind, code in _TYPES.items() if (types == code).any()]
    raw = RawMesh(
        np.asarray(grid.points),
        [
            RawBlock(kind, in_vtk(kind, connectivity[starts[:-1][types == code][:, None] + np.arange(_WIDTHS[kind])]))
            for kind, code in present
        ],
        point_data={name: np.asarray(values) for name, values in grid.point_data.items()},
        cell_data={
            name: [np.asarray(values)[types == code] for _, code in present] for name, values in grid.cell_data.items()
        },
        field_data={name: np.asarray(values) for name, values in grid.field_data.items()},
    )
    lost = [f"field data {name!r}" for name in raw.field_data if not name.startswith(NAME)]
    return assembled(raw, PYVISTA, what, _tags(grid), lost)


def without_field_data(dataset: pv.DataSet) -> pv.DataSet:
    """The same points, cells and arrays, and of the field data the names of tags only."""
    bare = dataset.copy(deep=False)
    for name in [name for name in bare.field_data if not name.startswith(NAME)]:
        del bare.field_data[name]
    return bare


def _tags(grid: pv.UnstructuredGrid) -> tuple[str, ...]:
    """The name of the array of tags, if there is one."""
    return tuple(name for name in TAGS if name in grid.cell_data and np.any(grid.cell_data[name]))[:1]


def to_pyvista(mesh: TetMesh | SurfaceMesh) -> pv.UnstructuredGrid | pv.PolyData:
    """Make a dataset of a mesh: a grid of tets, then tagged facets, edges and vertices; a surface becomes PolyData.

    Every array spans all cells, with zero or NaN where a kind of cell lacks it. What does not go in, such as arrays of
    words, is named in a warning.
    """
    content, lost = contents(mesh, PYVISTA)
    not_carried("pyvista's dataset", lost)
    if isinstance(mesh, TetMesh) and mesh.second_order:
        mid_nodes.put(content, mesh, PYVISTA)
    dataset: pv.UnstructuredGrid | pv.PolyData
    if isinstance(mesh, SurfaceMesh):
        triangles: Any = content.cells[0][1]  # its own type says "int", which no array of NumPy's is
        dataset = pv.PolyData.from_regular_faces(content.points, triangles)
    else:
        rows = [np.insert(in_vtk(kind, cells), 0, cells.shape[1], axis=1).ravel() for kind, cells in content.cells]
        types = [np.full(len(cells), _TYPES[kind], dtype=np.uint8) for kind, cells in content.cells]
        dataset = pv.UnstructuredGrid(np.concatenate(rows), np.concatenate(types), content.points)
    for name, values in content.point_data.items():
        dataset.point_data[name] = values
    for name, columns in content.cell_data.items():
        dataset.cell_data[name] = np.concatenate(columns)
    for name, pair in content.names.items():
        dataset.field_data[NAME + name] = pair
    return dataset
