"""Construction of the meshes: what is refused and how it is said, what is mended and counted, what is left alone."""

from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from support.builders import jittered_cube, kuhn_cube, regular_tet

from wct_plugin.errors import InputError
from wct_plugin.exact import polynomial_signs
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh, faults
from wct_plugin.mesh.repairs import Repairs

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], dtype=float)
TETS = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])  # the second one is positive too


def mesh_with(**changes):
    return TetMesh(**({"points": POINTS, "tets": TETS} | changes))


def facets(rows=((0, 1, 2),), **more):
    return Cells(np.array(rows), **more)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"points": POINTS[:, :2]}, "points have shape (5, 2); allowed is (n, 3)"),
        (
            {"points": np.where(POINTS == 1, np.nan, POINTS)},
            "point 1 is (nan, 0, 0) (and 3 more); coordinates must be finite",
        ),
        ({"points": np.vstack([POINTS[:4], [[0, np.inf, 0]]])}, "point 4 is (0, inf, 0); coordinates must be finite"),
        ({"tets": TETS[:, :3]}, "tets have shape (2, 3); allowed is (m, 4)"),
        ({"tets": TETS.astype(float)}, "tets have dtype float64; allowed are integers"),
        ({"tets": np.empty((0, 4), dtype=int)}, "the mesh has no tetrahedra; at least one is needed"),
        ({"tets": [[0, 1, 2, 5]]}, "tet 0 is (0, 1, 2, 5); indices must lie in 0..4"),
        ({"tets": [[0, 1, 2, 3], [0, 1, 2, -1]]}, "tet 1 is (0, 1, 2, -1); indices must lie in 0..4"),
        ({"tets": [[0, 1, 2, 2]]}, "tet 0 is (0, 1, 2, 2); its four vertices must differ"),
        (
            {"tets": [[0, 1, 2, 3], [1, 2, 3, 4], [3, 2, 1, 0]]},
            "tet 2 repeats tet 0, vertices (0, 1, 2, 3); each may occur once",
        ),
        (
            {"points": np.vstack([POINTS, [[1, 1, 0]]]), "tets": [[0, 1, 2, 3], [0, 1, 2, 5]]},
            "tet 1, vertices (0, 1, 2, 5), has zero volume; it must not",
        ),
        ({"regions": [1, 2, 3]}, "tet tags have shape (3,); allowed is (2,)"),
        ({"regions": [1.0, 2.0]}, "tet tags have dtype float64; allowed are integers"),
        ({"facets": Cells(np.array([[0, 1]]))}, "triangle cells have 2 points each; allowed is 3"),
        ({"edges": facets()}, "edge cells have 3 points each; allowed is 2"),
        ({"nodes": facets()}, "vertex cells have 3 points each; allowed is 1"),
        ({"facets": facets([(0, 1, 7)])}, "triangle 0 is (0, 1, 7); indices must lie in 0..4"),
        ({"point_data": {"T": [1, 2]}}, "point data 'T' has shape (2,); its length must be 5"),
        ({"cell_data": {"q": 1.0}}, "tet data 'q' has shape (); its length must be 2"),
        ({"point_sets": {"a": [0, 5]}}, "point set 'a' must be a list of indices in 0..4"),
        ({"tet_sets": {"a": [[0]]}}, "tet set 'a' must be a list of indices in 0..1"),
        ({"tet_sets": {"a": [0.5]}}, "members of tet set 'a' have dtype float64; allowed are integers"),
    ],
)
def test_refusals_name_what_was_found_and_what_is_allowed(changes, message):
    with pytest.raises(InputError) as caught:
        mesh_with(**changes)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: Cells(np.zeros((1, 0), dtype=int)),
            "tagged cells have shape (1, 0); allowed is (k, number of vertices of each)",
        ),
        (
            lambda: Cells(np.zeros(3, dtype=int)),
            "tagged cells have shape (3,); allowed is (k, number of vertices of each)",
        ),
        (lambda: facets(tags=[1, 2]), "triangle tags have shape (2,); allowed is (1,)"),
        (lambda: facets(data={"x": [1, 2]}), "triangle data 'x' has shape (2,); its length must be 1"),
        (lambda: facets(sets={"s": [1]}), "triangle set 's' must be a list of indices in 0..0"),
        (lambda: SurfaceMesh(POINTS, [[0, 1]]), "triangles have shape (1, 2); allowed is (k, 3)"),
        (
            lambda: SurfaceMesh(POINTS, np.empty((0, 3), dtype=int)),
            "the surface has no triangles; at least one is needed",
        ),
        (lambda: SurfaceMesh(POINTS, [[0, 1, 9]]), "triangle 0 is (0, 1, 9); indices must lie in 0..4"),
        (lambda: SurfaceMesh(POINTS * np.inf, [[0, 1, 2]]), None),
        (lambda: SurfaceMesh(POINTS, [[0, 1, 2]], tags=[1, 2]), "triangle tags have shape (2,); allowed is (1,)"),
        (
            lambda: SurfaceMesh(POINTS, [[0, 1, 2]], point_data={"a": [1]}),
            "point data 'a' has shape (1,); its length must be 5",
        ),
    ],
)
@pytest.mark.filterwarnings("ignore:invalid value")
def test_refusals_of_cells_and_surfaces(make, message):
    with pytest.raises(InputError) as caught:
        make()
    assert message is None or str(caught.value) == message


def test_negative_tets_are_turned_round_and_counted():
    mesh = mesh_with(tets=TETS[:, [0, 2, 1, 3]])
    assert mesh.repairs == Repairs(flipped=2)
    assert mesh.repairs
    assert str(mesh.repairs) == "2 negatively oriented tets turned round"
    assert (np.sort(mesh.tets) == np.sort(TETS)).all()
    corners = mesh.points[mesh.tets]
    assert (np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0).all()
    assert not mesh_with().repairs
    assert str(mesh_with().repairs) == "nothing"


def test_orphans_are_dropped_and_everything_follows():
    points = np.insert(POINTS, [0, 2], 9.0, axis=0)  # orphans 0 and 3; the others are 1, 2, 4, 5, 6
    where = np.array([1, 2, 4, 5, 6])
    mesh = TetMesh(
        points,
        where[TETS],
        facets=Cells(
            np.array([[1, 2, 4], [0, 1, 2], [2, 4, 5]]),
            tags=[7, 8, 9],
            data={"p": [1.0, 2.0, 3.0]},
            sets={"s": [0, 1, 2]},
        ),
        edges=Cells(np.array([[3, 1], [6, 5]]), tags=[4, 5]),
        nodes=Cells(np.array([[0], [6]])),
        point_data={"T": np.arange(7.0), "v": np.arange(21.0).reshape(7, 3)},
        point_sets={"all": np.arange(7), "some": [6, 3, 1]},
    )
    assert mesh.repairs == Repairs(orphan_points=2, stray_cells=3)
    assert "2 points without a tet dropped" in str(mesh.repairs)
    assert "3 tagged cells without a tet dropped" in str(mesh.repairs)
    assert (mesh.points == POINTS).all()
    assert (mesh.tets == TETS).all()
    assert mesh.facets.vertices.tolist() == [[0, 1, 2], [1, 2, 3]]
    assert mesh.facets.tags.tolist() == [7, 9]
    assert mesh.facets.data["p"].tolist() == [1.0, 3.0]
    assert mesh.facets.sets["s"].tolist() == [0, 1]
    assert mesh.edges.vertices.tolist() == [[4, 3]]
    assert mesh.edges.tags.tolist() == [5]
    assert mesh.nodes.vertices.tolist() == [[4]]
    assert mesh.point_data["T"].tolist() == [1, 2, 4, 5, 6]
    assert mesh.point_data["v"].shape == (5, 3)
    assert mesh.point_sets["all"].tolist() == [0, 1, 2, 3, 4]
    assert mesh.point_sets["some"].tolist() == [4, 0]


def test_input_arrays_are_copied_and_the_mesh_is_frozen():
    given = {
        "points": POINTS.copy(),
        "tets": TETS[:, [0, 2, 1, 3]].copy(),
        "regions": np.array([3, 4]),
        "point_data": {"T": np.arange(5.0)},
        "tet_sets": {"a": np.array([1])},
    }
    kept = {"points": POINTS.copy(), "tets": TETS[:, [0, 2, 1, 3]].copy()}
    mesh = TetMesh(**given)
    assert (given["points"] == kept["points"]).all()
    assert (given["tets"] == kept["tets"]).all()
    given["points"][:] = 5.0
    given["regions"][:] = 5
    given["point_data"]["T"][:] = 5.0
    given["tet_sets"]["a"][:] = 0
    assert mesh.points.max() == 1.0
    assert mesh.regions.tolist() == [3, 4]
    assert mesh.point_data["T"].tolist() == [0, 1, 2, 3, 4]
    assert mesh.tet_sets["a"].tolist() == [1]
    for array in (mesh.points, mesh.tets, mesh.regions, mesh.point_data["T"], mesh.tet_sets["a"], mesh.facets.tags):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0
    with pytest.raises(FrozenInstanceError):
        mesh.points = POINTS
    with pytest.raises(TypeError):
        mesh.point_data["new"] = POINTS


def test_array_kinds_are_settled():
    mesh = mesh_with(
        points=POINTS.astype(">f4"),
        tets=np.asfortranarray(TETS.astype(np.uint8)),
        cell_data={"q": np.array([1, 2], ">f8")},
    )
    assert mesh.points.dtype == np.float64
    assert mesh.tets.dtype == np.int64
    assert mesh.tets.flags.c_contiguous
    assert mesh.cell_data["q"].dtype.isnative
    assert mesh.regions.tolist() == [0, 0]


def test_replace_validates_again_and_repairs_add_up():
    mesh = mesh_with(tets=TETS[:, [0, 2, 1, 3]], regions=[1, 2], source="a.vtu", names={"air": (1, 3)})
    other = replace(mesh, points=mesh.points * [1, 1, -1])
    assert other.repairs == Repairs(flipped=4)
    assert other.regions.tolist() == [1, 2]
    assert other.source == "a.vtu"
    assert other.names["air"] == (1, 3)
    assert mesh.repairs == Repairs(flipped=2)
    with pytest.raises(InputError, match="indices must lie in"):
        replace(mesh, points=mesh.points[:4])
    same = replace(mesh, source="b")
    assert same.repairs == mesh.repairs
    assert (same.tets == mesh.tets).all()


def test_replace_does_not_keep_stale_topology():
    mesh = kuhn_cube(1)
    assert len(mesh.topology.boundary) == 12
    fewer = replace(mesh, tets=mesh.tets[:1], regions=mesh.regions[:1])
    assert len(fewer.topology.boundary) == 4


def test_select_keeps_data_and_sets_in_step():
    cells = facets(
        [(0, 1, 2), (1, 2, 3), (2, 3, 4)], tags=[1, 2, 3], data={"x": [5, 6, 7]}, sets={"s": [2, 0], "t": [1]}
    )
    kept = cells.select(np.array([True, False, True]))
    assert len(kept) == 2
    assert kept.tags.tolist() == [1, 3]
    assert kept.data["x"].tolist() == [5, 7]
    assert kept.sets["s"].tolist() == [1, 0]
    assert kept.sets["t"].tolist() == []


def test_diagonal_and_boundary_surface():
    assert kuhn_cube(3).diagonal == pytest.approx(np.sqrt(3.0))
    mesh = jittered_cube(3)
    surface = mesh.boundary_surface()
    assert len(surface.points) == mesh.topology.boundary_points.sum()
    assert surface.diagonal == pytest.approx(np.sqrt(3.0))
    assert (surface.points[surface.triangles] == mesh.points[mesh.topology.boundary]).all()
    stray = SurfaceMesh(np.vstack([surface.points, [[9, 9, 9]]]), surface.triangles)
    assert stray.diagonal == pytest.approx(np.sqrt(3.0))


def test_huge_and_tiny_coordinates_are_fine():
    for size in (1e-200, 1e200):
        mesh = TetMesh(regular_tet().points * size, [[0, 1, 3, 2]])
        assert mesh.repairs.flipped == 1


def test_repeated_tets_are_found_whatever_the_keys_and_chunks(monkeypatch):
    """Keys only say where to look: with ones that hardly differ, in chunks of two, the same tets are found."""
    monkeypatch.setattr(faults, "_CHUNK", 2)
    monkeypatch.setattr(faults, "_MIX", np.ones(4, dtype=np.uint64))
    monkeypatch.setattr(polynomial_signs, "_CHUNK", 2)
    cube = jittered_cube(2, 0)
    turned = cube.tets.copy()
    turned[5] = turned[5, [1, 0, 2, 3]]
    mesh = TetMesh(cube.points, turned)
    assert np.array_equal(np.sort(mesh.tets), np.sort(cube.tets))
    assert mesh.repairs.flipped == 1
    with pytest.raises(InputError, match=r"tet 7 repeats tet 2, vertices"):
        TetMesh(cube.points, np.insert(cube.tets, 7, cube.tets[2, ::-1], axis=0))
    turned[9, 3] = turned[9, 0]
    with pytest.raises(InputError, match=r"tet 9 is .*; its four vertices must differ"):
        TetMesh(cube.points, turned)


def test_other_regions_have_other_interfaces():
    mesh = kuhn_cube(2)
    assert not len(mesh.topology.interfaces)
    halves = mesh.altered(regions=(mesh.points[mesh.tets].mean(axis=1)[:, 0] > 0.5).astype(np.int64))
    assert (mesh.points[halves.topology.interfaces][..., 0] == 0.5).all()
    assert len(halves.topology.interfaces) == 8
    assert halves.altered(points=halves.points + 1.0).topology is halves.topology
