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
    module: str  #: of meshio that writes it; empty where our own writer serves
    cells: tuple[str, ...]  #: kinds of cells it can carry
    tagged: tuple[str, ...] = ()  #: kinds of cells whose integer tags it can carry
    point_data: bool = False  #: arrays per point, and named point sets stored as arrays
    cell_data: bool = False  #: arrays per cell, and named cell sets stored as arrays
    sets: bool = False  #: named sets of its own
    names: bool = False  #: physical names
    surface: bool = True  #: whether triangles alone make a file
    reader: str = ""  #: the module that reads it; empty for what is no file
    writes: bool = True  #: whether we write it
    packed: tuple[str, ...] = ()  #: suffixes of all files of a format of several, that are packed each by itself
    beside: tuple[str, ...] = ()  #: and of files that stay as they are

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

    @property
    def companions(self) -> tuple[str, ...]:
        """The suffixes of all its files, where there are several."""
        return self.packed + self.beside


FORMATS = (
    Format("VTU", (".vtu",), "vtu", _ALL, _ALL, point_data=True, cell_data=True, names=True, reader="vtu"),
    Format("VTK", (".vtk",), "vtk", _ALL, _ALL, point_data=True, cell_data=True, reader="vtk_legacy"),
    Format(
        "XDMF", (".xdmf", ".xmf"), "xdmf", _ALL, _ALL, point_data=True, cell_data=True, reader="xdmf", beside=(".h5",)
    ),
    Format("gmsh", (".msh",), "gmsh", _ALL, _ALL, point_data=True, cell_data=True, names=True, reader="gmsh_reader"),
    Format(*("MED", (".med",), "", _ALL, _ALL), point_data=True, cell_data=True, sets=True, names=True, reader="med"),
    Format("Medit", (".mesh", ".meshb"), "", _ALL, _ALL[:3], reader="medit"),
    Format("Nastran", (".bdf", ".fem", ".nas"), "nastran", _ALL[:3], _ALL[:3], reader="nastran"),
    Format("Abaqus", (".inp",), "", _ALL[:3], sets=True, names=True, reader="abaqus"),
    Format("SU2", (".su2",), "", _ALL[:2], _ALL[1:2], names=True, surface=False, reader="su2"),
    Format(
        *("TetGen", (".ele", ".node"), "tetgen", _ALL[:2], _ALL[:2]),
        surface=False,
        reader="tetgen",
        packed=(".ele", ".node", ".face"),
    ),
    Format("PLY", (".ply",), "", _ALL[1:2], _ALL[1:2], point_data=True, cell_data=True, reader="ply"),
    Format("STL", (".stl",), "stl", _ALL[1:2], reader="stl"),
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


#: What ends the names of files packed by gzip.
PACKED = ".gz"


def suffix_of(path: Path) -> str:
    """The suffix that tells the format, in small letters; that of a packed file is the one before ``.gz``."""
    suffix = path.suffix.lower()
    return Path(path.stem).suffix.lower() if suffix == PACKED else suffix


def meant(path: Path, suffix: str | None) -> Path:
    """The name by which the format is found: the path itself, or one of the suffix that is given."""
    return path if suffix is None else Path(f"mesh.{suffix.removeprefix('.')}")


def to_read(path: Path, suffix: str | None = None) -> Format:
    """The format of a file to read, by its suffix or the one given; :class:`InputError` lists the known suffixes."""
    if path.is_dir():
        raise InputError(f"{path}: is a directory; the name of a mesh file is needed")
    return _find(path, suffix, InputError, _BY_SUFFIX)


def to_write(path: Path, *, volume: bool, suffix: str | None = None) -> Format:
    """The format of a file to write; :class:`OutputError` lists the suffixes that can carry the mesh."""
    able = {
        suffix: form for suffix, form in _BY_SUFFIX.items() if form.writes and (form.volume if volume else form.surface)
    }
    known = suffix_of(meant(path, suffix)) in _BY_SUFFIX
    form = _find(path, suffix, OutputError, _BY_SUFFIX if known else able)
    if not form.writes:
        raise OutputError(f"{path}: {form.name} is read, not written; allowed are {' '.join(able)}")
    if form not in able.values():
        what = "a tetrahedral mesh" if volume else "a surface"
        raise OutputError(f"{path}: {form.name} cannot carry {what}; allowed are {' '.join(able)}")
    return form


def _find(path: Path, given: str | None, error: type[WctError], known: dict[str, Format]) -> Format:
    suffix = suffix_of(meant(path, given))
    if suffix not in known:
        if given is not None:
            allowed = " ".join(suffix.removeprefix(".") for suffix in known)
            raise error(f"{path}: unknown format {given!r}; allowed are {allowed}")
        if str(path) == "-":
            flag = "--input-format" if error is InputError else "--output-format"
            raise error(f"{path}: has no suffix that tells its format; {flag} names it, as vtu")
        raise error(f"{path}: unknown suffix {suffix!r}; allowed are {' '.join(known)}")
    return known[suffix]
