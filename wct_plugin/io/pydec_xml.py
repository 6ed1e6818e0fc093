"""PyDEC's meshes: an ``.xml`` file that names a file of vertices and one of elements."""

import xml.etree.ElementTree as ET
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io.companions import companion
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.io.text_lines import numbers_of_type, shown, whole_number

_KINDS = {2: "line", 3: "triangle", 4: "tetra"}
_DTYPES = ("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", "float32", "float64")
#: What the elements are called: of old, and by newer versions.
_ELEMENTS = ("elements", "indices")


def read(path: Path, root: ET.Element) -> tuple[RawMesh, list[str]]:
    """Vertices and elements, and what else is named."""
    if root.get("type", "simplicial_mesh") != "simplicial_mesh":
        raise InputError(f"is a mesh of type {root.get('type')!r}; allowed is simplicial_mesh")
    files = {child.tag: child.find("file") for child in root}
    name = next((name for name in _ELEMENTS if name in files), "elements")
    vertices, elements = (_array(path, files.get(key), key) for key in ("vertices", name))
    if vertices.ndim != 2 or elements.ndim != 2 or elements.shape[1] not in _KINDS or elements.dtype.kind not in "iu":
        raise InputError(f"has vertices of shape {vertices.shape} and elements of shape {elements.shape}")
    raw = RawMesh(vertices, [RawBlock(_KINDS[elements.shape[1]], elements.astype(np.int64))])
    return raw, [f"array {key!r}" for key in files if key not in ("vertices", name)]


def _array(path: Path, element: ET.Element | None, key: str) -> NDArray[Any]:
    """An array in a file of its own: a count of lines KEY=VALUE, these lines, the numbers as text or bytes."""
    if element is None or not element.get("name"):
        raise InputError(f"names no file of {key}; expected <{key}><file name=...>")
    name = element.get("name", "")
    first, _, rest = companion(path, name).read_bytes().partition(b"\n")
    if not first.strip().isdigit():
        raise InputError(f"{name} begins with {shown(first)}; expected the number of its keys")
    *lines, body = rest.split(b"\n", int(first)) if int(first) < 100 else [rest]
    head = dict(line.decode("ascii", "replace").strip().split("=", 1) for line in lines if b"=" in line)
    sizes = head.get("dims", "").split(",")
    shape = tuple(whole_number(size.strip(), f"in {name} a size in dims") for size in sizes if size.strip())
    kind = head.get("dtype", "")
    if head.get("format") not in ("basic", "ascii", "binary") or kind not in _DTYPES:
        raise InputError(
            f"{name} has format={head.get('format')} and dtype={kind}; allowed are basic, ascii and binary"
        )
    dtype = np.dtype(kind)
    if head["format"] == "binary":
        values = np.frombuffer(body, dtype.newbyteorder("<")).astype(dtype)
    else:
        values = numbers_of_type(body, dtype)
    if not shape or min(shape) < 0 or prod(shape) != len(values):
        raise InputError(f"{name} has {len(values)} numbers but announces {head.get('dims')}")
    return values.reshape(shape)
