"""What the tools run on: the tet meshes of a folder, or small ones made here."""

from pathlib import Path

from support.builders import ball, jittered_cube, l_shape

import wct_plugin as wct
from wct_plugin.errors import WctError
from wct_plugin.mesh import TetMesh

_DATA = Path(__file__).resolve().parents[1] / "tests/data"


def default(folder: Path) -> list[Path]:
    """A ball, a jittered cube and a regular L made on the spot, and the tests' gmsh channel."""
    folder.mkdir(parents=True, exist_ok=True)
    made = {"ball": ball(6), "cube": jittered_cube(8), "lshape": l_shape(4)}
    paths = [folder / f"{name}.vtu" for name in made]
    for path, mesh in zip(paths, made.values(), strict=True):
        wct.write(path, mesh)
    return sorted([*paths, _DATA / "channel.msh"], key=lambda path: path.stem)


def found(path: Path) -> list[Path]:
    """A file itself, or the files of a folder that hold a tet mesh, by name."""
    if path.is_file():
        return [path]
    return [file for file in sorted(path.iterdir()) if file.is_file() and _is_tets(file)]


def surface_of(mesh: Path, folder: Path | None) -> Path | None:
    """The file in ``folder`` with the mesh's name, whatever its suffix."""
    if folder is None:
        return None
    return next((file for file in sorted(folder.iterdir()) if file.stem == mesh.stem), None)


def _is_tets(file: Path) -> bool:
    try:
        return isinstance(wct.read(file), TetMesh)
    except WctError:
        return False
