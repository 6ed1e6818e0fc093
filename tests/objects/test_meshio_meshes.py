"""``meshio.Mesh`` there and back, and as meshio's own readers and writers have it."""

import meshio
import numpy as np
import pytest
from support.builders import two_region_cube
from support.comparing import assert_same

import wct_plugin as wct
from wct_plugin.errors import WctWarning
from wct_plugin.measure import quality
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh


def test_a_mesh_with_everything_there_and_back(full: TetMesh) -> None:
    made = wct.to_meshio(full)
    assert [(block.type, len(block)) for block in made.cells] == [
        ("tetra", len(full.tets)),
        ("triangle", len(full.facets)),
        ("line", len(full.edges)),
        ("vertex", len(full.nodes)),
    ]
    assert made.cell_data["gmsh:physical"][0].tolist() == full.regions.tolist()
    assert made.cell_sets["inlet"][1].tolist() == [1, 4, 5]
    assert np.isnan(made.cell_data["flux"][0]).all()
    assert_same(wct.as_mesh(made), full)


def test_tags_of_another_name_stay_there(full: TetMesh) -> None:
    named = TetMesh(full.points, full.tets, full.regions, names={"steel": (3, 3)}, tag_name="medit:ref")
    made = wct.to_meshio(named)
    assert list(made.cell_data) == ["medit:ref"]
    again = wct.as_mesh(made)
    assert_same(again, named)
    assert again.tag_name == "medit:ref"


def test_a_surface_there_and_back(surface: SurfaceMesh) -> None:
    assert_same(wct.as_mesh(wct.to_meshio(surface)), surface)


def test_what_meshio_reads_is_what_we_read(full: TetMesh, tmp_path) -> None:
    """A gmsh file by its reader: physical groups with names."""
    bare = TetMesh(
        full.points, full.tets, full.regions, Cells(full.facets.vertices, full.facets.tags), names=full.names
    )
    wct.write(tmp_path / "part.msh", bare)
    assert_same(wct.as_mesh(meshio.read(tmp_path / "part.msh")), bare)
    assert_same(wct.as_mesh(meshio.read(tmp_path / "part.msh")), wct.read(tmp_path / "part.msh"))


def test_what_meshio_writes_has_the_same_volumes(tmp_path) -> None:
    mesh = two_region_cube(2)
    wct.to_meshio(mesh).write(tmp_path / "part.vtu")
    read = meshio.read(tmp_path / "part.vtu")
    for tag in (1, 2):
        tets = read.cells_dict["tetra"][read.cell_data["gmsh:physical"][0] == tag]
        assert quality.volumes(read.points, tets).sum() == pytest.approx(0.5, rel=1e-12)


def test_blocks_in_any_order_and_a_set_of_one_name_on_two_kinds(full: TetMesh) -> None:
    tets, facets = full.tets, full.facets.vertices
    sets = {"wall": [np.array([0]), np.array([2]), np.array([1])]}
    given = meshio.Mesh(full.points, [("tetra", tets[:5]), ("triangle", facets), ("tetra", tets[5:])], cell_sets=sets)
    mesh = wct.as_mesh(given)
    assert np.array_equal(mesh.tets, tets)
    assert mesh.tet_sets["wall"].tolist() == [0, 6]
    assert mesh.facets.sets["wall"].tolist() == [2]
    again = wct.to_meshio(mesh)
    assert [one.tolist() for one in again.cell_sets["wall"]] == [[0, 6], [2]]


def test_the_object_is_left_as_it_is_and_shares_nothing(full: TetMesh) -> None:
    made = wct.to_meshio(full)
    mesh = wct.as_mesh(made)
    made.points[:] = 0.0
    made.cells[0].data[:] = 0
    assert_same(mesh, full)


def test_arrays_of_two_widths_are_named(full: TetMesh) -> None:
    facets = Cells(full.facets.vertices, data={"uv": np.zeros((len(full.facets), 3))})
    mesh = TetMesh(full.points, full.tets, facets=facets, cell_data={"uv": np.zeros((len(full.tets), 2))})
    with pytest.warns(WctWarning, match=r"meshio.Mesh cannot carry, so dropped: cell data 'uv', of other widths"):
        assert wct.to_meshio(mesh).cell_data == {}
