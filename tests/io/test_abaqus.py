"""Abaqus input files as CAE, HyperMesh, gmsh and people write them."""

from pathlib import Path

import numpy as np
import pytest
from support.volumes import tet_volumes

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import abaqus, read
from wct_plugin.mesh import TetMesh

NODES = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n5, 1, 1, 1\n"
TETS = "*ELEMENT, TYPE=C3D4, ELSET=STEEL\n1, 1, 2, 3, 4\n*ELEMENT, TYPE=C3D4, ELSET=AIR\n2, 2, 5, 3, 4\n"
CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]


def mesh_of(folder: Path, text: str | bytes) -> TetMesh:
    path = folder / "a.inp"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    mesh = read(path)
    assert isinstance(mesh, TetMesh)
    return mesh


def volumes(mesh: TetMesh) -> dict[str, float]:
    each = tet_volumes(mesh)
    return {name: float(each[rows].sum()) for name, rows in mesh.tet_sets.items()}


def refusal(folder: Path, text: str) -> str:
    (folder / "a.inp").write_text(text)
    with pytest.raises(InputError) as caught:
        read(folder / "a.inp")
    start = f"{folder / 'a.inp'}: cannot be read as Abaqus: "
    assert str(caught.value).startswith(start)
    return str(caught.value).removeprefix(start)


@pytest.mark.parametrize(
    "text",
    [
        NODES + TETS,
        (NODES + TETS).lower(),
        (NODES + TETS).replace("\n", "\r\n"),
        (NODES + TETS).replace("*ELEMENT, TYPE", "*Element , Type ").replace(", ", " ,\t"),
        "** a comment\n*HEADING\nanything, 1 2 3\n" + NODES.replace("\n2,", "\n** between\n2,") + TETS,
        NODES + TETS.replace("ELSET=STEEL\n1, 1, 2, 3, 4", "ELSET=STEEL\n1, 1, 2,\n 3, 4").replace("C3D4", "C3D4H"),
        NODES.replace(", 0\n", "\n").replace("0, 0", "0., 0.D0") + TETS.replace("C3D4", "dc3d4"),
        NODES.replace("\n1, 0, 0, 0", "\n1, , 0,").replace("*NODE", "*NODE, SYSTEM=R") + TETS,
        NODES + TETS.replace("TYPE=C3D4, ELSET=STEEL", "ELSET=STEEL,\nTYPE=C3D4"),
        NODES.replace("1, 1, 1\n", "1, 1, 1, 0, 0, 1\n") + TETS,
    ],
)  # fmt: skip
def test_any_case_and_layout(text: str, tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path, text)
    assert mesh.points.tolist() == CORNERS
    assert mesh.tets.tolist() == [[0, 1, 2, 3], [1, 4, 2, 3]]
    assert {name.upper(): rows.tolist() for name, rows in mesh.tet_sets.items()} == {"STEEL": [0], "AIR": [1]}


def test_numbers_may_have_gaps_and_any_order(tmp_path: Path) -> None:
    nodes = "*NODE\n900000000, 0, 0, 1\n30, 0, 1, 0\n7, 0, 0, 0\n20, 1, 0, 0\n"
    text = nodes + "*ELEMENT, TYPE=C3D4\n55, 7, 20, 30, 900000000\n"
    mesh = mesh_of(tmp_path, text)
    assert mesh.points[mesh.tets[0]].tolist() == CORNERS[:4]


def test_sets_of_sets_ranges_and_names(tmp_path: Path) -> None:
    text = (
        NODES
        + TETS
        + (
            "*ELSET, ELSET=ALL, GENERATE\n1, 99\n*ELSET, ELSET=ODD, GENERATE\n1, 9, 2\n*ELSET, ELSET=BOTH\nsteel, AIR\n"
            "*ELSET, ELSET=more\n BOTH,\n*ELSET, elset=mixed\nSTEEL, 2\n*NSET, NSET=base, GENERATE\n1, 3\n"
            '*NSET, NSET=base\n4\n*NSET, NSET="with blank", UNSORTED\n5, base\n*NSET, NSET=of air, ELSET=AIR\n'
        )
    )
    mesh = mesh_of(tmp_path, text)
    assert {name: rows.tolist() for name, rows in mesh.tet_sets.items()} == {
        "STEEL": [0], "AIR": [1], "ALL": [0, 1], "ODD": [0], "BOTH": [0, 1], "more": [0, 1], "mixed": [0, 1],
    }  # fmt: skip
    assert {name: rows.tolist() for name, rows in mesh.point_sets.items()} == {
        "base": [0, 1, 2, 3], "with blank": [0, 1, 2, 3, 4], "of air": [1, 2, 3, 4],
    }  # fmt: skip
    assert volumes(mesh)["BOTH"] == pytest.approx(1 / 6 + 1 / 3, rel=1e-12)


def test_members_that_are_not_there_are_named(tmp_path: Path) -> None:
    text = NODES + TETS + "*ELSET, ELSET=A\n1, 77, 78\n*NSET, NSET=B\n1, nowhere\n*SURFACE, NAME=skin\nA, S1\n"
    said = "not read: surface 'skin', 2 members of set 'A', which are not there, 'nowhere' in set 'B', which is no set"
    with pytest.warns(WctWarning, match=said):
        mesh = mesh_of(tmp_path, text)
    assert mesh.tet_sets["A"].tolist() == [0]


def test_other_elements_are_left_out_and_counted(tmp_path: Path) -> None:
    text = (
        NODES
        + TETS
        + (
            "*ELEMENT, TYPE=MASS, ELSET=PT\n3, 1\n4, 2\n*ELEMENT, TYPE=SPRINGA, ELSET=SP\n5, 1, 2\n"
            "*ELEMENT, TYPE=CONN3D2\n6, 1,\n2\n*ELSET, ELSET=MIX\n1, 3\n*ELEMENT, TYPE=B31, ELSET=BEAM\n7, 1, 2, 5\n"
            "*ELEMENT, TYPE=S3R, ELSET=SKIN\n8, 1, 2, 3\n*ELEMENT, TYPE=M3D3\n9, 1, 2, 4\n"
        )
    )
    said = (
        "not read: 2 elements of type MASS, 1 element of type SPRINGA, 1 element of type CONN3D2, "
        "set 'PT' of elements that are not read, set 'SP' of elements that are not read$"
    )
    with pytest.warns(WctWarning, match=said):
        mesh = mesh_of(tmp_path, text)
    assert mesh.edges.vertices.tolist() == [[0, 1]]
    assert mesh.facets.vertices.tolist() == [[0, 1, 2], [0, 1, 3]]
    assert mesh.facets.sets["SKIN"].tolist() == [0]
    assert mesh.facets.sets["abaqus:M3D3"].tolist() == [1]
    assert mesh.element_types == {"triangle": "S3R"}
    assert mesh.tet_sets["MIX"].tolist() == [0]
    raw, _ = abaqus.read(tmp_path / "a.inp")
    assert raw.element_types == {"tetra": "C3D4", "line": "B31", "triangle": "S3R"}


@pytest.mark.parametrize(
    ("type_", "kind"),
    [
        ("C3D4", "tetra"), ("C3D4H", "tetra"), ("DC3D4", "tetra"), ("AC3D4", "tetra"), ("Q3D4", "tetra"),
        ("F3D4", "tetra"),
        ("C3D10", "tetra10"), ("C3D10MH", "tetra10"), ("C3D10HS", "tetra10"), ("DC3D10", "tetra10"),
        ("C3D6", "wedge"), ("C3D15V", "wedge15"), ("COH3D6", "wedge"), ("SC6R", "wedge"), ("C3D5", "pyramid"),
        ("C3D8R", "hexahedron"), ("C3D8I", "hexahedron"), ("SC8R", "hexahedron"), ("C3D20RI", "hexahedron20"),
        ("S3", "triangle"), ("S3RS", "triangle"), ("STRI3", "triangle"), ("DS3", "triangle"), ("CPS3", "triangle"),
        ("CPE3H", "triangle"), ("CAX3", "triangle"), ("R3D3", "triangle"), ("M3D3", "triangle"), ("SFM3D3", "triangle"),
        ("DC2D3", "triangle"), ("STRI65", "triangle6"), ("CPS6M", "triangle6"), ("S6", "triangle6"),
        ("S4R", "quad"), ("S4R5", "quad"), ("R3D4", "quad"), ("M3D4R", "quad"), ("S8R5", "quad8"), ("CPE8R", "quad8"),
        ("T3D2", "line"), ("B31", "line"), ("B31OSH", "line"), ("B33", "line"), ("PIPE31", "line"), ("R2D2", "line"),
        ("RB3D2", "line"), ("B32", "line3"), ("T3D3", "line3"), ("SAX1", "line"),
        ("MASS", None), ("ROTARYI", None), ("SPRINGA", None), ("SPRING1", None), ("DASHPOTA", None), ("CONN3D2", None),
        ("GAPUNI", None), ("DCOUP3D", None), ("ITSUNI", None), ("U1", None),
    ],
)  # fmt: skip
def test_types_of_elements(type_: str, kind: str | None) -> None:
    found = abaqus_element(type_)
    assert found == kind


def abaqus_element(type_: str) -> str | None:
    from wct_plugin.io.abaqus_elements import element_of

    found = element_of(type_)
    return found and found.kind


ASSEMBLY = f"""*HEADING
*PART, NAME=Block
{NODES}*ELEMENT, TYPE=C3D4
1, 1, 2, 3, 4
2, 2, 5, 3, 4
*ELSET, ELSET=core
1
*END PART
*PART, NAME=Single
*NODE
10, 0, 0, 0
20, 2, 0, 0
30, 0, 2, 0
40, 0, 0, 2
*ELEMENT, TYPE=C3D4, ELSET=only
1, 10, 20, 30, 40
*END PART
*ASSEMBLY, NAME=Assembly
*INSTANCE, NAME=Block-1, PART=Block
*END INSTANCE
*INSTANCE, NAME=Block-2, PART=BLOCK
10., 0., 0.
10., 0., 0., 10., 0., 1., 90.
*END INSTANCE
*INSTANCE, NAME=Single-1, PART=Single
0, 5
*END INSTANCE
*NSET, NSET=tips, INSTANCE=Block-1
4
*NSET, NSET=tips, INSTANCE=Single-1
40
*ELSET, ELSET=bodies, INSTANCE=Block-2, GENERATE
1, 2
*ELSET, ELSET=named
Block-1.core, Block-2.2, Single-1.only
*END ASSEMBLY
"""


def test_parts_stand_where_their_instances_put_them(tmp_path: Path) -> None:
    """Numbers are those of each part; the second instance is shifted, then turned round an axis along z."""
    mesh = mesh_of(tmp_path, ASSEMBLY)
    assert len(mesh.points) == 14
    assert len(mesh.tets) == 5
    turned = [[10, 0, 0], [10, 1, 0], [9, 0, 0], [10, 0, 1], [9, 1, 1]]
    assert np.allclose(mesh.points[5:10], turned, rtol=0, atol=1e-15)
    assert mesh.points[10:].tolist() == [[0, 5, 0], [2, 5, 0], [0, 7, 0], [0, 5, 2]]
    assert {name: rows.tolist() for name, rows in mesh.tet_sets.items()} == {
        "Block-1.core": [0], "Block-2.core": [2], "only": [4], "bodies": [2, 3], "named": [0, 3, 4],
    }  # fmt: skip
    assert {name: rows.tolist() for name, rows in mesh.point_sets.items()} == {"tips": [3, 13]}
    assert volumes(mesh)["bodies"] == pytest.approx(0.5, rel=1e-12)


def test_parts_without_an_assembly_and_one_instance_keep_plain_names(tmp_path: Path) -> None:
    part = ASSEMBLY.split("*PART, NAME=Single")[0]
    mesh = mesh_of(tmp_path, part)
    assert {name: rows.tolist() for name, rows in mesh.tet_sets.items()} == {"core": [0]}
    one = part + "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=B-1, PART=Block\n*END INSTANCE\n*END ASSEMBLY\n"
    assert {name: rows.tolist() for name, rows in mesh_of(tmp_path, one).tet_sets.items()} == {"core": [0]}


def test_files_included_from_beside_and_below(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "nodes.inp").write_text(NODES)
    (tmp_path / "sub" / "mesh.inp").write_text("*INCLUDE, INPUT=nodes.inp\n*include,input=..\\elements.inp\n")
    (tmp_path / "elements.inp").write_text(TETS)
    (tmp_path / "set.txt").write_text("1, 2\n")
    mesh = mesh_of(tmp_path, "*HEADING\n*INCLUDE, INPUT=sub/mesh.inp\n*ELSET, ELSET=ALL, INPUT=set.txt\n")
    assert volumes(mesh) == pytest.approx({"STEEL": 1 / 6, "AIR": 1 / 3, "ALL": 0.5}, rel=1e-12)


def test_files_elsewhere_are_not_included(tmp_path: Path) -> None:
    folder = tmp_path / "model"
    folder.mkdir()
    (tmp_path / "outside.inp").write_text(NODES)
    (folder / "link.inp").symlink_to(tmp_path / "outside.inp")
    for name in ("../outside.inp", "/etc/passwd", "/dev/zero", "link.inp", str(tmp_path / "outside.inp")):
        said = refusal(folder, f"*INCLUDE, INPUT={name}\n{TETS}")
        assert said == f"includes {name!r}; allowed are files beside it or below"
    assert refusal(folder, "*INCLUDE, INPUT=no.inp\n") == "includes 'no.inp', which is not there"
    assert refusal(folder, "*INCLUDE, INPUT=.\n") == "includes '.', which is no file"
    assert refusal(folder, "*INCLUDE, INPUT=a.inp\n") == "includes 'a.inp', which includes itself"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (NODES + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3\n", "has 4 numbers for elements of type C3D4; expected 5 for each"),
        (NODES + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 9\n", "has no node 9, which an element of type C3D4 names"),
        (NODES + "*ELEMENT\n1, 1, 2, 3, 4\n", "has *ELEMENT without TYPE="),
        ("*NODE, SYSTEM=C\n1, 0, 0, 0\n", "has *NODE with SYSTEM=C; allowed are nodes in rectangular coordinates"),
        (NODES + "*NGEN\n1, 5\n", "has *NGEN; allowed are files that list all nodes and elements"),
        (NODES.replace("5, 1", "5, x") + TETS, "has *NODE with ['5', 'x', '1', '1']; expected numbers"),
        (TETS, "has no *NODE"),
        ("1, 2, 3\n" + NODES, "begins with '1, 2, 3'; expected a keyword such as *HEADING"),
        (NODES + TETS + "*ELSET, ELSET=A\nB\n*ELSET, ELSET=B\nA\n", "has set 'a', which has itself among its members"),
        ("*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n", "has instance 'I' of part 'P', which is not there"),
        (NODES + TETS + "*ELSET, ELSET=A, GENERATE\n1, 5, 0\n",
         "has the line [1, 5, 0] in set 'A'; expected first, last and step"),
    ],
)  # fmt: skip
def test_refusals(text: str, said: str, tmp_path: Path) -> None:
    assert refusal(tmp_path, text) == said


def test_nodes_given_again_are_said(tmp_path: Path) -> None:
    with pytest.warns(WctWarning, match="not read: earlier places of 1 nodes that are given again"):
        mesh = mesh_of(tmp_path, NODES + "*NODE\n5, 2, 2, 2\n" + TETS)
    assert mesh.points[4].tolist() == [2, 2, 2]


def test_ten_node_tets_and_latin_names(tmp_path: Path) -> None:
    points = "".join(f"{k}, {k}, {k * k}, 0\n" for k in range(1, 11))
    text = f"*NODE\n{points}*ELEMENT, TYPE=C3D10, ELSET=Körper\n1, 1, 2, 3, 4, 5, 6, 7,\n8, 9, 10\n"
    (tmp_path / "a.inp").write_bytes(text.encode("latin-1"))
    raw, lost = abaqus.read(tmp_path / "a.inp")
    assert [(block.type, block.data.tolist()) for block in raw.cells] == [("tetra10", [list(range(10))])]
    assert list(raw.cell_sets) == ["Körper"]
    assert lost == []
