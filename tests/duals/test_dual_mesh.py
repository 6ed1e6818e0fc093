"""Voronoi cells cut off at the boundary and at interfaces: closed, plane-faced, of the dual volumes, in order."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Voronoi
from support.builders import bcc, jittered_cube, kuhn_cube, regular_tet, rotation, two_region_cube
from support.polyhedra import area_vector, measured

import wct_plugin as wct
from wct_plugin.duals.dual_mesh import make_dual_mesh
from wct_plugin.duals.fans import find_fans
from wct_plugin.errors import InputError
from wct_plugin.measure import quality
from wct_plugin.measure.duals import compute_duals
from wct_plugin.mesh import TetMesh


def cube():
    """The unit cube of 84 well-centered tets."""
    return wct.apply_filter("create_cube", variant="84")[0]


def layers():
    """Two regions in steps, whose interface has corners and edges."""
    mesh = bcc(3)
    return replace(mesh, regions=5 - 2 * (mesh.points[mesh.tets].mean(axis=1)[:, 0] > 1.4).astype(np.int64))


@pytest.fixture(scope="module")
def two_materials():
    """A unit cube in two halves, as the optimizer makes it completely well-centered."""
    mesh, _ = wct.apply_filter("meshing_well_centered", two_region_cube(2), goal="cwc", seed=1)
    assert quality.measure(mesh).completely_well_centered.all()
    return mesh


def rings(dual):
    return np.split(dual.corners, dual.starts[1:-1])


def check(mesh):
    """All that must hold of any dual mesh, seen from its faces alone."""
    dual = make_dual_mesh(mesh)
    volumes, open_by = measured(dual.points, rings(dual), dual.owner, dual.neighbour)
    size = mesh.diagonal
    assert len(volumes) == len(dual.vertex)
    assert volumes.min() > 0
    assert open_by.max() < 1e-13 * size**2
    assert volumes == pytest.approx(dual.volumes, rel=1e-12)
    each = compute_duals(mesh).volumes
    assert np.bincount(dual.vertex, dual.volumes) == pytest.approx(each, rel=1e-12)
    total = quality.volumes(mesh.points, mesh.tets)
    for tag in np.unique(mesh.regions):
        wanted = total[mesh.regions == tag].sum()
        assert dual.volumes[dual.region == tag].sum() == pytest.approx(wanted, rel=1e-12)
    inner = len(dual.neighbour)
    assert (dual.owner[:inner] < dual.neighbour).all()
    assert (np.diff(dual.owner[:inner]) >= 0).all()
    assert (np.diff(dual.neighbour)[np.diff(dual.owner[:inner]) == 0] >= 0).all()
    assert len(np.unique(dual.corners)) == len(dual.points)
    for ring in rings(dual):
        corners = dual.points[ring]
        area = area_vector(corners)
        assert len(set(ring.tolist())) == len(ring)
        assert np.abs((corners - corners[0]) @ area).max() < 1e-12 * size * np.linalg.norm(area)
    return dual


@pytest.mark.parametrize("make", [regular_tet, cube, lambda: bcc(3), layers], ids=["tet", "cube", "bcc", "layers"])
def test_cells_are_closed_and_have_the_dual_volumes(make):
    check(make())


def test_two_materials_meet_in_faces(two_materials):
    mesh = two_materials
    dual = check(mesh)
    on_interface = np.unique(mesh.topology.interfaces)
    twice = np.flatnonzero(np.bincount(dual.vertex) == 2)
    assert twice.tolist() == on_interface.tolist()
    across = dual.region[dual.owner[: len(dual.neighbour)]] != dual.region[dual.neighbour]
    assert across.sum() == 3 * len(mesh.topology.interfaces)
    area = sum(
        np.linalg.norm(area_vector(dual.points[ring])) for ring in np.array(rings(dual), object)[: len(across)][across]
    )
    assert area == pytest.approx(1.0, rel=1e-12)


def test_every_tet_a_region_of_its_own():
    mesh = bcc(2)
    dual = check(replace(mesh, regions=np.arange(len(mesh.tets))))
    assert len(dual.vertex) == 4 * len(mesh.tets)


def test_inner_cells_are_scipys_voronoi_cells():
    mesh = cube()
    dual = make_dual_mesh(mesh)
    diagram = Voronoi(mesh.points)
    inner = np.flatnonzero(~mesh.topology.boundary_points)
    assert len(inner) > 0
    for vertex in inner:
        hull = ConvexHull(diagram.vertices[diagram.regions[diagram.point_region[vertex]]])
        assert dual.volumes[vertex] == pytest.approx(hull.volume, rel=1e-12)
        assert (dual.owner == vertex).sum() + (dual.neighbour == vertex).sum() == sum(
            vertex in pair for pair in mesh.topology.edges
        )


def test_faces_carry_the_dual_areas():
    mesh = cube()
    dual = make_dual_mesh(mesh)
    areas = compute_duals(mesh).areas
    pairs = {pair: row for row, pair in enumerate(map(tuple, mesh.topology.edges.tolist()))}
    for face, ring in enumerate(rings(dual)[: len(dual.neighbour)]):
        row = pairs[int(dual.owner[face]), int(dual.neighbour[face])]
        area = area_vector(dual.points[ring])
        along = mesh.points[dual.neighbour[face]] - mesh.points[dual.owner[face]]
        assert area @ along / np.linalg.norm(along) == pytest.approx(areas[row], rel=1e-11)


def test_bodies_that_touch_at_an_edge_or_a_point_have_cells_of_their_own():
    """One vertex, one region, two cells: what hangs together only there is no polyhedron."""
    tet = regular_tet()
    for axis in ([0, 1], [0]):
        shared = tet.points[axis].mean(axis=0)
        other = 2.0 * shared - tet.points if len(axis) == 1 else mirrored(tet.points, axis)
        keep = [k for k in range(4) if k not in axis]
        points = np.vstack([tet.points, other[keep]])
        place = np.arange(4)
        place[keep] = 4 + np.arange(len(keep))
        mesh = TetMesh(points, np.array([[0, 1, 2, 3], place]))
        dual = check(mesh)
        assert len(dual.vertex) == 8
        assert np.bincount(dual.vertex)[axis].tolist() == [2] * len(axis)


def mirrored(points, axis):
    """Turned half round the line through two of the points."""
    begin, along = points[axis[0]], points[axis[1]] - points[axis[0]]
    along = along / np.linalg.norm(along)
    offset = points - begin
    return begin + 2.0 * (offset @ along)[:, None] * along - offset


@pytest.mark.parametrize("unit", [1e-60, 1.0, 1e60])
def test_any_unit(unit):
    mesh = cube()
    given = TetMesh(mesh.points @ rotation(3).T * unit, mesh.tets)
    dual, plain = make_dual_mesh(given), make_dual_mesh(mesh)
    assert np.array_equal(dual.corners, plain.corners)
    assert dual.volumes / unit**3 == pytest.approx(plain.volumes, rel=1e-11)
    assert np.linalg.norm(dual.points, axis=1) / unit == pytest.approx(np.linalg.norm(plain.points, axis=1), abs=1e-12)


def test_a_vertex_order_of_any_kind_gives_the_same_cells():
    mesh = cube()
    order = np.random.default_rng(1).permutation(len(mesh.points))
    place = np.argsort(order)
    turned = TetMesh(mesh.points[order], place[mesh.tets][::-1])
    assert check(turned).volumes == pytest.approx(check(mesh).volumes[order], rel=1e-12)


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (
            kuhn_cube(2),
            "48 facets inside whose dual edge is not positive, 48 triangles of the boundary or an interface that are "
            "not acute; goal cwc of meshing_well_centered mends this",
        ),
        (jittered_cube(3), "triangles of the boundary or an interface that are not acute; goal cwc"),
        (
            TetMesh([[0, 0, 0], [1, 0, 0], [0.5, 0.9, 0], [0.5, 0.35, 0.9 / 4]], [[0, 1, 2, 3]], source="a.vtu"),
            r"^a\.vtu: its dual cells are tangled: 1 facets of the boundary or an interface that lie before",
        ),
    ],
)
def test_tangled_cells_are_refused_with_counts(mesh, message):
    with pytest.raises(InputError, match=message):
        make_dual_mesh(mesh)


def test_an_interface_counts_as_a_boundary():
    """Positive across it in sum is not enough where each side has cells of its own."""
    mesh = jittered_cube(3)
    lengths = compute_duals(mesh).lengths[: len(mesh.topology.interior_pairs)]
    assert (lengths > 0).all()
    split = replace(mesh, regions=np.arange(len(mesh.tets)))
    with pytest.raises(
        InputError, match=r"its dual cells are tangled: \d+ facets of the boundary or an interface that lie"
    ):
        make_dual_mesh(split)


def test_overlapping_tets_are_refused():
    tet = regular_tet()
    both = TetMesh(np.vstack([tet.points, tet.points + 0.05]), np.arange(8).reshape(2, 4))
    with pytest.raises(InputError, match="its dual cells are tangled: tets 0 and 1 overlap"):
        make_dual_mesh(both)


def test_fans_are_all_the_wedges_in_order():
    mesh = jittered_cube(3)
    fans = find_fans(mesh)
    assert sorted(fans.wedges.tolist()) == list(range(6 * len(mesh.tets)))
    assert fans.sizes.sum() == len(fans.wedges)
    assert fans.sizes.tolist() == mesh.topology.edge_valence[fans.edges].tolist()
    for part, closed in zip(np.split(fans.wedges // 6, np.cumsum(fans.sizes)[:-1]), fans.closed, strict=True):
        pairs = zip(part, np.roll(part, -1), strict=True)
        joined = [int(after) in mesh.topology.adjacency[before].tolist() for before, after in pairs]
        assert all(joined if closed else joined[:-1])
