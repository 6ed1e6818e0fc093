"""Universal files as gmsh and Salome write them, and dialects by hand."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gmsh
import numpy as np
import pytest
from support.builders import two_region_cube
from support.gmsh_session import add_two_boxes, gmsh_session
from support.volumes import region_volumes

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import read
from wct_plugin.mesh import SurfaceMesh, TetMesh

CUBE = two_region_cube(2)
POINTS = CUBE.points * [1 / 3, 1.1, np.pi]
ENDS = CUBE.topology.boundary[(CUBE.points[CUBE.topology.boundary, 0] == 0).all(axis=1)]


@pytest.fixture
def boxes() -> Iterator[None]:
    """Two boxes of volume 1 and 2 in gmsh, with groups of volumes and of a face."""
    with gmsh_session():
        add_two_boxes(2)
        for tag, name in ((1, "steel"), (2, "air")):
            gmsh.model.addPhysicalGroup(3, [tag], tag + 10, name)
        gmsh.model.addPhysicalGroup(2, [1], 7, "inlet")
        gmsh.model.mesh.setSize(gmsh.model.getEntities(0), 0.7)
        gmsh.model.mesh.generate(3)
        yield


@pytest.mark.parametrize("nodes", [0, 1])
def test_as_gmsh_writes_it(nodes: int, boxes: None, tmp_path: Path) -> None:
    gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", nodes)
    gmsh.option.setNumber("Mesh.SaveGroupsOfElements", 1)
    gmsh.write(str(tmp_path / "a.unv"))
    mesh = read(tmp_path / "a.unv")
    assert isinstance(mesh, TetMesh)
    assert region_volumes(mesh) == pytest.approx({11: 1, 12: 2}, rel=1e-12)
    assert {name: tuple(pair) for name, pair in mesh.names.items()} == {
        "steel": (11, 3),
        "air": (12, 3),
        "inlet": (7, 2),
    }
    assert set(mesh.facets.tags.tolist()) == {7}
    a, b, c = np.moveaxis(mesh.points[mesh.facets.vertices], 1, 0)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(1, rel=1e-12)
    assert ("inlet" in mesh.point_sets) == bool(nodes)
    if nodes:
        assert (mesh.points[mesh.point_sets["inlet"], 0] == 0).all()


def test_cells_of_second_order_have_their_mid_nodes_in_the_middle(boxes: None, tmp_path: Path) -> None:
    from wct_plugin.io import unv

    gmsh.model.mesh.setOrder(2)
    gmsh.write(str(tmp_path / "a.unv"))
    raw, _ = unv.read(tmp_path / "a.unv")
    for kind, edges in (
        ("tetra10", [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]),
        ("triangle6", [(0, 1), (1, 2), (2, 0)]),
    ):
        (block,) = (block for block in raw.cells if block.type == kind)
        corners = 4 if kind == "tetra10" else 3
        for k, (a, b) in enumerate(edges):
            middle = (raw.points[block.data[:, a]] + raw.points[block.data[:, b]]) / 2
            assert np.allclose(raw.points[block.data[:, corners + k]], middle, atol=1e-14)


def unv(*datasets: tuple[int, str]) -> str:
    return "".join(f"    -1\n{number:6d}\n{content}    -1\n" for number, content in datasets)


def ints(rows: Any, width: int = 8) -> str:
    """Lines of numbers of ten characters, so many on each."""
    flat = list(rows)
    return "".join("".join(f"{v:10d}" for v in flat[k : k + width]) + "\n" for k in range(0, len(flat), width))


def nodes(labels: Any, number: int = 2411) -> tuple[int, str]:
    lines = ""
    for label, place in zip(labels, POINTS.tolist(), strict=True):
        coordinates = "".join(f"{value:25.16E}".replace("E", "D") for value in place)
        lines += ints([label, 1, 1, 11]) + coordinates + "\n"
    return number, lines


def cells(descriptor: int, rows: Any, first: int, material: Any, *, old: bool = False) -> str:
    lines = ""
    for k, row in enumerate(np.asarray(rows).tolist()):
        head = [first + k, descriptor, 1, material[k], 7, len(row)]
        lines += ints([*head[:2], 1, 1, 1, material[k], 7, len(row)] if old else head)
        lines += ints([0, 1, 1]) if descriptor in (11, 21) else ""
        lines += ints(row)
    return lines


LABELS = np.arange(len(POINTS))[::-1] * 3 + 5  # neither from 1 on nor ascending


@pytest.mark.parametrize("number", [2467, 2477, 2452, 2435, 2432, 2429])
def test_groups_as_salome_writes_them(number: int, tmp_path: Path) -> None:
    """Beams among the cells, groups that overlap, and one of points; each form of group has its number."""
    count = len(CUBE.tets)
    flat = np.ones(99999, int)
    text = (
        cells(21, LABELS[ENDS[:3, :2]], 1, flat)
        + cells(41, LABELS[ENDS], 101, flat)
        + cells(111, LABELS[CUBE.tets], 1001, flat)
    )
    wide = number not in (2432, 2429)

    def group(tag: int, name: str, kind: int, members: Any) -> str:
        listed = [v for m in members for v in ((kind, m, 0, 0) if wide else (kind, m))]
        return ints([tag, 0, 0, 0, 0, 0, 0, len(members)]) + name + "\n" + ints(listed)

    first = np.flatnonzero(CUBE.regions == CUBE.regions[0])
    groups = group(1, "matière", 8, 1001 + first) + group(2, "rest", 8, np.setdiff1d(np.arange(count), first) + 1001)
    groups += group(3, "entrée", 8, 101 + np.arange(len(ENDS))) + group(4, "some", 8, [101, 103])
    groups += group(5, "fixed", 7, LABELS[:5])
    header = (164, "         1  SI\n  1.0D+00  1.0D+00  1.0D+00\n  2.7315D+02\n")
    (tmp_path / "a.unv").write_text(unv(header, nodes(LABELS), (2412, text), (number, groups)))
    mesh = read(tmp_path / "a.unv")
    assert isinstance(mesh, TetMesh)
    assert np.array_equal(mesh.tets, CUBE.tets)
    assert np.allclose(mesh.points, POINTS, rtol=1e-15, atol=0)
    assert np.array_equal(mesh.regions, np.where(CUBE.regions == CUBE.regions[0], 1, 2))
    assert mesh.names["matière"] == (1, 3)
    assert set(mesh.facets.tags.tolist()) == {3}
    assert mesh.facets.sets["some"].tolist() == [0, 2]
    assert np.array_equal(np.sort(mesh.point_sets["fixed"]), np.arange(5))
    assert not len(mesh.edges)  # in no group, on the boundary: they only list it


@pytest.mark.parametrize("old", [False, True])
def test_materials_without_groups(old: bool, tmp_path: Path) -> None:
    text = cells(111, LABELS[CUBE.tets], 1, CUBE.regions + 30, old=old)
    (tmp_path / "a.unv").write_text(unv(nodes(LABELS, 781 if old else 2411), (780 if old else 2412, text)))
    mesh: Any = read(tmp_path / "a.unv")
    assert np.array_equal(mesh.regions, CUBE.regions + 30)


def test_other_elements_and_datasets_are_named(tmp_path: Path) -> None:
    points = "".join(
        ints([k + 1, 1, 1, 1]).rstrip("\n") + f" {x:g} {y:g} 0\n"
        for k, (x, y) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)])
    )
    text = cells(94, [[1, 2, 3, 4]], 1, [1]) + cells(136, [[1, 2]], 2, [1])
    (tmp_path / "a.unv").write_text(unv((15, points), (2412, text), (55, "results\n")))
    with pytest.warns(WctWarning) as caught:
        surface = read(tmp_path / "a.unv")
    said = [str(warning.message).partition(".unv: ")[2] for warning in caught]
    assert said == ["not read: 1 cells of descriptor 136 with 2 points, dataset 55", "1 quad split into triangles"]
    assert isinstance(surface, SurfaceMesh)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("no marks at all\n", "has no datasets between lines of -1"),
        ("    -1\n  2411\n", "ends within a dataset"),
        (unv((2411, "")), "has no points or no cells in the datasets 15, 781, 2411"),
        (unv(nodes(LABELS), (2412, cells(111, [[1, 2, 3, 4]], 1, [1]))), "has no point 1, which a cell names"),
        (unv(nodes(LABELS * 0), (2412, cells(111, [[0, 0, 0, 0]], 1, [1]))), "has 27 points with only 1 different"),
        (unv(nodes(LABELS), (2412, ints([1, 111, 1, 1, 7, 4]) + ints([5, 8, 11]))), "ends within a cell"),
        (unv(nodes(LABELS), (2412, cells(111, LABELS[CUBE.tets[:1]], 1, [1])),
             (2467, ints([1, 0, 0, 3]) + "a\n" + ints([8, 1, 0, 0]))),
         "group 'a' has 1 members but announces 3"),
        (unv(nodes(LABELS)).replace("D+00", "x"), "has .*x' where a number should be"),
    ],
)  # fmt: skip
def test_refusals(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "a.unv").write_text(text)
    with pytest.raises(InputError, match=rf"a\.unv: cannot be read as UNV: {said}"):
        read(tmp_path / "a.unv")
