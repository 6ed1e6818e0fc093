"""Cells beside tets: read, kept, written, by every format that has them, and seen there by other readers."""

import warnings
from pathlib import Path
from typing import Any

import gmsh
import meshio
import numpy as np
import pytest
from support.gmsh_session import gmsh_session

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import read, write
from wct_plugin.io.assembly import to_mesh
from wct_plugin.io.formats import FORMATS
from wct_plugin.io.gmsh_sections import KINDS
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.mesh import Cells, TetMesh, cell_kinds
from wct_plugin.mesh.other_cells import OtherCells, find_contact

DATA = Path(__file__).parents[1] / "data"
SUFFIXES = [form.suffixes[0] for form in FORMATS if form.others]
pytestmark = pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")

#: A cube with a pyramid, a tet beside that, and a wedge on the tet; a second tet touches the cube along an edge alone.
POINTS = np.array(
    [
        [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1],  # cube
        [0.5, 0.5, 2], [1.75, 0.5, 1.75],  # tips of the pyramid and the tet
        [0.5, -1, 2.25], [1.5, -1, 1.25], [2.25, -0.75, 1.75],  # the wedge's far side
        [-1, -0.5, 0.25], [-1, 0.5, 0.75],  # of the second tet
    ],
    dtype=float,
)  # fmt: skip
HEXAHEDRON, PYRAMID = [0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8]
TETS = [[5, 6, 8, 9], [0, 4, 13, 14]]
WEDGE = [5, 9, 8, 11, 12, 10]


def mixed() -> meshio.Mesh:
    cells = [
        ("tetra", TETS), ("hexahedron", [HEXAHEDRON]), ("pyramid", [PYRAMID]), ("wedge", [WEDGE]),
        ("quad", [[0, 3, 2, 1], [0, 1, 5, 4]]), ("triangle", [[5, 6, 8], [6, 7, 8], [6, 9, 8]]),
        ("line", [[0, 4], [0, 1]]),
    ]  # fmt: skip
    tags = [[1, 2], [3], [4], [5], [6, 7], [8, 9, 10], [11, 12]]
    return meshio.Mesh(POINTS, cells, cell_data={"gmsh:physical": [np.array(one) for one in tags]})


def flat(mesh: TetMesh) -> dict[str, Any]:
    """All cells by the coordinates of their points, with their tags."""
    out: dict[str, Any] = {"tetra": (mesh.points[mesh.tets], mesh.regions)}
    assert mesh.others is not None
    for kind, cells in (("triangle", mesh.facets), ("line", mesh.edges)):
        out[kind] = (mesh.points[cells.vertices], cells.tags)
    for kind, cells in mesh.others.cells.items():
        out[f"other {kind}"] = (mesh.others.points[cells.vertices], cells.tags)
    return out


def test_what_is_of_tets_and_what_is_not(tmp_path):
    mixed().write(tmp_path / "a.vtu")
    mesh = read(tmp_path / "a.vtu")
    assert mesh.regions.tolist() == [1, 2]
    assert mesh.facets.tags.tolist() == [8, 10]  # facets of tets; that of pyramid and nothing is the pyramid's
    assert mesh.edges.tags.tolist() == [11]
    others = mesh.others
    assert others.volumes == {"hexahedron": 1, "pyramid": 1, "wedge": 1}
    assert {kind: cells.tags.tolist() for kind, cells in others.cells.items()} == {
        "hexahedron": [3], "pyramid": [4], "wedge": [5], "quad": [6, 7], "triangle": [9], "line": [12],
    }  # fmt: skip
    assert len(mesh.points) == 8
    assert sorted(others.shared[others.shared >= 0].tolist()) == sorted({*range(8)} - set(others_only(mesh)))
    assert not mesh.repairs.orphan_points


def others_only(mesh: TetMesh) -> list[int]:
    """Points of tets that no other cell has: the two of the second tet, by coordinates."""
    return [k for k, point in enumerate(mesh.points) if point[0] < 0]


def test_where_tets_touch_other_cells(tmp_path):
    mixed().write(tmp_path / "a.vtu")
    mesh = read(tmp_path / "a.vtu")
    contact = find_contact(mesh.topology.boundary, mesh.others, len(mesh.points))
    assert contact.facets.sum() == 2  # the pyramid's side and the wedge's end
    assert not contact.halves.any()
    assert contact.beside.sum() == 1  # one of the two facets of the second tet at the edge it shares holds that


def test_quadrilaterals_that_meet_two_facets_are_named(tmp_path):
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1], [0.5, 0.5, 2]]
    cells = [("tetra", [[4, 5, 6, 8], [4, 6, 7, 8]]), ("hexahedron", [HEXAHEDRON])]
    meshio.Mesh(np.array(points, float), cells).write(tmp_path / "a.vtu")
    with pytest.warns(WctWarning, match="2 facets of tets lie in quadrilaterals of other cells, where the mesh is not"):
        mesh = read(tmp_path / "a.vtu")
    assert find_contact(mesh.topology.boundary, mesh.others, len(mesh.points)).halves.sum() == 2


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_format_gives_back_what_it_got(suffix, tmp_path):
    mixed().write(tmp_path / "a.vtu")
    mesh = read(tmp_path / "a.vtu")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        write(tmp_path / f"b{suffix}", mesh)
    said = " ".join(str(one.message) for one in caught)
    back = read(tmp_path / f"b{suffix}")
    want, got = flat(mesh), flat(back)
    for name, (cells, tags) in want.items():
        kind = name.removeprefix("other ")
        if f"{kind} cells" in said and f"tags of {kind} cells" not in said:
            assert name not in got  # Abaqus has no pyramids here, SU2 no edges
            continue
        if kind == "line" and "tagged edges" in said:
            continue
        assert np.allclose(got[name][0], cells, rtol=0, atol=1e-12), (suffix, name)
        if f"tags of {kind} cells" not in said and not (kind == "tetra" and "regions" in said):
            assert got[name][1].tolist() == tags.tolist(), (suffix, name)
    assert (suffix == ".su2") == ("tags of hexahedron cells" in said)


def test_data_and_sets_of_other_cells_and_points_come_back(tmp_path):
    given = mixed()
    given.cell_data["heat"] = [np.linspace(0, 1, len(block)) + k for k, block in enumerate(given.cells)]
    given.point_data["u"] = np.sqrt(np.arange(len(POINTS)))
    given.point_data["set:far"] = (np.arange(len(POINTS)) > 7).astype("u1")
    given.cell_data["set:some"] = [np.ones(len(block), dtype="u1") for block in given.cells]
    given.write(tmp_path / "a.vtu")
    write(tmp_path / "b.vtu", read(tmp_path / "a.vtu"))
    back = meshio.read(tmp_path / "b.vtu")
    place = [int(np.flatnonzero((given.points == point).all(axis=1))[0]) for point in back.points]
    assert sorted(place) == list(range(len(POINTS)))
    assert np.array_equal(back.point_data["u"], given.point_data["u"][place])
    assert np.array_equal(back.point_data["set:far"], given.point_data["set:far"][place])
    for block, heat, some in zip(back.cells, back.cell_data["heat"], back.cell_data["set:some"], strict=True):
        at = next(k for k, one in enumerate(given.cells) if one.type == block.type)
        cells = [sorted(row) for row in given.cells[at].data.tolist()]
        rows = [cells.index(sorted(row)) for row in np.array(place)[block.data].tolist()]
        assert np.array_equal(heat, given.cell_data["heat"][at][rows])
        assert some.all()


@pytest.mark.parametrize("suffix", [".msh", ".med"])
def test_gmsh_sees_volumes_the_right_way_round(suffix, tmp_path):
    mixed().write(tmp_path / "a.vtu")
    write(tmp_path / f"b{suffix}", read(tmp_path / "a.vtu"))
    with gmsh_session():
        gmsh.open(str(tmp_path / f"b{suffix}"))
        for kind, count in ((4, 2), (5, 1), (6, 1), (7, 1)):
            elements = gmsh.model.mesh.getElementsByType(kind)[0]
            assert len(elements) == count
            assert (gmsh.model.mesh.getElementQualities(elements, "volume") > 0).all(), kind


def test_the_layer_of_prisms(tmp_path):
    mesh = read(DATA / "prismlayer.msh")
    assert (len(mesh.tets), mesh.others.volumes) == (184, {"wedge": 52})
    assert mesh.names == {"layer": (1, 3), "core": (2, 3)}
    assert set(mesh.others.cells["wedge"].tags.tolist()) == {1}
    write(tmp_path / "out.msh", mesh)
    back, given = meshio.read(tmp_path / "out.msh"), meshio.read(DATA / "prismlayer.msh")
    assert len(back.points) == len(given.points)
    for kind in ("tetra", "wedge"):
        one, other = (each.points[each.cells_dict[kind]].mean(axis=1) for each in (back, given))
        assert np.allclose(one, other, rtol=0, atol=1e-15)


def test_a_format_without_such_cells_names_them_and_has_no_stray_points(tmp_path):
    mesh = read(DATA / "prismlayer.msh")
    with pytest.warns(WctWarning, match="TetGen cannot carry, so dropped: 52 wedge cells"):
        write(tmp_path / "a.ele", mesh)
    back = read(tmp_path / "a.ele")
    assert len(back.points) == len(mesh.points)
    assert not back.repairs.orphan_points


def test_shared_points_must_stay():
    mesh = read(DATA / "prismlayer.msh")
    moved = np.array(mesh.points)
    moved[mesh.others.shared.max()] += 1e-9
    with pytest.raises(InputError, match="is shared with 52 wedge cells and has moved; such points must stay"):
        TetMesh(moved, mesh.tets, others=mesh.others)
    with pytest.raises(InputError, match=r"points shared with other cells must lie in 0\.\.80, or be -1"):
        TetMesh(
            mesh.points, mesh.tets, others=OtherCells(mesh.others.points, mesh.others.shared + 50, mesh.others.cells)
        )
    with pytest.raises(InputError, match=r"cell 0 is .*; indices must lie in 0\.\.2"):
        OtherCells(POINTS[:3], np.full(3, -1), {"wedge": Cells(np.array([WEDGE]))})


@pytest.mark.parametrize("suffix", [".vtu", ".vtk"])
def test_voxels_are_hexahedra_beside_tets(suffix: str, tmp_path: Path) -> None:
    """VTK's voxel, type 11, counts its corners row by row."""
    path = tmp_path / f"a{suffix}"
    points = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)] + [[0.2, 0.3, 3]], dtype=float)
    given = meshio.Mesh(points, [("tetra", [[4, 5, 6, 8]]), ("hexahedron", [list(range(8))])])
    meshio.write(path, given, binary=False)
    head, types, tail = path.read_text().partition('Name="types"' if suffix == ".vtu" else "CELL_TYPES")
    path.write_text(head + types + tail.replace("12", "11"))
    (hexahedron,) = read(path).others.cells["hexahedron"].vertices.tolist()
    assert hexahedron == [0, 1, 3, 2, 4, 5, 7, 6]


@pytest.mark.parametrize("kind", ["wedge15", "hexahedron20", "pyramid13", "quad8"])
def test_other_cells_of_second_order_share_mid_nodes_with_tets(kind, tmp_path):
    """A tet with mid nodes on a face of a cell with mid nodes: the file has one node on each edge they share."""
    plain = cell_kinds.base(kind)
    corners = {
        "wedge15": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]],
        "hexahedron20": POINTS[:8].tolist(),
        "pyramid13": [*POINTS[:4].tolist(), [0.5, 0.5, 1]],
        "quad8": POINTS[:4].tolist(),
    }[kind]
    base = {"wedge15": [3, 4, 5], "pyramid13": [0, 1, 4], "hexahedron20": [4, 5, 6], "quad8": [0, 1, 2]}[kind]
    away = np.array([0, -1.5 if kind == "pyramid13" else 0, 1.2])
    tip = np.mean([corners[k] for k in base], axis=0) + away
    points = np.array([*corners, tip], dtype=float)
    edges = [(i, j) for i, j in cell_kinds.EDGES[plain]]
    tet = [*base, len(corners)]
    rims = [*edges, *((tet[i], tet[j]) for i, j in cell_kinds.EDGES["tetra"])]
    ends = list(dict.fromkeys(tuple(sorted(edge)) for edge in rims))
    middle = {edge: len(points) + k for k, edge in enumerate(ends)}
    nodes = np.vstack([points, [points[list(edge)].mean(axis=0) for edge in ends]])
    whole = [*range(len(corners)), *(middle[tuple(sorted(edge))] for edge in edges)]
    ten = [*tet, *(middle[tuple(sorted((tet[i], tet[j])))] for i, j in cell_kinds.EDGES["tetra"])]
    raw = RawMesh(nodes, [RawBlock("tetra10", np.array([ten])), RawBlock(kind, np.array([whole]))])
    mesh = to_mesh(raw, FORMATS[0], [], "")
    assert len(mesh.points) == 4
    write(tmp_path / "a.msh", mesh)
    with gmsh_session():
        gmsh.open(str(tmp_path / "a.msh"))
        assert len(gmsh.model.mesh.getNodes()[0]) == len(nodes)
        number = KINDS[kind][1]
        _, found = gmsh.model.mesh.getElementsByType(number)
        at = gmsh.model.mesh.getElementProperties(number)[4].reshape(-1, 3 if KINDS[kind][0] == 3 else 2)
        ids, xyz, _ = gmsh.model.mesh.getNodes()
        place = dict(zip(ids.tolist(), xyz.reshape(-1, 3), strict=True))
        seen = np.array([place[node] for node in found.tolist()])
        # gmsh's own reference element, corners to ours: every mid node is half way between the same two.
        for k in range(len(corners), len(seen)):
            i, j = next(
                (i, j) for i in range(len(corners)) for j in range(i) if np.allclose(at[k], 0.5 * (at[i] + at[j]))
                and frozenset((i, j)) in {frozenset(edge) for edge in edges}
            )  # fmt: skip
            assert np.allclose(seen[k], 0.5 * (seen[i] + seen[j]), atol=1e-12)
