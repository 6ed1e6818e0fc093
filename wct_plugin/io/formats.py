"""The file formats there are: what each is called, which suffixes it has and what it can carry.

meshio knows more formats; those whose readers may loop for ever on a damaged file are left out.
"""

from dataclasses import dataclass
from pathlib import Path

from wct_plugin.errors import InputError, OutputError, WctError

_ALL = ("tetra", "triangle", "line", "vertex")
_SOLID = ("hexahedron", "wedge", "pyramid", "quad")
#: Those with a node in the middle of each edge; and with more on faces and inside.
_SECOND = ("hexahedron20", "wedge15", "pyramid13", "quad8")
_MORE = ("hexahedron27", "quad9")
#: Kinds of cells that formats can carry beside tets, by the format's name.
_OTHERS = {
    **dict.fromkeys(("VTU", "VTK", "XDMF", "gmsh", "pyvista", "meshio"), _SOLID + _SECOND + _MORE),
    **dict.fromkeys(("MED", "Nastran"), _SOLID + _SECOND),
    **dict.fromkeys(("Medit", "SU2"), _SOLID),
    "Abaqus": ("hexahedron", "wedge", "quad", "hexahedron20", "wedge15", "quad8"),
}
#: Formats of tets, triangles and lines with mid nodes.
_SECOND_ORDER = ("VTU", "VTK", "XDMF", "gmsh", "MED", "Nastran", "Abaqus", "pyvista", "meshio")


@dataclass(frozen=True)
class Format:
    """One row of :data:`FORMATS`."""

    name: str
    suffixes: tuple[str, ...]
    module: str  #: meshio's module; empty where our own reader and writer serve
    cells: tuple[str, ...]  #: kinds of cells it can carry
    tagged: tuple[str, ...] = ()  #: kinds of cells whose integer tags it can carry
    point_data: bool = False  #: arrays per point, and named point sets stored as arrays
    cell_data: bool = False  #: arrays per cell, and named cell sets stored as arrays
    sets: bool = False  #: named sets of its own
    names: bool = False  #: physical names
    surface: bool = True  #: whether triangles alone make a file
    reader: str = ""  #: our own module that reads it; empty where meshio's does
    writes: bool = True  #: whether we write it

    @property
    def volume(self) -> bool:
        """Whether it can carry tets."""
        return "tetra" in self.cells

    @property
    def others(self) -> tuple[str, ...]:
        """Kinds of cells that it can carry beside tets."""
        return _OTHERS.get(self.name, ())

    @property
    def second_order(self) -> bool:
        """Whether it can carry tets, triangles and lines with mid nodes."""
        return self.name in _SECOND_ORDER


FORMATS = (
    Format("VTU", (".vtu",), "vtu", _ALL, _ALL, point_data=True, cell_data=True, names=True, reader="vtu"),
    Format("VTK", (".vtk",), "vtk", _ALL, _ALL, point_data=True, cell_data=True, reader="vtk_legacy"),
    Format("XDMF", (".xdmf", ".xmf"), "xdmf", _ALL, _ALL, point_data=True, cell_data=True, reader="xdmf"),
    Format("gmsh", (".msh",), "gmsh", _ALL, _ALL, point_data=True, cell_data=True, names=True),
    Format("MED", (".med",), "med", _ALL, _ALL, point_data=True, cell_data=True, reader="med"),
    Format("Medit", (".mesh", ".meshb"), "medit", _ALL[:3], _ALL[:3]),
    Format("Nastran", (".bdf", ".fem", ".nas"), "nastran", _ALL[:3], _ALL[:3]),
    Format("Abaqus", (".inp",), "abaqus", _ALL[:3], sets=True),
    Format("SU2", (".su2",), "su2", _ALL[:2], _ALL[1:2], surface=False),
    Format("TetGen", (".ele", ".node"), "tetgen", _ALL[:2], _ALL[:2], surface=False),
    Format("PLY", (".ply",), "", _ALL[1:2], _ALL[1:2], point_data=True, cell_data=True, reader="ply"),
    Format("STL", (".stl",), "stl", _ALL[1:2]),
    Format("OBJ", (".obj",), "", _ALL[1:2], reader="obj"),
    Format("OFF", (".off",), "", _ALL[1:2], reader="off"),
    Format("PVTU", (".pvtu",), "", _ALL, reader="pvtu", writes=False),
    Format("VTP", (".vtp",), "", _ALL[1:2], reader="vtu", writes=False),
    Format("UNV", (".unv",), "", _ALL, reader="unv", writes=False),
    Format("XML", (".xml",), "", _ALL[:2], reader="xml_mesh", writes=False),
    Format("Exodus", (".e", ".exo", ".ex2"), "", _ALL, reader="exodus", writes=False),
)

#: What a dataset of pyvista can carry; it is no file.
PYVISTA = Format("pyvista", (), "", _ALL, _ALL, point_data=True, cell_data=True, names=True)
#: What a ``meshio.Mesh`` can carry; it is no file either.
MESHIO = Format("meshio", (), "", _ALL, _ALL, point_data=True, cell_data=True, sets=True, names=True)

_BY_SUFFIX = {suffix: form for form in FORMATS for suffix in form.suffixes}


def to_read(path: Path) -> Format:
    """The format of a file to read, by its suffix; :class:`InputError` lists the known suffixes."""
    return _find(path, InputError, _BY_SUFFIX)


def to_write(path: Path, *, volume: bool) -> Format:
    """The format of a file to write; :class:`OutputError` lists the suffixes that can carry the mesh."""
    able = {
        suffix: form for suffix, form in _BY_SUFFIX.items() if form.writes and (form.volume if volume else form.surface)
    }
    form = _find(path, OutputError, able if path.suffix.lower() not in _BY_SUFFIX else _BY_SUFFIX)
    if not form.writes:
        raise OutputError(f"{path}: {form.name} is read, not written; allowed are {' '.join(able)}")
    if form not in able.values():
        what = "a tetrahedral mesh" if volume else "a surface"
        raise OutputError(f"{path}: {form.name} cannot carry {what}; allowed are {' '.join(able)}")
    return form


def _find(path: Path, error: type[WctError], known: dict[str, Format]) -> Format:
    suffix = path.suffix.lower()
    if suffix not in known:
        raise error(f"{path}: unknown suffix {suffix!r}; allowed are {' '.join(known)}")
    return known[suffix]
