"""Meshes in ``.xml`` files: of PyDEC and of dolfin, told apart by their root element."""

from pathlib import Path

from wct_plugin.errors import InputError
from wct_plugin.io import dolfin_xml, pydec_xml, safe_xml
from wct_plugin.io.raw_mesh import RawMesh


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the file holds, and what of it is left out. Raises :class:`InputError` without the file's name."""
    root = safe_xml.parse(path.read_bytes())
    if root.tag == "dolfin":
        return dolfin_xml.read(path, root)
    if root.tag == "mesh":
        return pydec_xml.read(path, root)
    raise InputError(f"begins with <{root.tag}>; allowed are <mesh> of PyDEC and <dolfin>")
