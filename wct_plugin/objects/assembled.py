"""What all conversions share: the conventions of files, and warnings for what cannot come along."""

import warnings
from collections.abc import Iterable

from wct_plugin.errors import InputError, ObjectError, WctWarning
from wct_plugin.io.assembly import TAGS, to_mesh
from wct_plugin.io.formats import Format
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.mesh import SurfaceMesh, TetMesh


def assembled(
    raw: RawMesh, form: Format, what: str, tags: tuple[str, ...] = TAGS, lost: Iterable[str] = ()
) -> TetMesh | SurfaceMesh:
    """The mesh of what ``what`` holds, by the conventions of a format; ``lost`` is named beside what gets lost here."""
    dropped = list(lost)
    try:
        mesh = to_mesh(raw, form, dropped, "", tags)
    except InputError as error:
        raise InputError(f"{what}: {error}") from error
    not_read(what, dropped)
    for note in raw.notes:
        warnings.warn(f"{what}: {note}", WctWarning, stacklevel=3)
    return mesh


def not_read(what: str, lost: Iterable[str]) -> None:
    """Warn of what a mesh cannot hold, if there is anything."""
    _warn(f"{what}: not read", lost)


def not_carried(what: str, lost: Iterable[str]) -> None:
    """Warn of what another library's object cannot hold, if there is anything."""
    _warn(f"{what} cannot carry, so dropped", lost)


def _warn(text: str, lost: Iterable[str]) -> None:
    names = ", ".join(lost)
    if names:
        warnings.warn(f"{text}: {names}", WctWarning, stacklevel=4)


def needs_tets(mesh: TetMesh | SurfaceMesh, what: str) -> TetMesh:
    """The mesh, if it is one of tets."""
    if isinstance(mesh, TetMesh):
        return mesh
    raise ObjectError(f"{what} holds tets, here is a surface; filters.generate_tetrahedralization fills it")


def needs_surface(mesh: TetMesh | SurfaceMesh, what: str) -> SurfaceMesh:
    """The mesh, if it is a surface."""
    if isinstance(mesh, SurfaceMesh):
        return mesh
    raise ObjectError(f"{what} holds surfaces, here is a tet mesh; filters.generate_boundary_surface gives its own")
