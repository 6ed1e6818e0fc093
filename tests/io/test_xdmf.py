"""XDMF files as dolfinx, dolfin, meshio and others write them."""

from pathlib import Path
from typing import Any

import h5py
import meshio
import numpy as np
import pytest
from support.builders import two_region_cube
from support.volumes import region_volumes

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import read
from wct_plugin.mesh import SurfaceMesh, TetMesh

CUBE = two_region_cube(3)
POINTS = CUBE.points * [1 / 3, 1.1, np.pi]
ENDS = CUBE.topology.boundary[(CUBE.points[CUBE.topology.boundary, 0] == 0).all(axis=1)]
HEAD = '<?xml version="1.0"?>\n<!DOCTYPE Xdmf SYSTEM "Xdmf.dtd" []>\n'


def item(file: h5py.File, path: str, values: Any, kind: str = "") -> str:
    """A data item in HDF5, as dolfinx has it: no precision, and the type of integers only."""
    file[path] = values
    shape = " ".join(map(str, np.shape(values)))
    return f'<DataItem Dimensions="{shape}" {kind} Format="HDF">{Path(file.filename).name}:{path}</DataItem>'


def grid(name: str, inside: str) -> str:
    return f'<Grid Name="{name}" GridType="Uniform">{inside}</Grid>\n'


def topology(file: h5py.File, path: str, kind: str, cells: Any) -> str:
    said = f'TopologyType="{kind}" NumberOfElements="{len(cells)}" NodesPerElement="{cells.shape[1]}"'
    number = 'NumberType="Int"'
    return f"<Topology {said}>{item(file, path, np.asarray(cells, dtype=np.int64), number)}</Topology>"


def mesh_grid(file: h5py.File, extra: str = "", name: str = "mesh") -> str:
    geometry = f'<Geometry GeometryType="XYZ">{item(file, f"/Mesh/{name}/geometry", POINTS)}</Geometry>'
    return grid(name, topology(file, f"/Mesh/{name}/topology", "Tetrahedron", CUBE.tets) + geometry + extra)


def tags_grid(file: h5py.File, name: str, kind: str, cells: Any, tags: Any) -> str:
    """``XDMFFile.write_meshtags`` of dolfinx."""
    values = item(file, f"/MeshTags/{name}/Values", np.asarray(tags, dtype=np.int32).reshape(-1, 1))
    return grid(
        name,
        '<xi:include xpointer="xpointer(/Xdmf/Domain/Grid/Geometry)" />'
        + topology(file, f"/MeshTags/{name}/topology", kind, cells)
        + f'<Attribute Name="{name}" AttributeType="Scalar" Center="Cell">{values}</Attribute>',
    )


def xdmf(path: Path, inside: str, version: str = "3.0") -> None:
    xi = 'xmlns:xi="https://www.w3.org/2001/XInclude"'
    path.write_text(f'{HEAD}<Xdmf Version="{version}" {xi}><Domain>{inside}</Domain></Xdmf>')


WANTED = {tag + 10: share * np.pi * 1.1 / 3 for tag, share in region_volumes(CUBE).items()}


def assert_regions(mesh: Any) -> None:
    assert isinstance(mesh, TetMesh)
    assert region_volumes(mesh) == pytest.approx(WANTED, rel=1e-12)


@pytest.mark.parametrize(
    ("cells", "facets"), [("cell_tags", "facet_tags"), ("Cell tags", "Facet tags"), ("mesh_tags", "f")]
)
@pytest.mark.parametrize("before", [True, False])
def test_dolfinx_tags(cells: str, facets: str, before: bool, tmp_path: Path) -> None:
    """Tags list cells and facets in an order of their own, each cell from another corner on."""
    random = np.random.default_rng(0)
    order = random.permutation(len(CUBE.tets))
    with h5py.File(tmp_path / "mesh.h5", "w") as file:
        on_facets = tags_grid(file, facets, "Triangle", ENDS[::-1], np.arange(len(ENDS))[::-1] % 2 + 5)
        grids = [
            mesh_grid(file),
            tags_grid(file, cells, "Tetrahedron", np.roll(CUBE.tets[order], 1, axis=1), CUBE.regions[order] + 10),
        ]
        grids.insert(0 if before else 2, on_facets)
        if before:
            grids[0] = grids[0].replace("/Xdmf/Domain/Grid/Geometry", "/Xdmf/Domain/Grid[@Name='mesh']/Geometry")
    xdmf(tmp_path / "mesh.xdmf", "".join(grids))
    mesh: Any = read(tmp_path / "mesh.xdmf")
    assert_regions(mesh)
    assert np.array_equal(mesh.regions, CUBE.regions + 10)
    assert {tuple(sorted(face)) for face in mesh.facets.vertices.tolist()} == {tuple(sorted(f)) for f in ENDS.tolist()}
    assert np.array_equal(mesh.facets.tags, np.arange(len(ENDS))[::-1] % 2 + 5)
    assert not mesh.repairs


def test_tags_of_some_cells_only_and_two_grids_of_facets(tmp_path: Path) -> None:
    some = np.flatnonzero(CUBE.regions == CUBE.regions[0])
    with h5py.File(tmp_path / "mesh.h5", "w") as file:
        text = mesh_grid(file) + tags_grid(file, "core", "Tetrahedron", CUBE.tets[some], np.full(len(some), 4))
        text += tags_grid(file, "inlet", "Triangle", ENDS[:4], [1, 1, 2, 2])
        text += tags_grid(file, "walls", "Triangle", ENDS[2:], np.full(len(ENDS) - 2, 9))
    xdmf(tmp_path / "mesh.xdmf", text)
    mesh: Any = read(tmp_path / "mesh.xdmf")
    assert np.array_equal(mesh.regions == 4, CUBE.regions == CUBE.regions[0])
    assert set(mesh.regions.tolist()) == {0, 4}
    assert len(mesh.facets) == len(ENDS)
    assert mesh.facets.tags.tolist() == [1, 1, 2, 2] + [0] * (len(ENDS) - 4)
    assert mesh.facets.data["walls"].tolist() == [0, 0] + [9] * (len(ENDS) - 2)


def test_dolfinx_functions_over_time(tmp_path: Path) -> None:
    """Each function is a series of grids that include mesh and geometry; the last step is taken, and said."""
    with h5py.File(tmp_path / "u.h5", "w") as file:
        text = mesh_grid(file)
        steps = ""
        for step in range(3):
            values = item(file, f"/Function/u/{step}", (POINTS * step).reshape(-1, 3))
            steps += grid(
                "u",
                "<xi:include xpointer=\"xpointer(/Xdmf/Domain/Grid[@GridType='Uniform'][1]"
                '/*[self::Topology or self::Geometry])" />'
                f'<Time Value="{step / 2}" />'
                f'<Attribute Name="u" AttributeType="Vector" Center="Node">{values}</Attribute>',
            )
    xdmf(tmp_path / "u.xdmf", text + f'<Grid Name="u" GridType="Collection" CollectionType="Temporal">{steps}</Grid>')
    with pytest.warns(WctWarning, match=r"u\.xdmf: has 3 steps of 'u'; the last at time 1\.0 is taken$"):
        mesh: Any = read(tmp_path / "u.xdmf")
    assert np.array_equal(mesh.point_data["u"], POINTS * 2)
    assert len(mesh.tets) == len(CUBE.tets)


def test_a_mesh_function_of_dolfin(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "f.h5", "w") as file:
        values = item(
            file, "/MeshFunction/0/values", (CUBE.regions + 10).astype(np.uint64)[:, None], 'NumberType="UInt"'
        )
        extra = f'<Attribute Name="f" AttributeType="Scalar" Center="Cell">{values}</Attribute>'
        xdmf(tmp_path / "f.xdmf", mesh_grid(file, extra))
    mesh: Any = read(tmp_path / "f.xdmf")
    assert np.array_equal(mesh.cell_data.get("f", mesh.regions), CUBE.regions + 10)


def test_a_time_series_of_meshio(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # where meshio puts its .h5
    with meshio.xdmf.TimeSeriesWriter(tmp_path / "t.xdmf") as writer:
        writer.write_points_cells(POINTS, [("tetra", CUBE.tets)])
        for step in range(2):
            writer.write_data(0.5 * step, cell_data={"cell_tags": [CUBE.regions + 9 + step]}, point_data={})
    with pytest.warns(WctWarning, match=r"has 2 steps of .*; the last at time 0\.5 is taken$"):
        assert_regions(read(tmp_path / "t.xdmf"))


def inline(values: Any, kind: str = "Int") -> str:
    array = np.asarray(values)
    numbers = " ".join(map(repr, array.ravel().tolist()))
    return (
        f'<DataItem DataType="{kind}" Precision="8" Dimensions="{" ".join(map(str, array.shape))}">{numbers}</DataItem>'
    )


def test_references_as_in_version_2(tmp_path: Path) -> None:
    count = len(CUBE.tets)
    shared = (
        f'<Topology TopologyType="Tetrahedron" Dimensions="{count}" BaseOffset="1">{inline(CUBE.tets + 1)}</Topology>'
    )
    shared += '<Geometry Type="X_Y_Z">' + "".join(inline(POINTS[:, k], "Float") for k in range(3)) + "</Geometry>"
    steps = "".join(
        grid(
            "step",
            '<Topology Reference="XML">/Xdmf/Domain/Topology[1]</Topology><Geometry Reference="/Xdmf/Domain/Geometry"/>'
            f'<Attribute Name="cell_tags" Center="Cell">{inline(CUBE.regions + 9 + step)}</Attribute>',
        )
        for step in range(2)
    )
    xdmf(tmp_path / "a.xmf", f'{shared}<Grid GridType="Collection" CollectionType="Temporal">{steps}</Grid>', "2.0")
    with pytest.warns(WctWarning, match="has 2 steps of 'a series'; the last is taken$"):
        assert_regions(read(tmp_path / "a.xmf"))


def test_slabs_and_binary_files(tmp_path: Path) -> None:
    stack = np.stack([CUBE.tets, CUBE.tets[::-1]]).astype(">i4")
    (tmp_path / "below").mkdir()
    (tmp_path / "below/cells.bin").write_bytes(bytes(8) + stack.tobytes())
    count = len(CUBE.tets)
    whole = f'<DataItem Format="Binary" DataType="Int" Precision="4" Endian="Big" Seek="8" Dimensions="2 {count} 4">'
    whole += "below/cells.bin</DataItem>"
    part = inline([[1, 0, 0], [1, 1, 1], [1, count, 4]])
    slab = f'<DataItem ItemType="HyperSlab" Dimensions="{count} 4">{part}{whole}</DataItem>'
    cells = f'<Topology TopologyType="Tetrahedron" NumberOfElements="{count}">{slab}</Topology>'
    xdmf(tmp_path / "a.xdmf", grid("a", f"{cells}<Geometry>{inline(POINTS, 'Float')}</Geometry>"))
    mesh: Any = read(tmp_path / "a.xdmf")
    assert np.array_equal(mesh.tets, CUBE.tets[::-1])


def test_a_spatial_collection_is_joined(tmp_path: Path) -> None:
    text = ""
    for tag in np.unique(CUBE.regions).tolist():
        tets = CUBE.tets[CUBE.regions == tag]
        used, places = np.unique(tets, return_inverse=True)
        cells = f'<Topology TopologyType="Tetrahedron">{inline(places.reshape(-1, 4))}</Topology>'
        tags = f'<Attribute Name="cell_tags" Center="Cell">{inline(np.full(len(tets), tag + 10))}</Attribute>'
        text += grid(f"part {tag}", f"{cells}<Geometry>{inline(POINTS[used], 'Float')}</Geometry>{tags}")
    xdmf(tmp_path / "a.xdmf", f'<Grid GridType="Collection" CollectionType="Spatial">{text}</Grid>')
    shared = len(np.intersect1d(*(CUBE.tets[CUBE.regions == tag] for tag in np.unique(CUBE.regions))))
    with pytest.warns(WctWarning, match=f"2 pieces joined, {shared} points that two or more of them have made one$"):
        mesh: Any = read(tmp_path / "a.xdmf")
    assert_regions(mesh)
    assert len(mesh.points) == len(POINTS)


def test_quads_and_other_cells_of_a_mixed_topology(tmp_path: Path) -> None:
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0], [3, 0, 0]]
    mixed = [5, 0, 1, 2, 3, 5, 1, 4, 5, 2, 4, 4, 6, 5, 2, 2, 0, 1, 1, 1, 6]
    cells = f'<Topology TopologyType="Mixed" NumberOfElements="5">{inline(mixed)}</Topology>'
    xdmf(tmp_path / "a.xdmf", grid("a", f"{cells}<Geometry>{inline(np.array(points, float), 'Float')}</Geometry>"))
    with pytest.warns(WctWarning) as caught:
        surface = read(tmp_path / "a.xdmf")
    said = [str(warning.message).partition(".xdmf: ")[2] for warning in caught]
    assert said == ["not read: 1 line cells, 1 vertex cells", "2 quads split into triangles"]
    assert isinstance(surface, SurfaceMesh)
    assert len(surface.triangles) == 5


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("mesh.h5:/Mesh/mesh/geometry", "../mesh.h5:/Mesh/mesh/geometry"), "names the file '../mesh.h5', which"),
        (("mesh.h5:/Mesh/mesh/geometry", "/etc/mesh.h5:/a"), "names the file '/etc/mesh.h5', which lies elsewhere"),
        (("/Mesh/mesh/geometry", "/Mesh/mesh/none"), "names '/Mesh/mesh/none' in mesh.h5, where there is nothing"),
        (("/Mesh/mesh/geometry", "/Mesh/mesh/link"), "names '/Mesh/mesh/link' in mesh.h5, which is kept in another"),
        (("/Xdmf/Domain/Grid/Geometry", "/Xdmf/Domain/Grid[7]/Geometry"), r".*, where there is nothing"),
        (('xpointer="', 'href="other.xdmf" xpointer="'), "includes the file 'other.xdmf'; allowed is what the file"),
        (("Tetrahedron", "3DCoRectMesh"), "has a topology of type '3DCoRectMesh'; allowed are Mixed, polyvertex"),
        (('Format="HDF"', 'Format="SQL"'), "has a DataItem of Format 'SQL'; allowed are HDF, XML and Binary"),
        (('NumberOfElements="', 'NumberOfElements="9'), r"has 162 cells but announces 9162"),
        (('Dimensions="64 3"', 'Dimensions="65 3"'), "has a DataItem of 192 numbers but announces 65 x 3"),
    ],
)  # fmt: skip
def test_refusals(change: tuple[str, str], said: str, tmp_path: Path) -> None:
    folder = tmp_path / "sub"
    folder.mkdir()
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["a"] = POINTS
    with h5py.File(folder / "mesh.h5", "w") as file:
        text = mesh_grid(file) + tags_grid(file, "cell_tags", "Tetrahedron", CUBE.tets, CUBE.regions)
        file["/Mesh/mesh/link"] = h5py.ExternalLink("../other.h5", "/a")
    assert change[0] in text
    xdmf(folder / "a.xdmf", text.replace(*change))
    with pytest.raises(InputError, match=rf"a\.xdmf: cannot be read as XDMF: {said}"):
        read(folder / "a.xdmf")
