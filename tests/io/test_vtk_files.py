"""VTK's files as VTK itself writes them: every encoding, every packing, several pieces, arrays of text."""

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista as pv
from support.builders import two_region_cube
from support.volumes import region_volumes
from vtkmodules.vtkIOParallelXML import vtkXMLPUnstructuredGridWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import read
from wct_plugin.mesh import SurfaceMesh, TetMesh


@pytest.fixture
def grid() -> pv.UnstructuredGrid:
    """A cube of two materials, of many digits, with a tagged end, and arrays of every kind."""
    cube = two_region_cube(3)
    skin = cube.topology.boundary
    end = skin[(cube.points[skin, 0] == 0).all(axis=1)]
    made = pv.UnstructuredGrid({10: cube.tets, 5: end}, cube.points * [1 / 3, 1.1, np.pi])
    made.cell_data["cell_tags"] = np.concatenate([cube.regions + 10, np.full(len(end), 7)]).astype("i4")
    made.cell_data["heat"] = np.sqrt(np.arange(made.n_cells))
    made.point_data["u"] = made.points * 2
    made.point_data["small"] = (np.arange(made.n_points) % 7).astype("u1")
    return made


def same(mesh: Any, grid: pv.UnstructuredGrid) -> None:
    assert isinstance(mesh, TetMesh)
    tets = grid.celltypes == 10
    assert np.array_equal(mesh.points, grid.points)
    assert np.array_equal(mesh.tets, grid.cells_dict[10])
    assert np.array_equal(mesh.facets.vertices, grid.cells_dict[5])
    assert np.array_equal(mesh.regions, grid.cell_data["cell_tags"][tets])
    assert np.array_equal(mesh.facets.tags, grid.cell_data["cell_tags"][~tets])
    assert np.array_equal(mesh.cell_data["heat"], grid.cell_data["heat"][tets])
    assert np.array_equal(mesh.point_data["u"], grid.point_data["u"])
    assert np.array_equal(mesh.point_data["small"], grid.point_data["small"])


MODES = ["ascii", "binary", "base64", "raw"]
PACKED = ["none", "zlib", "lz4", "lzma"]


@pytest.mark.parametrize(("mode", "packed"), [pair for pair in product(MODES, PACKED) if pair != ("ascii", "lz4")])
@pytest.mark.parametrize("bits", [32, 64])
@pytest.mark.parametrize("big", [False, True])
def test_every_encoding(
    mode: str, packed: str, bits: int, big: bool, grid: pv.UnstructuredGrid, tmp_path: Path
) -> None:
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileName(str(tmp_path / "a.vtu"))
    {"ascii": writer.SetDataModeToAscii, "binary": writer.SetDataModeToBinary}.get(mode, writer.SetDataModeToAppended)()
    writer.SetEncodeAppendedData(mode == "base64")
    {"none": writer.SetCompressorTypeToNone, "zlib": writer.SetCompressorTypeToZLib,
     "lz4": writer.SetCompressorTypeToLZ4, "lzma": writer.SetCompressorTypeToLZMA}[packed]()  # fmt: skip
    (writer.SetHeaderTypeToUInt64 if bits == 64 else writer.SetHeaderTypeToUInt32)()
    (writer.SetByteOrderToBigEndian if big else writer.SetByteOrderToLittleEndian)()
    writer.SetBlockSize(1000 // 8 * 8)  # several blocks, the last one shorter
    assert writer.Write()
    same(read(tmp_path / "a.vtu"), grid)


@pytest.mark.parametrize("mode", ["base64", "raw"])
def test_damaged_appended_data_never_escapes(mode: str, grid: pv.UnstructuredGrid, tmp_path: Path) -> None:
    path = tmp_path / "a.vtu"
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileName(str(path))
    writer.SetEncodeAppendedData(mode == "base64")
    writer.SetCompressorTypeToLZ4()
    assert writer.Write()
    data, random = path.read_bytes(), np.random.default_rng(0)
    for at in random.integers(len(data), size=150):
        path.write_bytes(data[:at] + random.bytes(1) + data[at + 1 :])
        try:
            read(path)
        except InputError as error:
            assert str(error).startswith(f"{path}: ")  # noqa: PT017
    for share in np.linspace(0.01, 0.99, 40):
        path.write_bytes(data[: int(share * len(data))])
        with pytest.raises(InputError, match=r"a\.vtu: cannot be read as VTU: "):
            read(path)


def test_arrays_of_text_are_named(grid: pv.UnstructuredGrid, tmp_path: Path) -> None:
    grid.cell_data["label"] = np.array(["a"] * grid.n_cells)
    grid.point_data["node label"] = np.array(["b"] * grid.n_points)
    grid.field_data["author"] = ["me"]
    grid.field_data["time"] = [0.5]
    grid.save(tmp_path / "a.vtu")
    said = "field data 'author', which is text, field data 'time', cell data 'label', which is text, "
    said += "point data 'node label', which is text"
    with pytest.warns(WctWarning, match=rf"a\.vtu: not read: {said}$"):
        mesh = read(tmp_path / "a.vtu")
    same(mesh, grid)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('type="UnstructuredGrid"', 'type="ImageData"'), "holds ImageData; expected a VTKFile of type Unstruct"),
        (("vtkZLibDataCompressor", "vtkZstdDataCompressor"), "is packed by vtkZstdDataCompressor; allowed are vtkZLib"),
        (('<?xml version="1.0"?>', '<!DOCTYPE a [<!ENTITY b "c">]>'), "declares the XML entity 'b'; allowed are"),
        (('NumberOfCells="', 'NumberOfCells="9'), r"has 180 cells but announces 9180"),
        (('NumberOfPoints="', 'NumberOfPoints="9'), r"has points of shape \(64, 3\) but announces 964"),
        (('type="Float64" Name="heat"', 'type="Float99" Name="heat"'), "array 'heat' has the type 'Float99'"),
    ],
)
def test_refusals(change: tuple[str, str], said: str, grid: pv.UnstructuredGrid, tmp_path: Path) -> None:
    path = tmp_path / "a.vtu"
    grid.save(path, binary=False)
    text = path.read_text()
    assert change[0] in text
    path.write_text(text.replace(*change))
    with pytest.raises(InputError, match=rf"a\.vtu: cannot be read as VTU: {said}"):
        read(path)


def cut(grid: pv.UnstructuredGrid, count: int) -> list[pv.UnstructuredGrid]:
    """Pieces along x, in the order of the cells, with what shows whether arrays follow their cells."""
    middle = grid.cell_centers().points[:, 0]
    slab = np.minimum((middle / grid.points[:, 0].max() * count).astype(int), count - 1)
    return [
        grid.extract_cells(np.flatnonzero(slab == k), pass_cell_ids=False, pass_point_ids=False) for k in range(count)
    ]


def test_a_vtu_of_several_pieces_is_joined(grid: pv.UnstructuredGrid, tmp_path: Path) -> None:
    parts = cut(grid, 3)
    texts = []
    for k, part in enumerate(parts):
        part.save(tmp_path / f"{k}.vtu", binary=False)
        texts.append((tmp_path / f"{k}.vtu").read_text())
    head, _, _ = texts[0].partition("<Piece")
    pieces = ["<Piece" + text.partition("<Piece")[2].partition("</Piece>")[0] + "</Piece>" for text in texts]
    tail = texts[0].partition("</Piece>")[2]
    (tmp_path / "a.vtu").write_text(head + "".join(pieces) + tail)
    with pytest.warns(WctWarning, match=r"3 pieces joined, 32 points that two or more of them have made one$"):
        mesh = read(tmp_path / "a.vtu")
    joined_equals(mesh, grid)


def joined_equals(mesh: Any, grid: pv.UnstructuredGrid) -> None:
    """The same cells by their places, with the same tags and values, and no point twice."""
    assert isinstance(mesh, TetMesh)
    assert len(mesh.points) == grid.n_points
    tets = grid.celltypes == 10

    def table(points: Any, cells: Any, *columns: Any) -> Any:
        rows = np.column_stack([points[cells].mean(axis=1), *columns])
        return rows[np.lexsort(np.round(rows, 9).T)]

    wanted = table(grid.points, grid.cells_dict[10], grid.cell_data["cell_tags"][tets], grid.cell_data["heat"][tets])
    assert np.allclose(table(mesh.points, mesh.tets, mesh.regions, mesh.cell_data["heat"]), wanted, rtol=0, atol=1e-15)
    assert np.array_equal(mesh.point_data["u"], mesh.points * 2)
    whole = pv.UnstructuredGrid({10: grid.cells_dict[10]}, grid.points)
    assert sum(region_volumes(mesh).values()) == pytest.approx(whole.volume, rel=1e-12)
    assert len(mesh.facets) == (~tets).sum()
    assert set(mesh.facets.tags.tolist()) == {7}


@pytest.mark.parametrize("numbered", [True, False])
@pytest.mark.parametrize("levels", [0, 1])
def test_pvtu_as_vtk_writes_it(numbered: bool, levels: int, grid: pv.UnstructuredGrid, tmp_path: Path) -> None:
    """Pieces in a folder below, with a layer of ghost cells or none."""
    if numbered:
        grid.point_data["GlobalPointIds"] = np.arange(grid.n_points)
        grid.GetPointData().SetActiveGlobalIds("GlobalPointIds")
    middle = grid.cell_centers().points[:, 0]
    half = grid.points[:, 0].max() / 2
    pieces, owned = [], []
    for below in (True, False):
        own = (middle < half) == below
        corners = np.unique(np.concatenate([grid.get_cell(k).point_ids for k in np.flatnonzero(own)]))
        owned.append(corners)
        touches = np.array([np.isin(grid.get_cell(k).point_ids, corners).any() for k in range(grid.n_cells)])
        taken = np.flatnonzero(own | touches if levels else own)
        piece = grid.extract_cells(taken, pass_cell_ids=False, pass_point_ids=False)
        if levels:
            piece.cell_data["vtkGhostType"] = (~own[taken]).astype("u1")
        pieces.append(piece)
    (tmp_path / "part").mkdir()
    for k, piece in enumerate(pieces):
        piece.save(tmp_path / f"part/part_{k}.vtu")
    writer = vtkXMLPUnstructuredGridWriter()
    writer.SetFileName(str(tmp_path / "summary.pvtu"))
    writer.SetInputData(pieces[0])
    writer.SetNumberOfPieces(2)
    writer.SetStartPiece(0)
    writer.SetEndPiece(0)
    writer.SetWriteSummaryFile(1)
    writer.Write()
    text = (tmp_path / "summary.pvtu").read_text()
    head, tail = text.partition("<Piece")[0], "</PUnstructuredGrid>\n</VTKFile>\n"
    sources = "".join(f'<Piece Source="part/part_{k}.vtu"/>\n' for k in range(2))
    (tmp_path / "whole.pvtu").write_text(head + sources + tail)
    with pytest.warns(WctWarning) as caught:
        mesh = read(tmp_path / "whole.pvtu")
    said = " ".join(str(warning.message) for warning in caught)
    shared = len(np.intersect1d(*owned))
    assert f"2 pieces joined, {shared} points that two or more of them have made one" in said
    assert ("ghost cells dropped" in said) == bool(levels)
    joined_equals(mesh, grid)
    assert pv.read(tmp_path / "whole.pvtu").n_cells == sum(piece.n_cells for piece in pieces)


def test_points_that_pieces_do_not_share_stay_apart(tmp_path: Path) -> None:
    """Two tets glued at a corner in the file's pieces, and a crack within a piece: neither is closed."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [0, 0, 0]])
    crack = pv.UnstructuredGrid({10: np.array([[0, 1, 2, 3], [5, 1, 2, 4]])}, points)
    other = pv.UnstructuredGrid(
        {10: np.array([[0, 1, 2, 3]])}, np.array([[0.0, 0, 0], [-1, 0, 0], [0, -1, 0], [0, 0, -1]])
    )
    crack.save(tmp_path / "0.vtu")
    other.save(tmp_path / "1.vtu")
    (tmp_path / "a.pvtu").write_text(
        '<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid GhostLevel="0">'
        '<Piece Source="0.vtu"/><Piece Source="1.vtu"/></PUnstructuredGrid></VTKFile>'
    )
    with pytest.warns(WctWarning, match="2 pieces joined, 0 points"):
        mesh = read(tmp_path / "a.pvtu")
    assert len(mesh.points) == 10


@pytest.mark.parametrize("name", ["../other.vtu", "/etc/passwd", "sub/../../other.vtu", "missing.vtu"])
def test_pvtu_opens_nothing_elsewhere(name: str, tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "other.vtu").write_text("secret")
    (tmp_path / "sub/a.pvtu").write_text(
        f'<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid><Piece Source="{name}"/></PUnstructuredGrid></VTKFile>'
    )
    said = (
        "there is no such file" if name == "missing.vtu" else "which lies elsewhere; allowed are files beside or below"
    )
    with pytest.raises(InputError, match=rf"a\.pvtu: cannot be read as PVTU: names the file '{name}', .*{said}"):
        read(tmp_path / "sub/a.pvtu")


def test_polydata_of_triangles_strips_quads_and_lines(tmp_path: Path) -> None:
    quads = pv.Plane(i_resolution=2, j_resolution=2).translate((0, 0, 1))
    below = [[x, y, 0.0] for x in range(4) for y in range(2)]
    points = np.vstack([below, quads.points])
    shift = np.array([0, 8, 8, 8, 8])
    whole = pv.PolyData(points, strips=[8, *range(8)], faces=(quads.faces.reshape(-1, 5) + shift).ravel())
    whole.cell_data["id"] = np.arange(whole.n_cells)
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(whole)
    writer.SetFileName(str(tmp_path / "a.vtp"))
    writer.Write()
    with pytest.warns(WctWarning, match=r"a\.vtp: 4 quads split into triangles$"):
        surface = read(tmp_path / "a.vtp")
    assert isinstance(surface, SurfaceMesh)
    assert len(surface.triangles) == 14
    a, b, c = np.moveaxis(surface.points[surface.triangles], 1, 0)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(4, rel=1e-6)
    ids = surface.cell_data["id"]
    assert np.array_equal(np.bincount(ids), [2, 2, 2, 2, 6])
    assert np.array_equal(ids == 4, a[:, 2] == 0)  # the strip
    judge = pv.read(tmp_path / "a.vtp").triangulate()
    assert np.array_equal(np.sort(judge.cell_data["id"]), np.sort(ids))
