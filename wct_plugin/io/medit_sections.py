"""The sections of Medit's files, which mmg and libMeshb call the GMF: what each is called, its number and its rows."""

from dataclasses import dataclass

from wct_plugin.mesh.required_sets import REQUIRED_EDGES, REQUIRED_TRIANGLES


@dataclass(frozen=True)
class CellSection:
    """Rows of corners, numbered from 1, and a reference."""

    name: str
    code: int  #: what stands for the name in binary files
    kind: str  #: of cell
    corners: int


@dataclass(frozen=True)
class SetSection:
    """Numbers, from 1, of cells of a kind of which something is said; of points where the kind is ``vertex``."""

    name: str
    code: int
    kind: str


CELLS = (
    CellSection("Edges", 5, "line", 2),
    CellSection("Triangles", 6, "triangle", 3),
    CellSection("Quadrilaterals", 7, "quad", 4),
    CellSection("Tetrahedra", 8, "tetra", 4),
    CellSection("Prisms", 9, "wedge", 6),
    CellSection("Hexahedra", 10, "hexahedron", 8),
    CellSection("Pyramids", 49, "pyramid", 5),
    CellSection("EdgesP2", 25, "line3", 3),
    CellSection("TrianglesP2", 24, "triangle6", 6),
    CellSection("TetrahedraP2", 30, "tetra10", 10),
)
#: What must stay as it is, by mmg's names; these are the names of the sets, too.
SETS = (
    SetSection("Corners", 13, "vertex"),
    SetSection("RequiredVertices", 15, "vertex"),
    SetSection("Ridges", 14, "line"),
    SetSection(REQUIRED_EDGES, 16, "line"),
    SetSection(REQUIRED_TRIANGLES, 17, "triangle"),
)
VERTICES = 4
DIMENSION = 3
END = 54
#: Names of what is not read, for who reads the warning.
OTHERS = {
    12: "RequiredTetrahedra", 18: "RequiredQuadrilaterals", 20: "NormalAtVertices", 29: "SubDomainFromGeom",
    59: "Tangents", 60: "Normals", 61: "TangentAtVertices", 62: "SolAtVertices",
}  # fmt: skip


def set_of(name: str, kind: str) -> SetSection | None:
    """The section for a set of this name of cells of this kind, if there is one."""
    return next((one for one in SETS if (one.name, one.kind) == (name, kind)), None)
