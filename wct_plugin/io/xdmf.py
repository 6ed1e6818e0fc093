"""XDMF files: one mesh in one grid or several, as of dolfinx with its tags, collections, and series in time."""

import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import safe_xml, vtk_cells
from wct_plugin.io.pieces import joined
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.text_lines import whole_number
from wct_plugin.io.xdmf_cells import Table, table
from wct_plugin.io.xdmf_items import XdmfFile
from wct_plugin.io.xdmf_tags import one_mesh


@dataclass
class Grid:
    """A grid of the file that has cells of its own."""

    name: str
    points: NDArray[Any]
    cells: Table
    point_data: dict[str, NDArray[Any]] = field(default_factory=dict)
    cell_data: dict[str, NDArray[Any]] = field(default_factory=dict)

    def raw(self) -> RawMesh:
        """The grid as a mesh."""
        blocks, cell_data = vtk_cells.blocks(*self.cells, self.cell_data)
        return RawMesh(self.points, blocks, dict(self.point_data), cell_data)


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the file holds, and what of it is left out. Raises :class:`InputError` without the file's name."""
    root = safe_xml.parse(path.read_bytes())
    if root.tag != "Xdmf":
        raise InputError(f"holds {root.tag}; expected Xdmf")
    lost: list[str] = []
    notes: list[str] = []
    file = XdmfFile(path, root)
    chosen = [grid for domain in root.iter("Domain") for grid in _leaves(domain, notes, lost)]
    grids = [_grid(file, element, lost) for element in chosen]
    if not grids:
        raise InputError("has no grid")
    parts: list[list[Grid]] = []
    for grid in grids:
        same = next((part for part in parts if np.array_equal(part[0].points, grid.points)), None)
        if same is None:
            parts.append([grid])
        else:
            same.append(grid)
    made = joined([one_mesh([(grid.name, grid.raw()) for grid in part]) for part in parts], lost)
    made.notes[:0] = notes
    return made, list(dict.fromkeys(lost))


def _leaves(parent: ET.Element, notes: list[str], lost: list[str]) -> list[ET.Element]:
    """The grids that are no collections; of a series in time those of the last step."""
    found = []
    for grid in parent.iterfind("Grid"):
        kind = grid.get("GridType", "Uniform")
        if kind == "Uniform":
            found.append(grid)
        elif kind == "Collection" and grid.get("CollectionType", "Spatial") == "Temporal":
            steps = grid.findall("Grid")
            if len(steps) > 1:
                time = steps[-1].find("Time")
                at = f" at time {time.get('Value')}" if time is not None and time.get("Value") else ""
                notes.append(f"has {len(steps)} steps of {grid.get('Name') or 'a series'!r}; the last{at} is taken")
            last = ET.Element("Domain")
            last.extend(steps[-1:])
            found += _leaves(last, notes, lost)
        elif kind in ("Collection", "Tree"):
            found += _leaves(grid, notes, lost)
        else:
            lost.append(f"grid {grid.get('Name')!r} of type {kind}")
    return found


def _grid(file: XdmfFile, element: ET.Element, lost: list[str]) -> Grid:
    element = file.resolved(element)
    name = element.get("Name") or ""
    children = file.children(element)
    geometry, topology = (
        next((child for child in children if child.tag == tag), None) for tag in ("Geometry", "Topology")
    )
    if geometry is None or topology is None:
        raise InputError(f"grid {name!r} lacks a Geometry or a Topology")
    made = Grid(name, _points(file, geometry), _cells(file, topology))
    counts = {"node": len(made.points), "cell": len(made.cells[0])}
    for child in children:
        if child.tag != "Attribute":
            continue
        title, center = child.get("Name") or "", (child.get("Center") or "Node").lower()
        item = child.find("DataItem")
        if item is None or center not in counts or child.get("ItemType") == "FiniteElementFunction":
            lost.append(f"attribute {title!r} of {child.get('ItemType') or center}")
            continue
        values = file.values(item)
        values = values[:, 0] if values.ndim == 2 and values.shape[1] == 1 else values
        if not values.ndim or len(values) != counts[center]:
            raise InputError(f"attribute {title!r} has {len(values)} values for {counts[center]} {center}s")
        (made.point_data if center == "node" else made.cell_data)[title] = values
    return made


def _points(file: XdmfFile, geometry: ET.Element) -> NDArray[Any]:
    kind = (geometry.get("GeometryType") or geometry.get("Type") or "XYZ").upper()
    items = geometry.findall("DataItem")
    if not items or kind not in ("XYZ", "XY", "X_Y_Z", "X_Y"):
        raise InputError(f"has a geometry of type {kind!r} and {len(items)} arrays; allowed are XYZ, XY, X_Y_Z and X_Y")
    arrays = [file.values(item) for item in items]
    if "_" in kind:
        arrays = [array.ravel() for array in arrays]
        if len({len(array) for array in arrays}) > 1:
            raise InputError(f"has a geometry of {' and '.join(str(len(array)) for array in arrays)} coordinates")
        return np.column_stack(arrays)
    if arrays[0].size % len(kind):
        raise InputError(f"has a geometry of {arrays[0].size} coordinates; expected {len(kind)} for each point")
    return arrays[0].reshape(-1, len(kind))


def _cells(file: XdmfFile, topology: ET.Element) -> Table:
    kind = topology.get("TopologyType") or topology.get("Type") or ""
    item = topology.find("DataItem")
    if item is None:
        raise InputError(f"has a topology of type {kind!r} without cells; allowed are those with a list of cells")
    values = file.values(item)
    if values.dtype.kind not in "iu":
        raise InputError("has a topology that is not of whole numbers")
    made = table(kind, values, whole_number(topology.get("NodesPerElement") or "0", "NodesPerElement"))
    types, starts, points = made
    # The dimensions of what is no structured grid are the number of its cells.
    announced = topology.get("NumberOfElements") or topology.get("Dimensions")
    if announced and announced.split() != [str(len(types))]:
        raise InputError(f"has {len(types)} cells but announces {announced.strip()}")
    return types, starts, points - whole_number(topology.get("BaseOffset") or "0", "BaseOffset")
