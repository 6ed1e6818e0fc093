"""What can be made a mesh, and what a mesh can be made: chosen by the type's name, so that no library is imported.

>>> as_mesh((points, tets))  # doctest: +SKIP
>>> converted(mesh, "meshio")  # doctest: +SKIP
"""

import os
from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import Any

from wct_plugin.errors import InputError, ObjectError, OptionError
from wct_plugin.io import read
from wct_plugin.io.region_choice import Regions, refuse_for_surface, warn_of_others, with_regions
from wct_plugin.mesh import SurfaceMesh, TetMesh


@dataclass(frozen=True)
class Library:
    """Who holds meshes in what; ``from_NAME`` and ``to_NAME`` are in the module ``NAME_meshes`` of this package."""

    name: str
    package: str  #: where its types are defined
    types: tuple[str, ...]  #: their names; subclasses count too
    called: str  #: in messages
    fills: bool = True  #: whether it holds tets, and so what becomes of a surface that is filled

    def function(self, direction: str) -> Any:
        """``from_NAME`` or ``to_NAME``."""
        return getattr(import_module(f"wct_plugin.objects.{self.name}_meshes"), f"{direction}_{self.name}")

    def takes(self, obj: Any) -> bool:
        """Whether an object is one of its types, or the library itself where that has a current model."""
        if isinstance(obj, ModuleType):
            return "model" in self.types and obj.__name__ == self.package
        if isinstance(obj, type) and "model" not in self.types:
            return False
        return any(package == self.package and name in self.types for package, name in _kinds(obj))


def _kinds(obj: Any) -> list[tuple[str, str]]:
    """Package and name of an object's type and all that it is derived from; of a type itself, those of its own."""
    return [
        (kind.__module__.partition(".")[0], kind.__name__)
        for kind in (obj if isinstance(obj, type) else type(obj)).__mro__
    ]


ARRAYS = Library("arrays", "", (), "(points, tets) or (points, tets, regions)")
LIBRARIES = (
    ARRAYS,
    Library("meshio", "meshio", ("Mesh",), "meshio.Mesh"),
    Library("pyvista", "pyvista", ("DataSet",), "pyvista.UnstructuredGrid, pyvista.PolyData"),
    Library("pyvista", "vtkmodules", ("vtkUnstructuredGrid", "vtkPolyData"), "vtkUnstructuredGrid, vtkPolyData"),
    Library("skfem", "skfem", ("MeshTet1",), "skfem.MeshTet"),
    Library("gmsh", "gmsh", ("model",), "gmsh (its current model)"),
    Library("pymeshlab", "pymeshlab", ("MeshSet", "Mesh"), "pymeshlab.MeshSet", fills=False),
    Library("trimesh", "trimesh", ("Trimesh",), "trimesh.Trimesh", fills=False),
    Library("dolfinx", "dolfinx", ("Mesh",), "dolfinx.mesh.Mesh or (mesh, cell_tags, facet_tags)", fills=False),
)
#: What makes one of these of other objects, by their package and type.
CONVERSIONS = {
    ("numpy", "ndarray"): "points alone are no mesh: (points, tets) is one",
    ("pandas", "DataFrame"): "(points.to_numpy(), tets.to_numpy()) is one, of a frame of each",
    ("pyvista", "MultiBlock"): "its combine(merge_points=True) is one grid, with points that blocks share",
    ("vtkmodules", "vtkMultiBlockDataSet"): "pyvista.wrap(it).combine(merge_points=True) is one grid",
    ("trimesh", "Scene"): "its to_mesh() is one trimesh.Trimesh",
    ("skfem", "MeshHex1"): "its to_meshtet() is a skfem.MeshTet",
}
#: What :func:`converted` makes.
TARGETS = ("arrays", "meshio", "pyvista", "skfem", "gmsh", "pymeshlab", "trimesh")


def library_of(obj: Any) -> Library | None:
    """Whose object it is; None for ours, for names of files, and for what nobody here knows."""
    if isinstance(obj, tuple | list):
        if obj and (first := library_of(obj[0])) and first.name == "dolfinx":
            return first
        return ARRAYS if len(obj) in (2, 3) and not any(isinstance(one, str | dict) for one in obj) else None
    return next((one for one in LIBRARIES if one.takes(obj)), None)


def as_mesh(obj: Any, *, regions: Regions = None) -> TetMesh | SurfaceMesh:
    """Make a mesh of what people hold; one of ours stays what it is, and a file of that name is read.

    Parameters
    ----------
    obj : object
        ``(points, tets)``, ``(points, tets, regions)``, ``(points, triangles)``, a ``meshio.Mesh``, a pyvista or VTK
        grid or surface, a ``skfem.MeshTet``, the module ``gmsh`` for its current model, a ``pymeshlab.MeshSet``, a
        ``trimesh.Trimesh``, a dolfinx mesh or its tuple with tags, or the name of a file.
    regions : str or sequence of str, optional
        What the regions are, as of :func:`wct_plugin.read`.

    Returns
    -------
    TetMesh or SurfaceMesh
        On arrays of its own; ``obj`` is left as it is.

    Raises
    ------
    ObjectError
        For any other object, naming those that can be taken.
    InputError
        If it holds no mesh of tets or triangles.
    OptionError
        If ``regions`` are not there, are no whole numbers, or overlap.
    """
    if not (regions is None or isinstance(regions, str) or _are_names(regions)):
        raise OptionError(
            f"regions is {called(regions)}; allowed are the name of an array and names of sets"
            " ((points, tets, regions) has them as numbers)"
        )
    if isinstance(obj, str | os.PathLike):
        if not os.fspath(obj):
            raise InputError("the name of the mesh file is empty")
        return read(os.fspath(obj), regions=regions)
    if isinstance(obj, TetMesh | SurfaceMesh):
        return _with_regions(obj, regions)
    library = library_of(obj)
    if library is None:
        how = (
            ""
            if isinstance(obj, type)
            else next((CONVERSIONS[kind] for kind in _kinds(obj) if kind in CONVERSIONS), "")
        )
        raise ObjectError(f"cannot make a mesh of {called(obj)}; {how and f'{how}; '}allowed are {taken()}")
    mesh: TetMesh | SurfaceMesh = library.function("from")(obj)
    if regions is None and isinstance(mesh, TetMesh):
        warn_of_others(mesh, called(obj))
    return _with_regions(mesh, regions)


def _are_names(regions: Any) -> bool:
    return isinstance(regions, tuple | list) and all(isinstance(name, str) for name in regions)


def _with_regions(mesh: TetMesh | SurfaceMesh, regions: Regions) -> TetMesh | SurfaceMesh:
    if isinstance(mesh, SurfaceMesh):
        refuse_for_surface(regions)
        return mesh
    return mesh if regions is None else with_regions(mesh, regions)


def converted(mesh: TetMesh | SurfaceMesh, to: str) -> Any:
    """Make what ``to`` says of a mesh, one of :data:`TARGETS`; raises :class:`OptionError` for another."""
    if to not in TARGETS:
        raise OptionError(f"to is {to!r}; allowed are {', '.join(TARGETS)}")
    return next(one for one in LIBRARIES if one.name == to).function("to")(mesh)


def like(mesh: TetMesh | SurfaceMesh, obj: Any) -> Any:
    """Make of a mesh what ``obj`` is; a mesh of ours where that is a file or cannot hold it, as a surface's tets."""
    library = library_of(obj)
    if library is None or (isinstance(mesh, TetMesh) and not library.fills):
        return mesh
    if library is ARRAYS:
        return library.function("to")(mesh)[: len(obj)]
    return library.function("to")(mesh)


def taken() -> str:
    """All that can be made a mesh, in words."""
    return "; ".join(["the name of a mesh file", "TetMesh, SurfaceMesh", *(one.called for one in LIBRARIES)])


def called(obj: Any) -> str:
    """What an object is, with its library, in words."""
    if obj is None:
        return "None"
    if isinstance(obj, ModuleType):
        return f"the module {obj.__name__}"
    package, kind = _kinds(obj)[0]
    name = kind if package == "builtins" else f"{package}.{kind}"
    if isinstance(obj, type):
        return f"the class {name}"
    article = "an" if name[0] in "aeiou" else "a"
    return f"{article} {name} of {len(obj)}" if isinstance(obj, tuple | list) else f"{article} {name}"
