"""What gmsh's files of versions 2.2 and 4.1 have in common: rows of numbers, physical names and arrays."""

from collections.abc import Mapping
from itertools import chain
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from wct_plugin.io import gmsh_kinds
from wct_plugin.mesh import cell_kinds

#: Dimension and gmsh's number of each kind of cell.
KINDS = {kind.name: (cell_kinds.dimension(kind.name), number) for number, kind in gmsh_kinds.KINDS.items()}
#: Arrays that stand in the file as groups and entities, not as data.
OWN = ("gmsh:physical", "gmsh:geometrical")


def put(file: BinaryIO, binary: bool, *columns: Any) -> None:
    """Write arrays of n rows side by side: their bytes, or a line of text per row.

    The text of a number has the digits that give the same bits when it is read.
    """
    tables = [np.ascontiguousarray(column).reshape(len(column), -1) for column in columns]
    if binary:
        file.write(np.hstack([table.view(np.uint8) for table in tables]).tobytes())
        return
    rows = zip(*(table.tolist() for table in tables), strict=True)
    file.writelines((" ".join(map(repr, chain.from_iterable(row))) + "\n").encode() for row in rows)


def end(file: BinaryIO, binary: bool, section: str) -> None:
    """Write the line that ends a section of rows; in binary files a line break goes before it."""
    file.write(f"{chr(10) * binary}$End{section}\n".encode())


def put_format(file: BinaryIO, binary: bool, version: str) -> None:
    """Write what a file begins with; in binary files a 1, which tells the order of the bytes."""
    file.write(f"$MeshFormat\n{version} {int(binary)} 8\n".encode())
    if binary:
        file.write(np.int32(1).tobytes() + b"\n")
    file.write(b"$EndMeshFormat\n")


def put_names(file: BinaryIO, names: Mapping[str, Any]) -> None:
    """Write the physical names, ``names``: (tag, dimension) of each; they are text in binary files too."""
    if names:
        rows = sorted((int(dimension), int(tag), name) for name, (tag, dimension) in names.items())
        lines = [f'{dimension} {tag} "{name}"\n' for dimension, tag, name in rows]
        file.write(f"$PhysicalNames\n{len(rows)}\n{''.join(lines)}$EndPhysicalNames\n".encode())


def put_data(file: BinaryIO, binary: bool, section: str, name: str, values: NDArray[Any]) -> None:
    """Write an array per point (``NodeData``) or per cell (``ElementData``) of 1, 3 or 9 columns."""
    table = values.reshape(len(values), -1).astype(np.float64)
    # One text, the name; one real, the time; three integers: the time step, columns and rows.
    file.write(f'${section}\n1\n"{name}"\n1\n0.0\n3\n0\n{table.shape[1]}\n{len(table)}\n'.encode())
    put(file, binary, np.arange(1, len(table) + 1, dtype=np.int32), table)
    end(file, binary, section)
