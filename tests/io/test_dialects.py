"""The table of dialects in ``docs/formats.md``: each row is a file of that dialect, read or refused as the row says."""

import gzip
import warnings
from pathlib import Path
from typing import NamedTuple

import pytest

from wct_plugin.errors import InputError
from wct_plugin.io import read
from wct_plugin.mesh import TetMesh

DOCS = Path(__file__).parents[2] / "docs/formats.md"

POINTS = ("0 0 0", "1 0 0", "0 1 0", "0 0 1")
MEDIT = (
    "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n"
    + "".join(f"{p} 0\n" for p in POINTS)
    + "Tetrahedra\n1\n1 2 3 4 7\n"
)
ABAQUS = (
    "*NODE\n" + "".join(f"{k}, {p.replace(' ', ', ')}\n" for k, p in enumerate(POINTS, start=1))
    + "*ELEMENT, TYPE=C3D4, ELSET=STEEL\n1, 1, 2, 3, 4\n"
)  # fmt: skip
NASTRAN = (
    "".join(f"GRID,{k},,{'.,'.join(p.split())}.\n" for k, p in enumerate(POINTS, start=1)) + "CTETRA,1,7,1,2,3,4\n"
)
GMSH = (
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n" + "".join(f"{k} {p}\n" for k, p in enumerate(POINTS, start=1))
    + "$EndNodes\n$Elements\n1\n1 4 2 7 1 1 2 3 4\n$EndElements\n"
)  # fmt: skip
GMSH_1 = GMSH[GMSH.index("$Nodes") :].replace("$Nodes", "$NOD").replace("$EndNodes", "$ENDNOD")
GMSH_1 = GMSH_1.replace("$Elements", "$ELM").replace("$EndElements", "$ENDELM").replace("1 4 2 7 1 1", "1 4 7 1 4 1")
GMSH_40 = (
    "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 7 0\n$EndEntities\n$Nodes\n1 4\n1 3 0 4\n"
    + "".join(f"{k} {p}\n" for k, p in enumerate(POINTS, start=1))
    + "$EndNodes\n$Elements\n1 1\n1 3 4 1\n1 1 2 3 4\n$EndElements\n"
)
GMSH_41 = (
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 7 0\n$EndEntities\n{}$Nodes\n1 4 1 4\n"
    "3 {} 0 4\n1\n2\n3\n4\n"
    + "\n".join(POINTS)
    + "\n$EndNodes\n$Elements\n1 1 1 1\n3 {} 4 1\n1 1 2 3 4\n$EndElements\n"
)
PARTS = "$PartitionedEntities\n1\n0\n0 0 0 1\n5 3 1 1 1 0 0 0 1 1 1 1 7 0\n$EndPartitionedEntities\n"


class Dialect(NamedTuple):
    format: str
    dialect: str
    becomes: str
    name: str
    content: str
    said: str = ""  #: in the warning, or in the error where there is one
    refused: bool = False


DIALECTS = [
    Dialect("gmsh", "version 1, `$NOD`", "read", "a.msh", GMSH_1),
    Dialect("gmsh", "versions 2.0 to 2.2, text and binary", "read", "a.msh", GMSH),
    Dialect("gmsh", "versions 4.0 and 4.1, text and binary", "read; all groups of an entity", "a.msh", GMSH_40),
    Dialect("gmsh", "partitions", "put together; said", "a.msh", GMSH_41.format(PARTS, 5, 5), "not read: partitions"),
    Dialect("gmsh", "nodes with parameters", "read", "a.msh",
            GMSH_41.format("", 1, 1).replace("3 1 0 4", "3 1 1 4").replace(
                "\n".join(POINTS), " .5 .5 .5\n".join(POINTS) + " 0 0 0")),
    Dialect("gmsh", "sections that are not of the mesh", "left out; named", "a.msh", GMSH + "$Foo\n1\n$EndFoo\n",
            "not read: section $Foo"),
    Dialect("Medit", "with or without `End`, in any case", "counts decide", "a.mesh", MEDIT),
    Dialect("Medit", "versions 1 to 4, text and binary", "read", "a.mesh", MEDIT.replace("Formatted 2", "Formatted 4")),
    Dialect("Medit", "`Corners`, `Ridges`, `Required…`", "sets of these names, held", "a.mesh",
            MEDIT + "Corners\n1\n1\n"),
    Dialect("Medit", "other sections, `RequiredTetrahedra` too", "left out; named, with counts", "a.mesh",
            MEDIT + "RequiredTetrahedra\n1\n1\n", "not read: section 'RequiredTetrahedra' of 1 entry"),
    Dialect("Medit", "fewer or more entries than announced", "refused", "a.mesh", MEDIT[:-2],
            "section 'Tetrahedra' announces 1 entries of 5 numbers each, 5 in all; found 4", True),
    Dialect("Medit", "MFEM's own `.mesh`", "refused; says how to convert", "a.mesh", "MFEM mesh v1.0\n",
            "is a mesh of MFEM", True),
    Dialect("Abaqus", "keywords, types and sets in any case", "read", "a.inp", ABAQUS.lower()),
    Dialect("Abaqus", "`*INCLUDE`, and `INPUT=` of nodes, elements and sets", "read from beside or below", "a.inp",
            "*INCLUDE, INPUT=b.inp\n"),
    Dialect("Abaqus", "parts and instances, shifted and turned", "placed; numbers by part", "a.inp",
            f"*PART, NAME=P\n{ABAQUS}*END PART\n*INSTANCE, NAME=I, PART=P\n1, 2, 3\n*END INSTANCE\n"),
    Dialect("Abaqus", "sets of sets, `GENERATE`, `INSTANCE.SET`", "read", "a.inp", ABAQUS + "*ELSET, ELSET=A\nSTEEL\n"),
    Dialect("Abaqus", "masses, springs, connectors", "left out; counted", "a.inp",
            ABAQUS + "*ELEMENT, TYPE=MASS\n2, 1\n",
            "not read: 1 element of type MASS"),
    Dialect("Abaqus", "`*NGEN`, `*ELGEN`, `*SYSTEM`", "refused", "a.inp", ABAQUS + "*NGEN\n1, 2\n",
            "has *NGEN; allowed are files", True),
    Dialect("Nastran", "small, large and free fields, continued", "read", "a.bdf", NASTRAN + "ENDDATA\n"),
    Dialect("Nastran", "`ENDDATA` in any case, `END BULK`", "read", "a.bdf", NASTRAN + "END BULK\n"),
    Dialect("Nastran", "no end, as punch files", "read; said", "a.bdf", NASTRAN, "does not end with ENDDATA"),
    Dialect("Nastran", "`1.0-3`, tabs, `INCLUDE`", "read", "a.bdf", NASTRAN.replace("1.", "1.0+0") + "ENDDATA\n"),
    Dialect("Nastran", "points in other coordinate systems", "refused", "a.bdf",
            NASTRAN.replace("GRID,1,,", "GRID,1,2,"), "has GRID 1 in coordinate system 2", True),
    Dialect("all", "packed by gzip, `.msh.gz`", "read and written", "a.msh.gz", GMSH),
]  # fmt: skip


@pytest.mark.parametrize("row", DIALECTS, ids=lambda row: f"{row.format}: {row.dialect}")
def test_each_row_holds(row: Dialect, tmp_path: Path) -> None:
    content = row.content.encode()
    (tmp_path / row.name).write_bytes(gzip.compress(content) if row.name.endswith(".gz") else content)
    (tmp_path / "b.inp").write_text(ABAQUS)
    if row.refused:
        with pytest.raises(InputError) as caught:
            read(tmp_path / row.name)
        assert row.said in str(caught.value)
        return
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        mesh = read(tmp_path / row.name)
    assert isinstance(mesh, TetMesh)
    assert mesh.tets.tolist() == [[0, 1, 2, 3]]
    assert mesh.regions.tolist() in ([7], [0])
    assert (mesh.points - mesh.points[0]).tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert [row.said in str(one.message) for one in said] == [True] * bool(row.said)


def test_the_table() -> None:
    lines = ["| format | dialect | what becomes of it |", "| --- | --- | --- |"]
    lines += [f"| {row.format} | {row.dialect} | {row.becomes} |" for row in DIALECTS]
    assert "\n".join(lines) in DOCS.read_text(encoding="utf-8")
