"""The writers: meshio's where they do, our own where it fails or cannot; called by :mod:`.writer` alone."""

import contextlib
import io
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from wct_plugin.io import (
    abaqus_writer,
    gmsh22,
    gmsh41,
    med_families,
    med_writer,
    medit,
    medit_writer,
    obj,
    off,
    ply,
    su2,
    tetgen,
)
from wct_plugin.io.assembly import NAME
from wct_plugin.io.formats import Format
from wct_plugin.io.gmsh_options import MshOptions
from wct_plugin.io.meshio_modules import meshio_module
from wct_plugin.io.node_orders import in_gmsh, in_med
from wct_plugin.io.periodic_sides import PeriodicSides
from wct_plugin.mesh import SurfaceMesh, TetMesh, cell_kinds

Arrays = dict[str, NDArray[Any]]


@dataclass
class Content:
    """What meshio gets: arrays of our own, so that it may change them as it likes."""

    points: NDArray[np.float64]
    cells: list[tuple[str, NDArray[np.int64]]]
    point_data: Arrays = field(default_factory=dict)
    cell_data: dict[str, list[NDArray[Any]]] = field(default_factory=dict)
    point_sets: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    cell_sets: dict[str, list[NDArray[np.int64]]] = field(default_factory=dict)
    names: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    #: By kind of cell, the members of groups that share cells.
    groups: dict[str, dict[int, NDArray[np.int64]]] = field(default_factory=dict)
    periodic: list[PeriodicSides] = field(default_factory=list)
    comments: list[str] = field(default_factory=list)  #: of Abaqus: the numbers of tags
    types: dict[str, str] = field(default_factory=dict)  #: of Abaqus: the type of elements, by kind of cell

    def mesh(self, **extra: Any) -> Any:
        """All of it but the names as a meshio mesh."""
        module: Any = meshio_module()

        class Block(module.CellBlock):  # type: ignore[misc]  # whose own list of kinds is not whole
            def __init__(self, kind: str, data: NDArray[np.int64]) -> None:
                self.type, self.data, self.dim = kind, data, cell_kinds.dimension(kind)
                self.tags: list[str] = []

        return module.Mesh(
            self.points,
            [Block(kind, cells) for kind, cells in self.cells],
            point_data=self.point_data,
            cell_data=self.cell_data,
            point_sets=self.point_sets,
            cell_sets=self.cell_sets,
            **extra,
        )


def save(path: Path, form: Format, mesh: TetMesh | SurfaceMesh, content: Content, msh: MshOptions) -> list[str]:
    """Write the file; returns what meshio complains of on the way."""
    if isinstance(mesh, SurfaceMesh) and form.name in ("PLY", "OBJ", "OFF"):
        match form.name:
            case "PLY":
                cell_data = {name: columns[0] for name, columns in content.cell_data.items()}
                ply.write(path, mesh, cell_data, content.point_data)
            case "OBJ":
                obj.write(path, mesh)
            case "OFF":
                off.write(path, mesh)
        return []
    if form.name == "SU2":
        _write_su2(path, content)
        return []
    if form.name == "gmsh":
        _write_gmsh(path, content, msh)
        return []
    if form.name == "Abaqus":
        sets = content.point_sets, content.cell_sets
        abaqus_writer.write(path, content.points, content.cells, *sets, content.types, content.comments)
        return []
    if form.name == "MED":
        _write_med(path, content)
        return []
    if form.name == "Medit":
        references = content.cell_data[medit.REFERENCES]
        medit_writer.write(
            path, content.points, content.point_data[medit.REFERENCES], content.cells, references, content.cell_sets
        )
        return []
    with _overheard() as said, np.errstate(invalid="ignore", divide="ignore"):  # STL normals of slivers
        match form.name:
            case "XDMF":
                _write_xdmf(path, content)
            case "TetGen":
                return _write_tetgen(path, content)
            case _:
                meshio_module(form.module).write(str(path), content.mesh())
                if form.name == "VTU" and content.names:
                    _add_names(path, content.names)
                if form.name == "Nastran":
                    _use_standard_names(path)
    return said


@contextlib.contextmanager
def _overheard() -> Iterator[list[str]]:
    """Keep meshio from printing; afterwards the list holds its warnings, each one line."""
    said: list[str] = []
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        yield said
    said += [" ".join(part.split()) for part in err.getvalue().split("Warning:")[1:]]


def _use_standard_names(path: Path) -> None:
    """Meshio calls elements of second order CTETRA_ and so on, which Nastran does not know."""
    text = path.read_text()
    path.write_text(re.sub(r"^(C(?:TETRA|PYRA|PENTA|HEXA))_", r"\1 ", text, flags=re.MULTILINE))


def _write_gmsh(path: Path, content: Content, msh: MshOptions) -> None:
    """Meshio's text has arrays that nothing reads, and its version 4.1 groups that neither gmsh nor meshio reads."""
    points, names = content.points, content.names
    cells = [(kind, in_gmsh(kind, rows)) for kind, rows in content.cells]
    point_data, cell_data, binary = content.point_data, content.cell_data, bool(msh.binary)
    periodic = content.periodic
    if msh.version == "4.1":
        gmsh41.write(path, points, cells, content.groups, names, point_data, cell_data, periodic, binary=binary)
    else:
        gmsh22.write(path, points, cells, names, point_data, cell_data, periodic, binary=binary)


def _write_xdmf(path: Path, content: Content) -> None:
    """Meshio leaves its HDF5 file to the garbage collector, where a full disk goes unnoticed; so it gets none."""
    import h5py  # type: ignore[import-untyped]

    made_by = meshio_module("xdmf.main").XdmfWriter
    heavy = path.with_suffix(".h5")
    buffer = io.BytesIO()
    writer = made_by.__new__(made_by)
    writer.filename, writer.h5_filename, writer.data_format = path, heavy, "HDF"
    writer.data_counter, writer.compression, writer.compression_opts = 0, "gzip", 4
    root = ET.Element("Xdmf", Version="3.0")
    grid = ET.SubElement(ET.SubElement(root, "Domain"), "Grid", Name="Grid")
    mesh = content.mesh()
    with h5py.File(buffer, "w") as writer.h5_file:
        writer.write_points(grid, mesh.points)
        writer.write_cells(mesh.cells, grid)
        writer.write_point_data(mesh.point_data, grid)
        writer.write_cell_data(mesh.cell_data, grid)
    heavy.write_bytes(buffer.getvalue())
    path.write_bytes(ET.tostring(root))


def _write_med(path: Path, content: Content) -> None:
    cell_data = dict(content.cell_data)
    tags = cell_data.pop(med_families.TAGS)
    cells = [(kind, in_med(kind, rows)) for kind, rows in content.cells]
    med_writer.write(
        *(path, content.points, cells, tags, content.point_sets, content.cell_sets, content.names),
        *(content.point_data, cell_data),
    )


def _write_tetgen(path: Path, content: Content) -> list[str]:
    cells = dict(content.cells)
    tags = dict(zip(cells, content.cell_data[tetgen.TAGS], strict=True))
    tets = replace(content, cells=content.cells[:1], cell_data={tetgen.TAGS: [tags["tetra"]]})
    meshio_module("tetgen").write(str(path), tets.mesh())
    no_facets = np.empty((0, 3), dtype=np.int64), np.empty(0, dtype=np.int64)
    return tetgen.write_facets(path, cells.get("triangle", no_facets[0]), tags.get("triangle", no_facets[1]))


def _write_su2(path: Path, content: Content) -> None:
    names = {int(tag): name for name, (tag, dimension) in content.names.items() if dimension == 2}
    su2.write(path, content.points, content.cells, content.cell_data["su2:tag"], names)


def _add_names(path: Path, names: dict[str, NDArray[np.int64]]) -> None:
    """Physical names as field data, where meshio reads them and ParaView shows them; meshio writes none."""
    arrays = "".join(
        f'<DataArray type="Int64" Name="{attribute(NAME + name)}" NumberOfTuples="2" format="ascii">'
        f"{tag} {dimension}</DataArray>\n"
        for name, (tag, dimension) in names.items()
    )
    head, grid, rest = path.read_bytes().partition(b"<UnstructuredGrid>\n")
    path.write_bytes(head + grid + f"<FieldData>\n{arrays}</FieldData>\n".encode() + rest)


def attribute(name: str) -> str:
    """The name as it has to stand in XML."""
    return quoteattr(name, {'"': "&quot;"})[1:-1].encode("ascii", "xmlcharrefreplace").decode()
