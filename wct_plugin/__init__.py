"""Well-centered tetrahedral meshes: every tet, and every triangle, contains its circumcenter.

>>> import wct_plugin as wct
>>> mesh = wct.read("part.msh")  # doctest: +SKIP
>>> mesh, metrics = wct.apply_filter("meshing_well_centered", mesh)  # doctest: +SKIP
>>> wct.write("part.vtu", mesh)  # doctest: +SKIP
>>> chain = wct.Reader("bone.ply") | wct.Filter.generate_tetrahedralization() | wct.Filter.meshing_well_centered()
>>> result = (chain | wct.Writer("bone.vtu") | wct.Writer("bone.html")).execute()  # doctest: +SKIP
"""

try:
    import wct_plugin._core  # noqa: F401
except ImportError as error:
    raise ImportError(
        "wct_plugin is not installed here: its compiled core (wct_plugin._core) is missing; "
        "run `pip install .` (or `pip install -e .`) in the source tree, with a C++20 compiler at hand"
    ) from error

from wct_plugin.adapters.meshio import read, write
from wct_plugin.batch import run_batch
from wct_plugin.constructors import Filter, Reader, Writer
from wct_plugin.errors import InputError, InternalError, NeighbourError, OptionError, OutputError, WctError, WctWarning
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh
from wct_plugin.pipeline import Pipeline
from wct_plugin.result import Result
from wct_plugin.stage import apply_filter

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
    "WctError",
    "WctWarning",
    "Writer",
    "apply_filter",
    "read",
    "run_batch",
    "write",
]
