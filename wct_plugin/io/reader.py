"""A file becomes a :class:`TetMesh` or a :class:`SurfaceMesh`: by what its format's reader finds, or not at all."""

import importlib
import warnings
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError, OptionError, WctWarning
from wct_plugin.io import formats, read_limit
from wct_plugin.io.assembly import to_mesh
from wct_plugin.io.boundary_lists import without_lists
from wct_plugin.io.companions import note_opened
from wct_plugin.io.compressed import unpacked
from wct_plugin.io.refusals import refusing
from wct_plugin.io.region_choice import Regions, warn_of_others
from wct_plugin.io.standard_streams import STREAM, spooled
from wct_plugin.mesh import SurfaceMesh, TetMesh


def read(
    path: str | Path,
    *,
    suffix: str | None = None,
    regions: Regions = None,
    repair: bool = False,
    max_bytes: int | None = None,
) -> TetMesh | SurfaceMesh:
    """Read a mesh in any format of :data:`~wct_plugin.io.formats.FORMATS`.

    Tets in the file make a :class:`TetMesh`, with the triangles, lines and vertices beside them as its tagged
    facets, edges and nodes, and hexahedra, wedges, pyramids and quadrilaterals as its other cells; triangles alone make
    a :class:`SurfaceMesh`. Of tets with mid nodes the corners are taken, and where they were curved is remembered.
    Integer tags come from the conventional array of the format (``TAGS``); other arrays stay data, ``set:NAME`` arrays
    become named sets again. Where no tet has a tag, or all have the same, regions come from an array of a usual name
    (``material``, ``MaterialIDs``, ``region``, ...), or from named sets that have each tet once; the log of this
    package, and ``wct``, say which. An array that is all zero or all NaN on facets, edges or vertices, but not on the
    tets, is the filling that formats with one array for all cells need, and is left out there.

    Parameters
    ----------
    path : str or Path
        The file, packed by gzip or not; its suffix tells the format: ``part.vtu``, ``part.msh.gz``. ``-`` is standard
        input.
    suffix : str, optional
        The suffix that tells the format, as ``vtu``, where the name does not.
    regions : str or sequence of str, optional
        What the regions are instead: the name of any array of whole numbers, or the names of sets that share no tet;
        tets in none of them have region 0. Array and sets stay with the mesh, and are written again.
    repair : bool, optional
        Whether broken tets are dropped or mended: repeated ones, those with a vertex twice, those of zero volume. A
        warning counts them. Without it they are refused.
    max_bytes : int, optional
        Most bytes that packed or declared arrays may become; more is refused before it is allocated. Without it 100
        times the size of the files, and at least 256 MiB.

    Returns
    -------
    TetMesh or SurfaceMesh
        With ``source`` set to ``path``.

    Warns
    -----
    WctWarning
        For what the file has and the mesh cannot hold, by name; for what was done to it: quads split, tets dropped;
        and for an array or set that looks like materials and is not taken as regions.

    Raises
    ------
    InputError
        If the file is missing, damaged, of an unknown format, or holds volumes without a tet, or broken tets that are
        not to be repaired, or cannot.
    OptionError
        If ``max_bytes`` is not above 0, and if ``regions`` are not in the file, are no whole numbers, or overlap.
    """
    file = Path(path)
    form = formats.to_read(file, suffix)
    with ExitStack() as stack:
        stack.enter_context(read_limit.limited(max_bytes))
        if str(path) == STREAM:
            file = stack.enter_context(spooled("".join(formats.meant(file, suffix).suffixes), form))
        _check_file(path, file)
        note_opened(file)
        return _of_file(path, file, form, regions, repair=repair)


def _of_file(
    path: str | Path, file: Path, form: formats.Format, regions: Regions, *, repair: bool
) -> TetMesh | SurfaceMesh:
    """The mesh of a file, which the user knows as ``path``."""
    try:
        with unpacked(file, form) as plain:
            mesh, lost, notes = _read(plain, form, str(path), regions, repair=repair)
    except (InputError, OptionError) as error:
        error.args = (f"{path}: {error}", *error.args[1:])
        raise
    if isinstance(mesh, TetMesh):
        mesh = without_lists(mesh)
    if lost:
        warnings.warn(f"{path}: not read: {', '.join(lost)}", WctWarning, stacklevel=3)
    for note in notes:
        warnings.warn(f"{path}: {note}", WctWarning, stacklevel=3)
    if regions is None and isinstance(mesh, TetMesh):
        warn_of_others(mesh, str(path), stacklevel=4)
    return mesh


def _read(
    file: Path, form: formats.Format, source: str, regions: Regions, *, repair: bool
) -> tuple[TetMesh | SurfaceMesh, list[str], list[str]]:
    """The mesh, what of the file is left out, and what was done to the rest."""
    with np.errstate(invalid="ignore", over="ignore"):  # of coordinates that are no numbers the mesh says where
        with refusing(form):
            raw, lost = importlib.import_module(f"wct_plugin.io.{form.reader}").read(file)
        mesh = to_mesh(raw, form, lost, source, regions=regions, repair=repair)
    return mesh, lost, raw.notes


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
