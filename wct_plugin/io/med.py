"""MED files of Salome, code_aster and gmsh: cells, families with their groups, and fields, whole or on profiles."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import hdf5, med_families, med_fields, read_limit
from wct_plugin.io.med_families import TAGS, Family
from wct_plugin.io.node_orders import in_med
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.mesh import cell_kinds

#: Meshio's names of MED's kinds of cells.
KINDS = {
    "PO1": "vertex", "SE2": "line", "SE3": "line3", "SE4": "line4", "TR3": "triangle", "TR6": "triangle6",
    "TR7": "triangle7", "QU4": "quad", "QU8": "quad8", "QU9": "quad9", "TE4": "tetra", "T10": "tetra10",
    "PY5": "pyramid", "P13": "pyramid13", "PE6": "wedge", "P15": "wedge15", "P18": "wedge18", "HE8": "hexahedron",
    "H20": "hexahedron20", "H27": "hexahedron27", "OCT": "octahedron",
}  # fmt: skip
_POLYGONS, _POLYHEDRA = ("POG", "PG2"), "POE"
#: Number of a family that there can be: arrays hold it in 64 bits, with a sign.
_LARGEST = 2**63 - 1


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the file holds, and what of it is left out. Raises :class:`InputError` without the file's name."""
    lost: list[str] = []
    notes: list[str] = []
    with hdf5.opened(path) as file:
        meshes = list(file.get("ENS_MAA", {}))
        if len(meshes) != 1:
            raise InputError(f"has {len(meshes)} meshes{': ' * bool(meshes)}{', '.join(meshes)}; allowed is one")
        mesh = file["ENS_MAA"][meshes[0]]
        step = _step(mesh, meshes[0], notes)
        raw, names = _cells(step, hdf5.number(mesh, "ESP"))
        families = file.get(f"FAS/{meshes[0]}", mesh.get("FAS", {}))
        med_families.put_cells(raw, med_families.read(families.get("ELEME", {})))
        _point_groups(raw, step["NOE"], med_families.read(families.get("NOEUD", {})))
        med_fields.put(raw, names, file, meshes[0], lost)
    raw.notes += notes
    return raw, lost


def _step(mesh: Any, name: str, notes: list[str]) -> Any:
    """The mesh at its last step; files of version 2 have none."""
    if "NOE" in mesh:
        return mesh
    steps = sorted(key for key, member in hdf5.children(mesh) if "NOE" in member)
    if not steps:
        raise InputError(f"mesh {name!r} has no points; allowed are meshes that are no structured grids")
    if len(steps) > 1:
        notes.append(f"has {len(steps)} steps of the mesh {name!r}; the last is taken")
    return mesh[steps[-1]]


def _columns(group: Any, name: str) -> NDArray[Any]:
    """One row per entity of what MED keeps component by component."""
    array, count = hdf5.array(group, name), hdf5.number(group[name], "NBR")
    if count <= 0 or array.size % count:
        raise InputError(f"has {array.size} numbers for {count} entities")
    return array.reshape(-1, count).T


def _cells(step: Any, dimension: int) -> tuple[RawMesh, list[str]]:
    """Points and cells with their families, and MED's kind of each block."""
    raw = RawMesh(_columns(step["NOE"], "COO")[:, :dimension], [])
    tags: list[NDArray[Any] | None] = []
    names: list[str] = []
    for name, group in hdf5.children(step.get("MAI", {})):
        if name == _POLYHEDRA or name in _POLYGONS:
            blocks = _open_cells(name, group)
        elif name in KINDS:
            nodes = _columns(group, "NOD") - 1
            if nodes.shape[1] != cell_kinds.nodes(KINDS[name]):
                raise InputError(f"has {nodes.size} nodes of {len(nodes)} cells of kind {name!r}")
            blocks = [(KINDS[name], nodes, slice(None))]
        else:
            raise InputError(f"has cells of MED's kind {name!r}; allowed are {', '.join(KINDS)}")
        family = _families(group, f"cells of kind {name!r}") if "FAM" in group else None
        for kind, cells, rows in blocks:
            raw.cells.append(RawBlock(kind, in_med(kind, cells.astype(np.int64))))
            tags.append(None if family is None else family[rows])
            names.append(name)
    if any(column is not None for column in tags):
        raw.cell_data[TAGS] = [
            np.zeros(len(block), np.int64) if column is None else column
            for block, column in zip(raw.cells, tags, strict=True)
        ]
    return raw, names


def _families(group: Any, what: str) -> NDArray[Any]:
    """The number of the family of each."""
    family: NDArray[Any] = hdf5.array(group, "FAM")
    if family.ndim != 1:
        raise InputError(f"has families of shape {family.shape} for {what}; expected one of each")
    if family.size and family.dtype.kind == "u" and family.max() > _LARGEST:
        raise InputError(f"has {family.max()} as the family of {what}; allowed is up to {_LARGEST}")
    return family


def _open_cells(name: str, group: Any) -> list[tuple[str, NDArray[Any], Any]]:
    """Polygons by their number of corners; polyhedra as what they are, with no more than a point each."""
    index = hdf5.array(group, "INN" if name != _POLYHEDRA else "INF") - 1
    nodes, sizes = hdf5.array(group, "NOD") - 1, np.diff(index)
    if len(index) and (index[0] < 0 or index[-1] > len(nodes) or (sizes < 0).any()):
        raise InputError(f"has cells of kind {name!r} that lie beyond the list of their {len(nodes)} nodes")
    if name == _POLYHEDRA:
        return [("polyhedron", nodes[:1].repeat(len(sizes))[:, None], slice(None))]
    made = []
    for size in np.unique(sizes).tolist():
        rows = np.flatnonzero(sizes == size)
        made.append(("polygon", nodes[index[rows][:, None] + np.arange(size)], rows))
    return made


def _point_groups(raw: RawMesh, points: Any, families: dict[int, Family]) -> None:
    if "FAM" not in points:
        return
    numbers = _families(points, "points")
    if len(numbers) != len(raw.points):
        raise InputError(f"has families of {len(numbers)} points; it has {len(raw.points)}")
    if not set(np.unique(numbers).tolist()) <= {0, *(number for number, one in families.items() if one.groups)}:
        raw.point_data["point_tags"] = numbers  # no group says it
    for name in dict.fromkeys(name for one in families.values() for name in one.groups):
        members = [number for number, one in families.items() if name in one.groups]
        raw.point_sets[name] = np.flatnonzero(np.isin(numbers, members))
        read_limit.claim(raw.point_sets[name].nbytes, f"group {name!r}")
