"""A file becomes a :class:`TetMesh` or a :class:`SurfaceMesh`: by meshio, by what the file contains, or not at all."""

import warnings
from dataclasses import replace
from pathlib import Path

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import formats, obj, off, ply
from wct_plugin.io.assembly import to_mesh, with_tags
from wct_plugin.io.meshio_readers import load, refusing
from wct_plugin.mesh import SurfaceMesh, TetMesh


def read(path: str | Path) -> TetMesh | SurfaceMesh:
    """Read a mesh in any format of :data:`~wct_plugin.io.formats.FORMATS`.

    Tets in the file make a :class:`TetMesh`, with the triangles, lines and vertices beside them as its tagged
    facets, edges and nodes; triangles alone make a :class:`SurfaceMesh`. Integer tags come from the conventional
    array of the format (``TAGS``); other arrays stay data, ``set:NAME`` arrays become named sets again. An array
    that is all zero or all NaN on facets, edges or vertices, but not on the tets, is the filling that formats with
    one array for all cells need, and is left out there.

    Parameters
    ----------
    path : str or Path
        The file; its suffix tells the format.

    Returns
    -------
    TetMesh or SurfaceMesh
        With ``source`` set to ``path``.

    Warns
    -----
    WctWarning
        For what the file has and the mesh cannot hold, by name.

    Raises
    ------
    InputError
        If the file is missing, damaged, of an unknown format, or holds other cells than tets or triangles.
    """
    file = Path(path)
    form = formats.to_read(file)
    _check_file(path, file)
    try:
        mesh, lost = _read(file, form, str(path))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    if lost:
        warnings.warn(f"{path}: not read: {', '.join(lost)}", WctWarning, stacklevel=2)
    return mesh


def _read(file: Path, form: formats.Format, source: str) -> tuple[TetMesh | SurfaceMesh, list[str]]:
    lost: list[str] = []
    if form.module:
        raw, lost = load(file, form)
        return to_mesh(raw, form, lost, source), lost
    with refusing(form):
        match form.name:
            case "PLY":
                surface, lost = ply.read(file)
                surface = with_tags(surface)
            case "OBJ":
                surface = obj.read(file)
            case _:
                surface = off.read(file)
    return replace(surface, source=source), lost


def _check_file(path: str | Path, file: Path) -> None:
    if not file.exists():
        raise InputError(f"{path}: there is no such file")
    if not file.is_file():
        raise InputError(f"{path}: is no file; a mesh file is needed")
    try:
        with file.open("rb") as handle:
            empty = not handle.read(1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    if empty:
        raise InputError(f"{path}: is empty")
