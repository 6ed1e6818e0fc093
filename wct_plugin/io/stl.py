"""STL surfaces, text and binary: meshio's reader takes a text line by line.

The same point is the same vertex; normals and the two bytes of each binary facet are left.
"""

from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.io.text_lines import number_rows
from wct_plugin.mesh.coincident_points import distinct_points
from wct_plugin.types import Floats

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_HEAD = 84


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """The facets. Raises :class:`InputError`, without the file's name, for a short or malformed file."""
    data = path.read_bytes()
    count = int.from_bytes(data[_HEAD - 4 : _HEAD], "little")
    if len(data) == _HEAD + _FACET.itemsize * count:
        corners = np.frombuffer(data, _FACET, count, _HEAD)["corners"].reshape(-1, 3).astype(np.float64)
    elif data[-1000:].rstrip().rpartition(b"\n")[2].strip().lower().startswith(b"endsolid"):
        corners = _text_corners(data)
    else:
        raise InputError("is neither text that ends with 'endsolid' nor binary of the length it declares")
    points, place = distinct_points(corners)
    return RawMesh(points, [RawBlock("triangle", place.reshape(-1, 3))]), []


def _text_corners(data: bytes) -> Floats:
    """(3 k, 3) the corners of facets in text."""
    values, widths = number_rows(data, np.float64, b"vertex")
    facets = data.count(b"endfacet") or data.lower().count(b"endfacet")
    if (widths != 3).any() or len(widths) != 3 * facets:
        raise InputError(
            f"has {facets} facets and {len(widths)} vertices of {len(values)} coordinates in all; expected 3 vertices "
            "of 3 for each facet"
        )
    return values.reshape(-1, 3)
