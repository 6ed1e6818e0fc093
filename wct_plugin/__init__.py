"""Well-centered tetrahedral meshes: every tet, and every triangle, contains its circumcenter.

>>> import wct_plugin as wct
>>> mesh = wct.read("part.msh")  # doctest: +SKIP
>>> mesh, metrics = wct.apply_filter("meshing_well_centered", mesh)  # doctest: +SKIP
>>> wct.write("part.vtu", mesh)  # doctest: +SKIP
>>> chain = wct.Reader("bone.ply") | wct.Filter.generate_tetrahedralization() | wct.Filter.meshing_well_centered()
>>> result = (chain | wct.Writer("bone.vtu") | wct.Writer("bone.html")).execute()  # doctest: +SKIP

Names are imported when first asked for, so that importing a part of the package imports that part alone.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wct_plugin.batch.run import run_batch
    from wct_plugin.errors import (
        InputError,
        InternalError,
        NeighbourError,
        OptionError,
        OutputError,
        WctError,
        WctWarning,
    )
    from wct_plugin.io import read, write
    from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh
    from wct_plugin.pipeline.constructors import Filter, Reader, Writer
    from wct_plugin.pipeline.pipeline import Pipeline
    from wct_plugin.pipeline.result import Result
    from wct_plugin.pipeline.stage import apply_filter
    from wct_plugin.pipeline.time_limit import TimeLimit

#: Where each public name comes from.
_HOMES = {
    "Cells": "wct_plugin.mesh",
    "Filter": "wct_plugin.pipeline.constructors",
    "InputError": "wct_plugin.errors",
    "InternalError": "wct_plugin.errors",
    "NeighbourError": "wct_plugin.errors",
    "OptionError": "wct_plugin.errors",
    "OutputError": "wct_plugin.errors",
    "Pipeline": "wct_plugin.pipeline.pipeline",
    "Reader": "wct_plugin.pipeline.constructors",
    "Result": "wct_plugin.pipeline.result",
    "SurfaceMesh": "wct_plugin.mesh",
    "TetMesh": "wct_plugin.mesh",
    "TimeLimit": "wct_plugin.pipeline.time_limit",
    "WctError": "wct_plugin.errors",
    "WctWarning": "wct_plugin.errors",
    "Writer": "wct_plugin.pipeline.constructors",
    "apply_filter": "wct_plugin.pipeline.stage",
    "read": "wct_plugin.io",
    "run_batch": "wct_plugin.batch.run",
    "write": "wct_plugin.io",
}

__all__ = [
    "Cells",
    "Filter",
    "InputError",
    "InternalError",
    "NeighbourError",
    "OptionError",
    "OutputError",
    "Pipeline",
    "Reader",
    "Result",
    "SurfaceMesh",
    "TetMesh",
    "TimeLimit",
    "WctError",
    "WctWarning",
    "Writer",
    "apply_filter",
    "read",
    "run_batch",
    "write",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value  # so that it is looked up once
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
