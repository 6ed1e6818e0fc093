"""What a case of another library's mesh runs: a mesh becomes the library's, goes through a filter, and is written."""

import json
from collections.abc import Sequence
from typing import Any

import meshio
import numpy as np

import wct_plugin as wct


def _object(library: str) -> Any:
    mesh = meshio.read("in.vtu")
    if library == "meshio":
        return mesh
    if library == "pyvista":
        import pyvista as pv

        return pv.from_meshio(mesh)
    return np.asarray(mesh.points), np.asarray(mesh.cells_dict["tetra"])


def main(arguments: Sequence[str]) -> int:
    """Do so; errors that are said are one line and exit code 2, as of a command."""
    library, name, options = arguments
    apply: Any = wct.apply_filter  # whose signatures know only names that are written out
    try:
        made, _ = apply(name, _object(library), **json.loads(options))
        wct.write("out.vtu", wct.as_mesh(made))
    except wct.WctError as error:
        print(f"error: {error}")  # noqa: T201
        return 2
    return 0
