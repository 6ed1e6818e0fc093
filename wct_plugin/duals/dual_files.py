"""The dual of a mesh as a file or folder: Voronoi cells, or the matrices of discrete exterior calculus."""

import os
import warnings
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from wct_plugin.duals import left_out, openfoam, patches, polyhedra_vtu
from wct_plugin.duals.dual_mesh import DualMesh, make_dual_mesh
from wct_plugin.errors import OptionError, OutputError, WctWarning
from wct_plugin.io import atomic_files
from wct_plugin.io.standard_streams import STREAM
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.objects.assembled import needs_tets
from wct_plugin.objects.conversions import as_mesh

DualFormat = Literal["vtu", "npz", "openfoam", "matrix-market"]
_SUFFIXES: dict[str, DualFormat] = {".vtu": "vtu", ".npz": "npz"}
#: Of the formats that are folders, where in them the files are.
_FOLDERS = {"openfoam": openfoam.FOLDER, "matrix-market": Path()}


def format_of(path: str | os.PathLike[str], wanted: str | None = None) -> DualFormat:
    """The format of a file or folder: that which is wanted, or which the suffix says; a folder is OpenFOAM's case.

    Raises :class:`OptionError` for one that does not fit the name, and :class:`OutputError` for another suffix and
    for ``-``: standard output takes a mesh, no folder.
    """
    if os.fspath(path) in ("", STREAM):
        raise OutputError(f"{os.fspath(path)!r} is no name of a file or folder, which a dual needs")
    suffix = Path(path).suffix.lower()
    of_suffix = _SUFFIXES.get(suffix)
    if wanted is not None and wanted not in get_args(DualFormat):
        raise OptionError(f"format is {wanted!r}; allowed are {', '.join(get_args(DualFormat))}")
    if wanted in _SUFFIXES.values() and wanted != of_suffix:
        raise OptionError(f"format is {wanted!r}, and {os.fspath(path)!r} does not end in .{wanted}")
    if of_suffix and wanted not in (None, of_suffix):
        raise OptionError(f"format is {wanted!r}, a folder, and {os.fspath(path)!r} ends in {suffix}")
    for name in get_args(DualFormat):
        if name == (wanted or of_suffix):
            known: DualFormat = name
            return known
    if suffix and not Path(path).is_dir():
        allowed = " ".join(_SUFFIXES)
        folders = "and none for a folder, of OpenFOAM or with format matrix-market"
        raise OutputError(f"{path}: unknown suffix {suffix!r}; allowed are {allowed}, {folders}")
    return "openfoam"


def check_dual_writable(path: str | os.PathLike[str], form: DualFormat) -> None:
    """Find out before any work whether it can be written; raises :class:`OutputError`."""
    if form not in _FOLDERS:
        atomic_files.check_writable(os.fspath(path))
        return
    folder = Path(path) / _FOLDERS[form]
    atomic_files.check_fillable(folder)
    there = {one.name for one in folder.iterdir()} if folder.is_dir() else set()
    if form == "openfoam" and (others := sorted(there - {*openfoam.FILES})):
        raise OutputError(f"{folder}: has {others[0]!r}, which would not fit the new mesh; remove what is there")


def write_dual(path: str | os.PathLike[str], mesh: Any, *, format: DualFormat | None = None) -> str:  # noqa: A002
    """Write the circumcentric dual of a tet mesh, whole or not at all; returns in words what it is.

    Parameters
    ----------
    path : str or Path
        ``NAME.vtu``: Voronoi cells as polyhedra, with cell data ``vertex``, ``region``, ``volume`` and the mesh's point
        data. ``NAME.npz``: Hodge stars and exterior derivatives. A folder: OpenFOAM's case, or Matrix Market files.
    mesh : object
        The mesh, or what :func:`wct_plugin.objects.conversions.as_mesh` takes.
    format : {"vtu", "npz", "openfoam", "matrix-market"}, optional
        Without it as the name says.

    Warns
    -----
    WctWarning
        For what of groups and data is not in Voronoi cells, for cells beside the tets, which have no dual, and for
        stars with entries that are not positive.

    Raises
    ------
    InputError
        If dual cells would be tangled; stars are written all the same.
    """
    form = format_of(path, format)
    given: TetMesh | SurfaceMesh = as_mesh(mesh)
    tets = needs_tets(given, "the dual")
    check_dual_writable(path, form)
    lost: list[str] = []
    if form in ("npz", "matrix-market"):
        said = _write_stars(path, tets, form)
    else:
        dual = make_dual_mesh(tets)
        lost += _write_polyhedra(path, tets, dual) if form == "vtu" else _write_case(path, tets, dual)
        faces = f"{len(dual.neighbour)} faces between them, {len(dual.facets)} on the boundary"
        said = f"{len(dual.vertex)} cells, {faces}, volume {dual.volumes.sum():.9g}"
    if lost := lost + left_out.cells_beside(tets):
        warnings.warn(f"{os.fspath(path)}: not in it: {', '.join(lost)}", WctWarning, stacklevel=2)
    return said


def _write_stars(path: str | os.PathLike[str], mesh: TetMesh, form: DualFormat) -> str:
    from wct_plugin.duals import hodge_files  # here: SciPy takes longer to import than all else

    diagonals = hodge_files.stars(mesh)
    if form == "npz":
        with atomic_files.replacing(os.fspath(path)) as temporary:
            hodge_files.write_npz(temporary, mesh, diagonals)
    else:
        with atomic_files.filling(Path(path) / _FOLDERS[form]) as folder:
            hodge_files.write_matrix_market(folder, mesh, diagonals)
    if bad := hodge_files.not_positive(diagonals):
        said = f"{', '.join(bad)}; goal cwc of meshing_well_centered makes all positive"
        warnings.warn(f"{os.fspath(path)}: {said}", WctWarning, stacklevel=3)
    return ", ".join(f"star{k} of {len(diagonal)}" for k, diagonal in enumerate(diagonals))


def _write_polyhedra(path: str | os.PathLike[str], mesh: TetMesh, dual: DualMesh) -> list[str]:
    data = {"vertex": dual.vertex, "region": dual.region, "volume": dual.volumes}
    kept = {name: v for name, v in mesh.point_data.items() if name not in data and polyhedra_vtu.storable(v)}
    with atomic_files.replacing(os.fspath(path)) as temporary:
        polyhedra_vtu.write(temporary, dual, data | {name: values[dual.vertex] for name, values in kept.items()})
    lost = [f"point data {name!r}" for name in mesh.point_data if name not in kept]
    return lost + left_out.groups_and_data(mesh) + left_out.facets_and_names(mesh)


def _write_case(path: str | os.PathLike[str], mesh: TetMesh, dual: DualMesh) -> list[str]:
    found, lost = patches.find_patches(mesh)
    names = openfoam.words(found, "patch_")
    zones = patches.region_names(mesh)
    zone_names = openfoam.words(zones.values(), "region_")
    lost += [f"the name {name!r}, there {word!r}" for name, word in (names | zone_names).items() if name != word]
    with atomic_files.filling(Path(path) / openfoam.FOLDER) as folder:
        openfoam.write(
            folder,
            dual,
            {names[name]: rows for name, rows in found.items()},
            {zone_names[name]: np.flatnonzero(dual.region == tag) for tag, name in zones.items()},
        )
    return lost + [f"point data {name!r}" for name in mesh.point_data] + left_out.groups_and_data(mesh)
