"""Nastran's bulk data in all layouts and with any end."""

from pathlib import Path

import numpy as np
import pytest

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import nastran, read, write
from wct_plugin.mesh import TetMesh

CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]
SMALL = "".join(f"GRID    {k:>8}        {x:8.3f}{y:8.3f}{z:8.3f}\n" for k, (x, y, z) in enumerate(CORNERS, start=1))
LARGE = "".join(
    f"GRID*   {k:>16}{0:>16}{x:16.9f}{y:16.9f}*G{k}\n*G{k:<6}{z:16.9f}\n"
    for k, (x, y, z) in enumerate(CORNERS, start=1)
)
FREE = "".join(f"GRID,{k},,{x:.1f},{y:.1f},{z:.1f}\n" for k, (x, y, z) in enumerate(CORNERS, start=1))
ROWS = ((1, 7, 1, 2, 3, 4), (2, 8, 2, 5, 3, 4))
TETS = "".join("CTETRA  " + "".join(f"{number:>8}" for number in row) + "\n" for row in ROWS)
TETS_LARGE = "".join(
    "CTETRA* " + "".join(f"{n:>16}" for n in row[:4]) + "\n*       " + "".join(f"{n:>16}" for n in row[4:]) + "\n"
    for row in ROWS
)
TETS_FREE = "CTETRA,1,7,1,2,3,4\nCTETRA,2,8,2,5,3,4\n"
CONTROL = "$ written by hand\nSOL 101\nCEND\nTITLE = GRID, 1\nBEGIN BULK\n"


def mesh_of(folder: Path, text: str, name: str = "a.bdf") -> TetMesh:
    (folder / name).write_text(text)
    mesh = read(folder / name)
    assert isinstance(mesh, TetMesh)
    return mesh


@pytest.mark.parametrize("grids", [SMALL, LARGE, FREE], ids=["small", "large", "free"])
@pytest.mark.parametrize("tets", [TETS, TETS_LARGE, TETS_FREE], ids=["small", "large", "free"])
@pytest.mark.parametrize("head", ["", CONTROL], ids=["bulk", "control"])
def test_every_layout(grids: str, tets: str, head: str, tmp_path: Path) -> None:
    for end in ("ENDDATA\n", "enddata", "END BULK\n", " ENDDATA $ end\nGRID,9,7,0.,0.,0.\n"):
        mesh = mesh_of(tmp_path, head + grids + tets + end)
        assert mesh.points.tolist() == CORNERS
        assert mesh.tets.tolist() == [[0, 1, 2, 3], [1, 4, 2, 3]]
        assert mesh.regions.tolist() == [7, 8]
        assert mesh.tag_name == "nastran:ref"


def test_a_missing_end_is_said(tmp_path: Path) -> None:
    with pytest.warns(
        WctWarning, match=r"a\.bdf: does not end with ENDDATA: whether all of it is there cannot be told$"
    ):
        mesh = mesh_of(tmp_path, SMALL + TETS)
    assert len(mesh.tets) == 2


def test_short_exponents_comments_tabs_and_small_letters(tmp_path: Path) -> None:
    text = (
        "$ 1\ngrid    1               0.0     0.      0.0-3  $ here\nGRID\t2\t\t1.0+0\t0.\t0.\n"
        "GRID    3               0.      .1+1    0.\n\n$GRID\n"
        "GRID*   4                               0.0             0.0\n*       1.0D+0\nctetra,1,7,1,2,3,4\nEnddata\n"
    )
    assert mesh_of(tmp_path, text).points.tolist() == CORNERS[:4]


def test_continued_lines_of_every_layout(tmp_path: Path) -> None:
    points = "".join(f"GRID,{k},,{k}.,{k * k}.,0.\n" for k in range(1, 11))
    numbers = list(range(1, 11))
    small = "".join(f"{k:>8}" for k in [1, 7, *numbers[:6]]), "".join(f"{k:>8}" for k in numbers[6:])
    cards = [
        f"CTETRA  {small[0]}+\n+       {small[1]}\n",
        f"CTETRA  {small[0]}\n        {small[1]}\n",
        f"CTETRA  {small[0]}+ABC\n+ABC    {small[1]}\n",
        "CTETRA,1,7,1,2,3,4,5,6\n,7,8,9,10\n",
        "CTETRA,1,7,1,2,3,4,5,6,+\n+,7,8,9,10\n",
        "CTETRA,1,7,1,2,3,4,5,6,+A1\n+A1,7,8,9,10\n",
        "CTETRA,1,7,1,2,3,4,5,6,7,8,9,10\n",
        "CTETRA* "
        + "".join(f"{n:>16}" for n in (1, 7, 1, 2))
        + "*\n*       "
        + "".join(f"{n:>16}" for n in (3, 4, 5, 6))
        + "*\n*       "
        + "".join(f"{n:>16}" for n in (7, 8, 9, 10))
        + "\n",
    ]
    for card in cards:
        (tmp_path / "a.bdf").write_text(points + card + "ENDDATA\n")
        raw, lost = nastran.read(tmp_path / "a.bdf")
        assert [(block.type, block.data.tolist()) for block in raw.cells] == [("tetra10", [list(range(10))])], card
        assert raw.cell_data["nastran:ref"][0].tolist() == [7]  # type: ignore[union-attr]
        assert lost == []


def test_four_and_ten_nodes_side_by_side(tmp_path: Path) -> None:
    points = "".join(f"GRID,{k},,{k}.,{k * k}.,0.\n" for k in range(1, 12))
    tets = "CTETRA,1,7,1,2,3,4\nCTETRA,2,7,1,2,3,4,5,6\n,7,8,9,10\nCTETRA,3,8,2,3,4,11\nCTETRA,4,8,2,3,4,5,6,,\n,7\n"
    (tmp_path / "a.bdf").write_text(points + tets + "ENDDATA\n")
    raw, lost = nastran.read(tmp_path / "a.bdf")
    assert {block.type: block.data.tolist() for block in raw.cells} == {
        "tetra": [[0, 1, 2, 3], [1, 2, 3, 10], [1, 2, 3, 4]],
        "tetra10": [list(range(10))],
    }
    assert lost == ["nodes on edges of 1 elements that do not have all of them"]


def test_other_cells_come_in_vtk_s_order(tmp_path: Path) -> None:
    points = "".join(f"GRID,{k},,{k}.,{k * k}.,0.\n" for k in range(1, 21))
    row = ",".join(map(str, range(1, 21)))
    text = (
        f"{points}CHEXA,1,1,{row}\nCPENTA,2,1,{','.join(map(str, range(1, 16)))}\nCPYRAM,3,1,1,2,3,4,5\n"
        "CQUAD4,4,2,1,2,3,4,0.0,.5\n"
        "CTRIA3,5,3,1,2,3\nCTRIA6,6,3,1,2,3,4,5,6\nCBAR,7,4,1,2,0.,0.,1.\nCONROD,8,2,3,9\nPLOTEL,9,3,4\nENDDATA\n"
    )
    (tmp_path / "a.bdf").write_text(text)
    raw, _ = nastran.read(tmp_path / "a.bdf")
    assert {block.type: block.data.tolist() for block in raw.cells} == {
        "hexahedron20": [[*range(12), 16, 17, 18, 19, 12, 13, 14, 15]],
        "wedge15": [[*range(9), 12, 13, 14, 9, 10, 11]],
        "pyramid": [[0, 1, 2, 3, 4]],
        "quad": [[0, 1, 2, 3]],
        "triangle": [[0, 1, 2]],
        "triangle6": [[0, 1, 2, 3, 4, 5]],
        "line": [[0, 1], [1, 2], [2, 3]],
    }
    tags = dict(zip([block.type for block in raw.cells], raw.cell_data["nastran:ref"], strict=True))
    assert tags["line"].tolist() == [4, 0, 0]  # type: ignore[union-attr]


def test_other_elements_are_counted(tmp_path: Path) -> None:
    with pytest.warns(WctWarning, match="not read: 2 elements of type CONM2, 1 element of type RBE2$"):
        mesh_of(tmp_path, FREE + TETS + "CONM2,11,1,0,3.\nCONM2,12,2,0,3.\nRBE2,13,1,123,2,3\nMAT1,1,2.+7\nENDDATA\n")


def test_files_included(tmp_path: Path) -> None:
    (tmp_path / "grids.bdf").write_text(SMALL)
    mesh = mesh_of(tmp_path, f"BEGIN BULK\nINCLUDE 'grids.bdf'\n{TETS}ENDDATA\n")
    assert mesh.points.tolist() == CORNERS
    (tmp_path / "a.bdf").write_text("include '/etc/passwd'\n")
    with pytest.raises(InputError, match="includes '/etc/passwd'; allowed are files beside it or below"):
        read(tmp_path / "a.bdf")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (FREE.replace("GRID,5,,", "GRID,5,3,") + TETS,
         "has GRID 5 in coordinate system 3; allowed are points in the basic one, 0"),
        ("GRDSET,,3\n" + FREE + TETS, "has GRDSET with a coordinate system; allowed are points in the basic one, 0"),
        (FREE + "CTETRA,1,7,1,2,3\n", "has CTETRA 1 with fewer than 4 nodes"),
        (FREE + "CTETRA,1,7,1,2,3,9\n", "has no GRID 9, which a CTETRA names"),
        (FREE.replace("GRID,5", "GRID,4") + TETS, "has 5 GRIDs with only 4 different numbers"),
        (FREE.replace("1.0", "x", 1) + TETS, "has a card GRID that has 'x' where a number should be"),
        (TETS, "has no GRID"),
    ],
)  # fmt: skip
def test_refusals(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "a.bdf").write_text(text + "ENDDATA\n")
    with pytest.raises(InputError) as caught:
        read(tmp_path / "a.bdf")
    assert str(caught.value) == f"{tmp_path / 'a.bdf'}: cannot be read as Nastran: {said}"


def test_many_cards_at_once(tmp_path: Path) -> None:
    """More than one chunk of lines."""
    random = np.random.default_rng(0)
    points = random.random((70_000, 3)).round(5)
    grids = "".join(
        f"GRID    {k:>8}        {x:8.5f}{y:8.5f}{z:8.5f}\n" for k, (x, y, z) in enumerate(points.tolist(), start=1)
    )
    (tmp_path / "a.bdf").write_text(grids + TETS + "ENDDATA\n")
    raw, _ = nastran.read(tmp_path / "a.bdf")
    assert np.array_equal(raw.points, points)


def test_numbers_of_points_are_no_coordinate_systems(tmp_path: Path) -> None:
    """An array of that name, as files read by others may have, is named as lost."""
    mesh = mesh_of(tmp_path, FREE + TETS + "ENDDATA\n")
    given = TetMesh(
        mesh.points, mesh.tets, mesh.regions, point_data={"nastran:ref": np.arange(5)}, tag_name="nastran:ref"
    )
    with pytest.warns(WctWarning, match="dropped: point data 'nastran:ref'"):
        write(tmp_path / "b.bdf", given)
    again = read(tmp_path / "b.bdf")
    assert isinstance(again, TetMesh)
    assert np.array_equal(again.points, mesh.points)
