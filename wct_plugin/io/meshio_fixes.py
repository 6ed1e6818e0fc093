"""Mistakes of meshio 5.3.5 in reading good files, put right in meshio itself; doing so again changes nothing."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.io.formats import Format


def mend(form: Format) -> None:
    """Put meshio's reader of this format right."""
    match form.name:
        case "VTK":
            _vtk()
        case "gmsh":
            _gmsh22()
            _gmsh41()
        case "XDMF":
            _xdmf()
        case "MED":
            _med()


def _vtk() -> None:
    """Meshio takes VTK's 4-byte ``int`` for 8 bytes and knows neither ``unsigned_char`` nor its kin."""
    from meshio.vtk import _vtk_42, _vtk_51

    _vtk_51.vtk_to_numpy_dtype_name.update(_vtk_42.vtk_to_numpy_dtype_name)


def _gmsh22() -> None:
    """Cell data of files with several kinds of cells is cut into pieces of length 2."""
    from meshio import _common
    from meshio.gmsh import _gmsh22

    def cell_data_from_raw(cells: Any, raw: Any) -> Any:
        return _common.cell_data_from_raw([values for _, values in cells], raw)

    _gmsh22.cell_data_from_raw = cell_data_from_raw


def _gmsh41() -> None:
    """Where only some entities are in a physical group, meshio leaves the others out and then fails."""
    from meshio.gmsh import _gmsh41

    original = getattr(_gmsh41._read_entities, "original", _gmsh41._read_entities)

    def read_entities(*args: Any) -> Any:
        physical, bounding = original(*args)
        return tuple({tag: groups or [0] for tag, groups in tags.items()} for tags in physical), bounding

    read_entities.original = original  # type: ignore[attr-defined]
    _gmsh41._read_entities = read_entities


def _med() -> None:
    """Meshio fails on families that belong to no group, which gmsh writes for every entity."""
    from meshio.med import _med

    original = getattr(_med._read_families, "original", _med._read_families)

    def read_families(families: Any) -> Any:
        return original({name: family for name, family in families.items() if "GRO" in family})

    read_families.original = original  # type: ignore[attr-defined]
    _med._read_families = read_families


def _xdmf() -> None:
    """Mixed cells with single vertices are written with a length, as XDMF has it, but read as if without."""
    from meshio import CellBlock
    from meshio._common import num_nodes_per_cell
    from meshio.xdmf import common, main

    def translate_mixed_cells(data: NDArray[np.int64]) -> list[Any]:
        blocks, start = [], 0
        while start < len(data):
            code = int(data[start])
            kind = common.xdmf_idx_to_meshio_type[code]
            head = 2 if kind in ("vertex", "line") else 1
            width = head + num_nodes_per_cell[kind]
            codes = data[start::width]
            count = int(np.argmax(codes != code)) or len(codes)
            cells = data[start : start + count * width].reshape(count, width)
            if head == 2 and (cells[:, 1] != width - head).any():
                raise ValueError("only lines of two points and single vertices are supported")
            blocks.append(CellBlock(kind, cells[:, head:]))
            start += count * width
        return blocks

    main.translate_mixed_cells = translate_mixed_cells
