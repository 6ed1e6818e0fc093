"""Well-centered tetrahedral meshes: every tet, and every triangle, contains its circumcenter.

>>> import wct_plugin as wct
>>> mesh = wct.read("part.msh")  # doctest: +SKIP
>>> mesh, metrics = wct.apply_filter("meshing_well_centered", mesh)  # doctest: +SKIP
>>> wct.write("part.vtu", mesh)  # doctest: +SKIP
"""

try:
    import wct_plugin._core  # noqa: F401
except ImportError as error:
    raise ImportError(
        "wct_plugin is not installed here: its compiled core (wct_plugin._core) is missing; "
        "run `pip install .` (or `pip install -e .`) in the source tree, with a C++20 compiler at hand"
    ) from error

from wct_plugin.adapters.meshio import read, write
from wct_plugin.errors import InputError, NeighbourError, OptionError, OutputError, WctError, WctWarning
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh
from wct_plugin.stage import apply_filter

__all__ = [
    "Cells",
    "InputError",
    "NeighbourError",
    "OptionError",
    "OutputError",
    "SurfaceMesh",
    "TetMesh",
    "WctError",
    "WctWarning",
    "apply_filter",
    "read",
    "write",
]
