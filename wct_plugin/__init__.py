"""Well-centered tetrahedral meshes: every tet, and every triangle, contains its circumcenter.

>>> import wct_plugin as wct
>>> mesh = wct.read("part.msh")  # doctest: +SKIP
>>> mesh, metrics = wct.apply_filter("meshing_well_centered", mesh)  # doctest: +SKIP
>>> wct.write("part.vtu", mesh)  # doctest: +SKIP
>>> grid = wct.optimize(grid)  # of meshio, pyvista, skfem, ...: the same comes back  # doctest: +SKIP
>>> chain = wct.Reader("bone.ply") | wct.Filter.generate_tetrahedralization() | wct.Filter.meshing_well_centered()
>>> result = (chain | wct.Writer("bone.vtu") | wct.Writer("bone.html")).execute()  # doctest: +SKIP

Names are imported when first asked for, so that importing a part of the package imports that part alone.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wct_plugin.batch.run import run_batch
    from wct_plugin.duals.dual_files import write_dual
    from wct_plugin.errors import (
        InputError,
        InternalError,
        NeighbourError,
        ObjectError,
        OptionError,
        OutputError,
        WctError,
        WctWarning,
    )
    from wct_plugin.io import read, write
    from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh
    from wct_plugin.objects.arrays_meshes import to_arrays
    from wct_plugin.objects.conversions import as_mesh
    from wct_plugin.objects.dolfinx_meshes import from_dolfinx
    from wct_plugin.objects.gmsh_meshes import from_gmsh, to_gmsh
    from wct_plugin.objects.meshio_meshes import to_meshio
    from wct_plugin.objects.pymeshlab_meshes import to_pymeshlab
    from wct_plugin.objects.pyvista_meshes import to_pyvista
    from wct_plugin.objects.skfem_meshes import to_skfem
    from wct_plugin.objects.trimesh_meshes import to_trimesh
    from wct_plugin.pipeline.one_line import report
    from wct_plugin.pipeline.pipeline import Pipeline
    from wct_plugin.pipeline.result import Result
    from wct_plugin.pipeline.signatures import Filter, Reader, Writer, apply_filter, optimize
    from wct_plugin.pipeline.time_limit import TimeLimit

#: Where each public name comes from.
_HOMES = {
    "Cells": "wct_plugin.mesh",
    "Filter": "wct_plugin.pipeline.constructors",
    "InputError": "wct_plugin.errors",
    "InternalError": "wct_plugin.errors",
    "NeighbourError": "wct_plugin.errors",
    "ObjectError": "wct_plugin.errors",
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
    "as_mesh": "wct_plugin.objects.conversions",
    "from_dolfinx": "wct_plugin.objects.dolfinx_meshes",
    "from_gmsh": "wct_plugin.objects.gmsh_meshes",
    "optimize": "wct_plugin.pipeline.one_line",
    "read": "wct_plugin.io",
    "report": "wct_plugin.pipeline.one_line",
    "run_batch": "wct_plugin.batch.run",
    "to_arrays": "wct_plugin.objects.arrays_meshes",
    "to_gmsh": "wct_plugin.objects.gmsh_meshes",
    "to_meshio": "wct_plugin.objects.meshio_meshes",
    "to_pymeshlab": "wct_plugin.objects.pymeshlab_meshes",
    "to_pyvista": "wct_plugin.objects.pyvista_meshes",
    "to_skfem": "wct_plugin.objects.skfem_meshes",
    "to_trimesh": "wct_plugin.objects.trimesh_meshes",
    "write": "wct_plugin.io",
    "write_dual": "wct_plugin.duals.dual_files",
}

__all__ = [
    "Cells",
    "Filter",
    "InputError",
    "InternalError",
    "NeighbourError",
    "ObjectError",
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
    "as_mesh",
    "from_dolfinx",
    "from_gmsh",
    "optimize",
    "read",
    "report",
    "run_batch",
    "to_arrays",
    "to_gmsh",
    "to_meshio",
    "to_pymeshlab",
    "to_pyvista",
    "to_skfem",
    "to_trimesh",
    "write",
    "write_dual",
]


if TYPE_CHECKING:
    __version__: str
else:  # type checkers would take any name for one of ours

    def __getattr__(name: str) -> Any:
        if name == "__version__":
            value = import_module("importlib.metadata").version(__name__)
        elif name in _HOMES:
            value = getattr(import_module(_HOMES[name]), name)
        else:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = value  # so that it is looked up once
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
