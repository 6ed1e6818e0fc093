"""SU2's markers: names there and back, numbers where they have none."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.builders import kuhn_cube

import wct_plugin as wct
from wct_plugin.errors import InputError
from wct_plugin.mesh import Cells, TetMesh

TETS = """% a comment = 3
NDIME= 3
NELEM= 2  % two
10 0 1 2 3 0
10 1 2 3 4 1
NPOIN= 5 5
0 0 0 0
1 0 0 1
0 1 0 2
0 0 1 3
1 1 1 4
"""


def read(path: Path, markers: str, tets: str = TETS) -> TetMesh:
    path.write_text(tets + markers)
    mesh = wct.read(path)
    assert isinstance(mesh, TetMesh)
    return mesh


def test_names_of_markers_there_and_back(tmp_path: Path) -> None:
    markers = (
        "NMARK= 3\nMARKER_TAG= wall_upper\nMARKER_ELEMS= 2\n5 0 2 1\n5 0 1 3\n"
        "MARKER_TAG= 7\nMARKER_ELEMS=1\n5 0 3 2 5\nMARKER_TAG=farfield \nMARKER_ELEMS= 1\n5 2 3 4\n"
    )
    mesh = read(tmp_path / "a.su2", markers)
    assert mesh.facets.tags.tolist() == [8, 8, 7, 9]
    assert mesh.names == {"wall_upper": (8, 2), "farfield": (9, 2)}
    assert mesh.facets.vertices.tolist() == [[0, 2, 1], [0, 1, 3], [0, 3, 2], [2, 3, 4]]
    assert mesh.points[4].tolist() == [1, 1, 1]
    wct.write(tmp_path / "b.su2", mesh)
    text = (tmp_path / "b.su2").read_text()
    assert [line.split("=")[1].strip() for line in text.splitlines() if line.startswith("MARKER_TAG")] == [
        "7",
        "wall_upper",
        "farfield",
    ]
    again = wct.read(tmp_path / "b.su2")
    assert isinstance(again, TetMesh)
    assert again.names == mesh.names
    assert sorted(again.facets.tags.tolist()) == [7, 8, 8, 9]


def test_names_of_the_user_keep_their_numbers(tmp_path: Path) -> None:
    """The comment that has the number is in the file; without it markers are numbered in their order."""
    cube = kuhn_cube(2)
    facets = cube.topology.boundary
    tags = np.repeat([30, 4, 50], 16)
    mesh = replace(cube, facets=Cells(facets, tags), names={"in": (30, 2), "no good": (4, 2), "out": (50, 2)})
    with pytest.warns(match="SU2 cannot carry, so dropped: name 'no good'"):
        wct.write(tmp_path / "a.su2", mesh)
    again = wct.read(tmp_path / "a.su2")
    assert isinstance(again, TetMesh)
    assert again.names == {"in": (30, 2), "out": (50, 2)}
    assert np.unique(again.facets.tags).tolist() == [4, 30, 50]
    text = (tmp_path / "a.su2").read_text()
    (tmp_path / "b.su2").write_text("".join(row for row in text.splitlines(True) if not row.startswith("%")))
    assert wct.read(tmp_path / "b.su2").names == {"in": (5, 2), "out": (6, 2)}  # type: ignore[union-attr]


def test_a_marker_in_two_parts_is_one(tmp_path: Path) -> None:
    markers = "NMARK= 2\n" + "MARKER_TAG= a\nMARKER_ELEMS= 1\n5 0 2 1\n" + "MARKER_TAG= a\nMARKER_ELEMS= 1\n5 0 1 3\n"
    assert read(tmp_path / "a.su2", markers).facets.tags.tolist() == [1, 1]


def test_names_go_to_gmsh_and_come_back(tmp_path: Path) -> None:
    markers = "NMARK= 1\nMARKER_TAG= wand_süd\nMARKER_ELEMS= 1\n5 0 2 1\n"
    mesh = read(tmp_path / "a.su2", markers)
    wct.write(tmp_path / "a.msh", mesh)
    wct.write(tmp_path / "b.su2", wct.read(tmp_path / "a.msh"))
    assert "MARKER_TAG= wand_süd" in (tmp_path / "b.su2").read_text()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (TETS.replace("NDIME= 3", "NDIME= 4"), "NDIME is 4; allowed are 2 and 3"),
        (TETS.replace("NELEM= 2", "NELEM= 3"), "NELEM has 2 cells but announces 3"),
        (TETS.replace("NPOIN= 5", "NPOIN= 6"), "has 20 coordinates and numbers of points but announces 6 points"),
        (TETS.replace("NPOIN= 5", "NPOIN= x"), "NPOIN has the count 'x'; allowed is a whole number"),
        (TETS.replace("10 1 2 3 4 1", "11 1 2 3 4 1"), "NELEM has cells of kind 11; allowed are 1, 3, 5"),
        (TETS.replace("10 1 2 3 4 1", "10 1 2 3"), "has lines of 4, 6 numbers for tetra cells"),
        (TETS + "NMARK= 2\nMARKER_TAG= a\nMARKER_ELEMS= 1\n5 0 1 2\n", "has 1 markers but announces 2"),
        (TETS.replace("10 1 2 3 4 1", "10 1 2 x 4 1"), "NELEM has 'x' where a whole number should be"),
        (TETS.replace("10 1 2 3 4 1", "10 1 2 3 9 1"), "indices must lie in 0..4"),
        ("garbage\n", "NDIME is not there; allowed are 2 and 3"),
    ],
)
def test_damaged_files_are_refused(content: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "a.su2").write_text(content)
    with pytest.raises(InputError, match=rf"a\.su2: .*{said}"):
        wct.read(tmp_path / "a.su2")
