"""``meshio.Mesh`` as mesh and back; the conventions are those of the files that meshio reads."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.io import beside_tets, formats, mid_nodes
from wct_plugin.io.meshio_writers import Content
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.io.written_regions import shared_type
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.objects.assembled import assembled, not_carried
from wct_plugin.types import Ints

_PHYSICAL = "gmsh:physical"


def from_meshio(mesh: Any) -> TetMesh | SurfaceMesh:
    """Make a mesh of a ``meshio.Mesh``, as :func:`wct_plugin.read` does of the file that meshio read it from."""
    gmsh = next(form for form in formats.FORMATS if form.name == "gmsh")
    lost = [f"field data {name!r}" for name, pair in mesh.field_data.items() if np.size(pair) != 2]
    lost += ["info"] if mesh.info else []
    form = gmsh if _PHYSICAL in mesh.cell_data else formats.MESHIO
    return assembled(_raw(mesh), form, "meshio.Mesh", lost=lost)


def _raw(mesh: Any) -> RawMesh:
    return RawMesh(
        mesh.points,
        [RawBlock(block.type, block.data) for block in mesh.cells],
        dict(mesh.point_data),
        {name: list(columns) for name, columns in mesh.cell_data.items()},
        dict(mesh.point_sets),
        {name: list(columns) for name, columns in mesh.cell_sets.items()},
        dict(mesh.field_data),
        periodic=list(getattr(mesh, "gmsh_periodic", None) or ()),
    )


def to_meshio(mesh: TetMesh | SurfaceMesh) -> Any:
    """Make a ``meshio.Mesh``: tets, then tagged facets, edges and vertices, or the triangles of a surface.

    Tags are the array they came from (``gmsh:physical`` without other), names are ``field_data``, sets are sets. Arrays
    are zero or NaN where a kind of cell lacks them.
    """
    blocks = _blocks(mesh)
    lost: list[str] = []
    cell_data = _filled(blocks, lost)
    names: Mapping[str, tuple[int, int]] = mesh.names if isinstance(mesh, TetMesh) else {}
    if names or any(tags.any() for _, _, tags, _, _ in blocks):
        tag_name = mesh.tag_name if isinstance(mesh, TetMesh) else _PHYSICAL
        if any(tag_name in data and not np.array_equal(data[tag_name], tags) for _, _, tags, data, _ in blocks):
            lost.append(f"cell data {tag_name!r}, whose name is that of the tags")
        columns: list[NDArray[Any]] = [np.array(tags) for _, _, tags, _, _ in blocks]
        if isinstance(mesh, TetMesh) and mesh.region_name == tag_name:
            columns = shared_type(mesh, columns)
        cell_data[tag_name] = columns
    sets = {
        name: [np.array(one[4].get(name, np.empty(0, dtype=np.int64))) for one in blocks]
        for name in dict.fromkeys(name for one in blocks for name in one[4])
    }
    if isinstance(mesh, TetMesh) and mesh.periodic:
        lost.append("which sides are periodic")
    not_carried("meshio.Mesh", lost)
    content = Content(
        beside_tets.points_of(mesh),
        [(kind, np.array(cells)) for kind, cells, _, _, _ in blocks],
        {name: np.array(values) for name, values in beside_tets.point_data_of(mesh).items()},
        cell_data,
        {},
        sets,
        {},
        {},
        [],
    )
    if isinstance(mesh, TetMesh):
        content.point_sets = {name: np.array(ids) for name, ids in beside_tets.point_sets_of(mesh).items()}
        if mesh.second_order:
            mid_nodes.put(content, mesh, formats.MESHIO)
    return content.mesh(field_data={name: np.array(pair, dtype=np.int64) for name, pair in names.items()})


_Block = tuple[str, Ints, Ints, Mapping[str, NDArray[Any]], Mapping[str, Ints]]


def _blocks(mesh: TetMesh | SurfaceMesh) -> list[_Block]:
    """Kind, cells, tags, data and sets of each kind of cell there is."""
    if isinstance(mesh, SurfaceMesh):
        return [("triangle", mesh.triangles, mesh.tags, mesh.cell_data, {})]
    return [
        ("tetra", mesh.tets, mesh.regions, mesh.cell_data, mesh.tet_sets),
        *((kind, one.vertices, one.tags, one.data, one.sets) for kind, one in beside_tets.tagged_cells(mesh).items()),
    ]


def _filled(blocks: list[_Block], lost: list[str]) -> dict[str, list[NDArray[Any]]]:
    """Every array for every block, as meshio wants it."""
    out: dict[str, list[NDArray[Any]]] = {}
    for name in dict.fromkeys(name for _, _, _, data, _ in blocks for name in data):
        owners = [data[name] for _, _, _, data, _ in blocks if name in data]
        tails = {values.shape[1:] for values in owners}
        if len(tails) > 1:
            lost.append(f"cell data {name!r}, of other widths on other cells")
            continue
        dtype = np.result_type(*owners)
        fill = np.nan if dtype.kind in "fc" else np.zeros((), dtype)
        out[name] = [
            np.array(data[name], dtype=dtype) if name in data else np.full((len(cells), *min(tails)), fill, dtype)
            for _, cells, _, data, _ in blocks
        ]
    return out
