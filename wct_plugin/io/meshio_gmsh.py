"""Meshio's reader of gmsh's files with two mistakes of meshio 5.3.5 put right, in copies of its modules."""

import importlib.util
from pathlib import Path
from types import FunctionType
from typing import Any

from wct_plugin.io.meshio_modules import meshio_module


def read(path: str) -> Any:
    """The file as a mesh of meshio's."""
    main = meshio_module("gmsh.main")
    mended = {"meshio.gmsh._gmsh22": _version_2(), "meshio.gmsh._gmsh41": _version_4()}
    readers = {version: mended.get(module.__name__, module) for version, module in main._readers.items()}
    read_buffer = FunctionType(main.read_buffer.__code__, {**vars(main), "_readers": readers})
    with Path(path).open("rb") as file:
        return read_buffer(file)


def _copy(name: str) -> Any:
    """A module of meshio's once more, which nobody else has."""
    spec = importlib.util.find_spec(name)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _version_2() -> Any:
    """Cell data of files with several kinds of cells is cut into pieces of length 2."""
    module, common = _copy("meshio.gmsh._gmsh22"), meshio_module("_common")

    def cell_data_from_raw(cells: Any, raw: Any) -> Any:
        return common.cell_data_from_raw([values for _, values in cells], raw)

    module.cell_data_from_raw = cell_data_from_raw
    return module


def _version_4() -> Any:
    """Where only some entities are in a physical group, meshio leaves the others out and then fails."""
    module = _copy("meshio.gmsh._gmsh41")
    original = module._read_entities

    def read_entities(*args: Any) -> Any:
        physical, bounding = original(*args)
        return tuple({tag: groups or [0] for tag, groups in tags.items()} for tags in physical), bounding

    module._read_entities = read_entities
    return module
