"""VTK's parallel files ``.pvtu``: a list of ``.vtu`` files, the pieces of one mesh."""

from pathlib import Path

from wct_plugin.errors import InputError
from wct_plugin.io import vtu
from wct_plugin.io.companions import companion
from wct_plugin.io.pieces import joined
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.vtk_arrays import parse


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the pieces hold together, and what of it is left out."""
    lost: list[str] = []
    root = parse(path.read_bytes(), "PUnstructuredGrid").root
    names = [piece.get("Source", "") for piece in root.iter("Piece")]
    if not names:
        raise InputError("names no pieces")
    pieces = []
    for name in names:
        file = companion(path, name)
        try:
            pieces += vtu.read_pieces(file, lost)
        except InputError as error:
            raise InputError(f"{name}: {error}") from error
    made = joined(pieces, lost)
    lost[:] = dict.fromkeys(lost)
    return made, lost
