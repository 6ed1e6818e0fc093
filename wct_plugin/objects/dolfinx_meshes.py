"""A mesh of dolfinx, by the arrays it holds; the way back is ``dolfinx.mesh.create_mesh``, see docs/objects.md."""

from typing import Any

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.formats import MESHIO
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.objects.assembled import assembled
from wct_plugin.types import Ints

_WHAT = "dolfinx.mesh.Mesh"
_KINDS = ("vertex", "line", "triangle", "tetra")
_TAGS = "cell_tags"


def from_dolfinx(mesh: Any, cell_tags: Any = None, facet_tags: Any = None) -> TetMesh | SurfaceMesh:
    """Make a mesh of a dolfinx mesh of tets or triangles, with MeshTags on its cells and facets, if any.

    Parameters
    ----------
    mesh : dolfinx.mesh.Mesh or tuple
        The mesh, or ``(mesh, cell_tags, facet_tags)`` as ``dolfinx.io`` reads it from gmsh.
    cell_tags, facet_tags : dolfinx.mesh.MeshTags, optional
        Regions, and tagged facets; of any dimension, which they say themselves.

    Raises
    ------
    InputError
        For other cells, and for a mesh that is spread over several processes.
    """
    if isinstance(mesh, tuple | list):
        mesh, *tags = mesh
    else:
        tags = [cell_tags, facet_tags]
    topology, dimension = mesh.topology, mesh.topology.dim
    if mesh.comm.size > 1:
        raise InputError(f"{_WHAT}: is spread over {mesh.comm.size} processes; allowed is one")
    corners = _connectivity(topology, dimension, 0, f"cells of dimension {dimension}")
    if dimension not in (2, 3) or corners.shape[1] != dimension + 1:
        raise InputError(f"{_WHAT}: has cells of {corners.shape[1]} corners; allowed are tets and triangles")
    # The first nodes of a cell are its corners, in the order of its vertices; the two have numbers of their own.
    nodes = np.asarray(mesh.geometry.dofmap).reshape(len(corners), -1)
    cells = nodes[:, : dimension + 1].astype(np.int64)
    node_of = np.zeros(int(corners.max()) + 1, dtype=np.int64)
    node_of[corners] = cells
    of_cells = np.zeros(len(cells), dtype=np.int64)
    blocks, values = [RawBlock(_KINDS[dimension], cells)], [of_cells]
    for one in tags:
        if getattr(one, "indices", None) is None:  # none, or what else dolfinx.io puts into its tuple
            continue
        if one.dim == dimension:
            of_cells[one.indices] = one.values
        else:
            vertices = np.arange(len(node_of))[:, None]
            if one.dim:
                vertices = _connectivity(topology, one.dim, 0, f"entities of dimension {one.dim}")
            blocks.append(RawBlock(_KINDS[one.dim], node_of[vertices[one.indices]]))
            values.append(np.asarray(one.values, dtype=np.int64))
    lost = [f"{nodes.shape[1] - dimension - 1} nodes of each cell beside its corners"] * (
        nodes.shape[1] > dimension + 1
    )
    raw = RawMesh(np.asarray(mesh.geometry.x), blocks, cell_data={_TAGS: list(values)})
    return assembled(raw, MESHIO, _WHAT, (_TAGS,), lost)


def _connectivity(topology: Any, of: int, to: int, what: str) -> Ints:
    """(k, d) vertices of each entity."""
    topology.create_connectivity(of, to)
    found = topology.connectivity(of, to)
    widths = np.diff(found.offsets)
    if not len(widths) or (widths != widths[0]).any():
        raise InputError(f"{_WHAT}: its {what} are none, or of several kinds; allowed is one kind")
    return np.asarray(found.array, dtype=np.int64).reshape(-1, int(widths[0]))
