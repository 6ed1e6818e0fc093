"""Legacy dolfin's ``.xml`` meshes, with the tags of cells and facets in them or beside them."""

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import safe_xml
from wct_plugin.io.companions import companion, folder_of
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.io.text_lines import whole_number, whole_numbers

#: By the type of cell: meshio's name, and the number of corners.
_KINDS = {"tetrahedron": ("tetra", 4), "triangle": ("triangle", 3), "interval": ("line", 2)}
_FACETS = {"tetra": "triangle", "triangle": "line", "line": "vertex"}
_TAGS = "cell_tags"


def read(path: Path, root: ET.Element) -> tuple[RawMesh, list[str]]:
    """Points and cells, and the tags of cells and facets. Tags of edges and points are named as left out."""
    mesh = root.find("mesh")
    kind = "" if mesh is None else mesh.get("celltype", "")
    if mesh is None or kind not in _KINDS:
        raise InputError(f"has a mesh of {kind or 'no'} cells; allowed are {', '.join(_KINDS)}")
    points = _table(mesh.find("vertices"), "vertex", ["x", "y", "z"])
    points = points[:, ~np.isnan(points).all(axis=0)]
    name, width = _KINDS[kind]
    cells = _table(mesh.find("cells"), kind, [f"v{k}" for k in range(width)])
    raw = RawMesh(points, [RawBlock(name, whole_numbers(cells))])
    lost: list[str] = []
    _put_tags(raw, mesh, "the mesh", lost)
    for file in sorted(folder_of(path).glob(f"{_escaped(path.stem)}_*_region.xml")):  # where dolfin-convert puts them
        _put_tags(raw, safe_xml.parse(companion(path, file.name).read_bytes()), file.name, lost)
    return raw, lost


def _put_tags(raw: RawMesh, parent: ET.Element, where: str, lost: list[str]) -> None:
    """The tags in an element: values by cell and side, or one for each cell; facets have numbers of dolfin's own."""
    for collection in parent.iter("mesh_value_collection"):
        _put_values(raw, collection, where, lost)
    for function in (child for child in parent.iter() if child.tag in ("mesh_function", "meshfunction")):
        if function.find("mesh_value_collection") is not None:
            continue
        if whole_number(function.get("dim", "-1"), "a dimension") != raw.cells[0].data.shape[1] - 1:
            lost.append(f"tags of dimension {function.get('dim')} in {where}, by numbers that only dolfin knows")
            continue
        table = _table(function, "entity", ["value"])[:, 0]
        if len(table) != len(raw.cells[0]):
            raise InputError(f"has {len(table)} tags in {where} for {len(raw.cells[0])} cells")
        table[table >= 2.0**63] = 0  # dolfin's largest number stands for none
        _put_cell_tags(raw, np.arange(len(table)), whole_numbers(table))


def _escaped(name: str) -> str:
    return "".join(f"[{letter}]" if letter in "*?[" else letter for letter in name)


def _table(parent: ET.Element | None, tag: str, keys: list[str]) -> NDArray[np.float64]:
    """One row per element, in the order of their indices; NaN for keys that none has."""
    rows = [] if parent is None else parent.findall(tag)
    if parent is None or len(rows) != whole_number(parent.get("size") or str(len(rows)), "the size"):
        raise InputError(
            f"has {len(rows)} {tag} elements but announces {'none' if parent is None else parent.get('size')}"
        )
    index = np.array([whole_number(row.get("index", "-1"), "an index") for row in rows], dtype=np.int64)
    if not np.array_equal(np.sort(index), np.arange(len(rows))):
        raise InputError(f"its {tag} elements are not numbered from 0 to {len(rows) - 1}")
    made = np.empty((len(rows), len(keys)))
    made[index] = [[_real(row.get(key, "nan")) for key in keys] for row in rows]
    return made


def _real(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise InputError(f"has {word[:40]!r} where a number should be") from None


def _put_values(raw: RawMesh, collection: ET.Element, where: str, lost: list[str]) -> None:
    """Values by cell and number of its side; side k lies opposite the k-th corner, corners in ascending order."""
    cells = raw.cells[0].data
    below = cells.shape[1] - 1 - whole_number(collection.get("dim", "-1"), "a dimension")
    rows = collection.findall("value")
    values = np.array(
        [[whole_number(row.get(key, "-1"), key) for key in ("cell_index", "local_entity")] for row in rows],
        dtype=np.int64,
    ).reshape(-1, 2)
    tags = whole_numbers(np.array([_real(row.get("value", "0")) for row in rows]))
    inside = (values >= 0).all() and (values[:, 0] < len(cells)).all() and (values[:, 1] < cells.shape[1]).all()
    if not inside:
        raise InputError(f"has tags in {where} of cells or sides that are not there; there are {len(cells)} cells")
    if below == 0:
        _put_cell_tags(raw, values[:, 0], tags)
    elif below == 1:
        corners = np.sort(cells[values[:, 0]], axis=1)
        others = np.arange(cells.shape[1])[None] != values[:, 1:]
        sides, first = np.unique(corners[others].reshape(-1, cells.shape[1] - 1), axis=0, return_index=True)
        raw.cells.append(RawBlock(_FACETS[raw.cells[0].type], sides))
        for columns in raw.cell_data.values():
            columns.append(None)
        raw.cell_data.setdefault(_TAGS, [None] * len(raw.cells))[-1] = tags[first]
    else:
        lost.append(f"tags of dimension {collection.get('dim')} in {where}")


def _put_cell_tags(raw: RawMesh, rows: NDArray[np.int64], tags: NDArray[np.int64]) -> None:
    column = np.zeros(len(raw.cells[0]), dtype=np.int64)
    column[rows] = tags
    raw.cell_data.setdefault(_TAGS, [None] * len(raw.cells))[0] = column
