"""Patches, creases, corners on shapes whose features are known; distances against closed forms and brute force."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from support.builders import (
    ball,
    cylinder,
    interleaved_ball,
    jittered_cube,
    kuhn_cube,
    l_shape,
    rotation,
    single,
    sphere_surface,
    square,
    two_region_cube,
)

from wct_plugin.measure.deviation import distances, measure_deviation
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh
from wct_plugin.mesh.strata import PLACES, find_strata, places_of, surface_strata
from wct_plugin.mesh.triangle_surfaces import enclosed_volume, surface_edges, turned_triangles


def summary(found):
    """Patches, curves, and points per stratum."""
    return (
        found.patch.max() + 1,
        found.curve.max(initial=-1) + 1,
        np.bincount(found.stratum, minlength=4).tolist(),
    )


def turned(mesh, seed):
    return TetMesh(
        mesh.points @ rotation(seed).T + seed,
        mesh.tets,
        mesh.regions,
        facets=mesh.facets,
        edges=mesh.edges,
        nodes=mesh.nodes,
    )


@pytest.mark.parametrize("seed", [None, 1, 2])
@pytest.mark.parametrize(
    ("mesh", "patches", "curves", "points"),
    [
        (kuhn_cube(3), 6, 12, [8, 24, 24, 8]),
        (jittered_cube(4), 6, 12, [27, 54, 36, 8]),
        (l_shape(2), 8, 18, [5, 20, 26, 12]),
        (ball(5), 1, 0, None),
        (two_region_cube(2), 11, 20, [0, 3, 12, 12]),
        (cylinder(24, 4), 3, 2, [3, 74, 48, 0]),
    ],
    ids=["cube", "jittered", "l", "ball", "regions", "cylinder"],
)
def test_known_shapes(mesh, patches, curves, points, seed):
    found = find_strata(mesh if seed is None else turned(mesh, seed))
    got_patches, got_curves, got_points = summary(found)
    assert (got_patches, got_curves) == (patches, curves)
    if points is not None:
        assert got_points == points
    assert len(found.triangles) == len(mesh.topology.boundary) + len(mesh.topology.interfaces)
    assert (found.triangles[: len(mesh.topology.boundary)] == mesh.topology.boundary).all()


def test_labels_and_places_of_a_cube():
    mesh = kuhn_cube(4)
    found = find_strata(mesh)
    on = ((mesh.points == 0) | (mesh.points == 1)).sum(axis=1)
    assert (found.stratum == on).all()  # a point's number of faces is its stratum here
    assert (found.label[found.stratum == 0] == -1).all()
    assert (found.label[found.stratum == 3] == -1).all()
    for triangle, patch in zip(found.triangles, found.patch, strict=True):
        free = found.stratum[triangle] == 1
        assert (found.label[triangle[free]] == patch).all()
    for segment, curve in zip(found.segments, found.curve, strict=True):
        free = found.stratum[segment] == 2
        assert (found.label[segment[free]] == curve).all()
    assert (np.bincount(found.curve) == 4).all()
    assert (np.bincount(found.patch) == 32).all()
    places = places_of(mesh, found)
    assert (places == on[mesh.tets].max(axis=1)).all()
    assert len(PLACES) == 4
    for array in (found.triangles, found.segments, found.patch, found.curve, found.soft, found.stratum, found.label):
        assert not array.flags.writeable


def test_crease_angle_decides():
    mesh = cylinder(12)  # sides bend by 30 degrees
    assert summary(find_strata(mesh))[:2] == (3, 2)
    assert find_strata(mesh, crease_angle=29.0).patch.max() + 1 == 14
    assert find_strata(mesh, crease_angle=91.0).patch.max() == 0


def test_creases_by_their_angle_alone_are_soft():
    mesh = kuhn_cube(4)
    top = mesh.topology.boundary[on_face(mesh, 2, 1.0)]
    half = mesh.points[top].mean(axis=1)[:, 0] < 0.5
    plain, cut = find_strata(mesh), find_strata(tagged(mesh, top[half], np.ones(half.sum(), dtype=int)))
    assert plain.soft.all()
    assert plain.soft_curves.tolist() == list(range(12))
    ends = mesh.points[cut.segments]
    around = ((ends[:, :, 2] == 1.0) & (ends[:, :, 0] <= 0.5)).all(axis=1)
    assert np.array_equal(cut.soft, ~around)
    assert np.array_equal(cut.soft_curves, np.setdiff1d(cut.curve, cut.curve[around]))
    edge = plain.segments[:1]
    named = find_strata(TetMesh(mesh.points, mesh.tets, edges=Cells(edge)))
    assert np.array_equal(named.segments[~named.soft], edge)
    boxes = two_region_cube(4)
    found = find_strata(boxes)
    interface = (boxes.points[found.segments][:, :, 2] == 0.5).all(axis=1)
    assert np.array_equal(found.soft, ~interface)


def test_closed_loops_without_corners_are_curves():
    found = find_strata(cylinder(16, 3))
    assert (found.stratum != 3).all()
    assert np.bincount(found.curve).tolist() == [16, 16]
    # A ring of 7 turns by 51 degrees at each vertex: all corners.
    coarse = find_strata(cylinder(7, 3), crease_angle=60.0)
    assert (coarse.stratum == 3).sum() == 14
    assert coarse.curve.max() + 1 == 14


def on_face(mesh, axis, value):
    centers = mesh.points[mesh.topology.boundary].mean(axis=1)
    return np.isclose(centers[:, axis], value)


def tagged(mesh, cells, tags, **more):
    return TetMesh(mesh.points, mesh.tets, mesh.regions, facets=Cells(cells, tags, **more))


def test_a_change_of_facet_tag_is_a_crease():
    mesh = kuhn_cube(4)
    top = mesh.topology.boundary[on_face(mesh, 2, 1.0)]
    half = mesh.points[top].mean(axis=1)[:, 0] < 0.5
    for tags in (np.where(half, 1, 2), np.where(half, 5, 0)):
        found = find_strata(tagged(mesh, top[:, ::-1], tags))
        assert summary(found) == (7, 15, [27, 51, 37, 10])
    only_half = find_strata(tagged(mesh, top[half], np.ones(half.sum(), dtype=int)))
    assert summary(only_half) == (7, 15, [27, 51, 37, 10])
    by_set = find_strata(tagged(mesh, top, np.ones(len(top), dtype=int), sets={"inlet": np.flatnonzero(half)}))
    assert summary(by_set) == (7, 15, [27, 51, 37, 10])
    same = find_strata(tagged(mesh, top, np.ones(len(top), dtype=int)))
    assert summary(same) == (6, 12, [27, 54, 36, 8])


def test_a_facet_may_have_two_tags():
    mesh = kuhn_cube(2)
    top = mesh.topology.boundary[on_face(mesh, 2, 1.0)]
    half = mesh.points[top].mean(axis=1)[:, 0] < 0.5
    twice = np.concatenate([top, top[half]])
    tags = np.concatenate([np.ones(len(top), dtype=int), np.full(half.sum(), 2)])
    assert summary(find_strata(tagged(mesh, twice, tags)))[0] == 7


def middle_facets(mesh):
    """Interior facets in the plane x = 1/2."""
    pairs = mesh.topology.interior_pairs
    from wct_plugin.mesh.topology import FACETS

    cells = mesh.tets[pairs[:, :1], FACETS[pairs[:, 1]]]
    return cells[(mesh.points[cells][..., 0] == 0.5).all(axis=1)]


def test_tagged_facets_inside_a_region_are_a_surface():
    mesh = kuhn_cube(4)
    inner = middle_facets(mesh)
    assert len(inner) == 32
    found = find_strata(tagged(mesh, inner, np.full(32, 3)))
    assert len(found.triangles) == 192 + 32
    assert {frozenset(t) for t in found.triangles[192:].tolist()} == {frozenset(t) for t in inner.tolist()}
    # Four sides of the cube are cut in two by it, like by an interface.
    assert summary(found) == (11, 20, [18, 51, 44, 12])
    half = inner[mesh.points[inner].mean(axis=1)[:, 1] < 0.5]
    open_sheet = find_strata(tagged(mesh, half, np.full(16, 3)))  # its free rim is a crease too
    assert open_sheet.patch.max() + 1 == 8  # it cuts one side in two, and slits two more
    inside = (open_sheet.stratum == 2) & (np.abs(mesh.points - 0.5) < 0.5).all(axis=1)
    assert (mesh.points[inside][:, :2] == 0.5).all()
    assert inside.sum() == 3


def test_interfaces_are_tagged_facets_only_once():
    mesh = two_region_cube(4)
    cells = mesh.topology.interfaces
    found = find_strata(tagged(mesh, cells, np.full(len(cells), 9)))
    assert len(found.triangles) == 192 + len(cells)
    assert summary(found) == summary(find_strata(mesh))


def test_facets_that_are_not_in_the_mesh_are_ignored():
    mesh = kuhn_cube(2)
    far = np.array([[0, 13, 25]])
    assert summary(find_strata(tagged(mesh, far, [4]))) == summary(find_strata(mesh))


def test_three_regions_meet_in_a_crease():
    mesh = kuhn_cube(4)
    centers = mesh.points[mesh.tets].mean(axis=1)
    regions = np.where(centers[:, 2] > 0.5, 0, 1 + (centers[:, 0] > 0.5))
    found = find_strata(TetMesh(mesh.points, mesh.tets, regions))
    axis = (mesh.points[:, 0] == 0.5) & (mesh.points[:, 2] == 0.5)
    assert (found.stratum[axis & (mesh.points[:, 1] % 1 > 0)] == 2).all()
    assert (found.stratum[axis & (mesh.points[:, 1] % 1 == 0)] == 3).all()


def point_at(mesh, *where):
    return int(np.flatnonzero((mesh.points == where).all(axis=1))[0])


def test_tagged_edges_and_vertices():
    mesh = kuhn_cube(4)
    line = [point_at(mesh, x / 4, 0.5, 1.0) for x in range(1, 4)]
    wire = [point_at(mesh, 0.5, 0.5, z / 4) for z in range(1, 4)]
    edges = np.array([line[:2], line[1:], wire[:2], wire[1:], wire[:2][::-1]])
    centre = point_at(mesh, 0.25, 0.25, 0.25)
    found = find_strata(
        TetMesh(mesh.points, mesh.tets, edges=Cells(edges, [1, 1, 2, 2, 2]), nodes=Cells(np.array([[centre]])))
    )
    assert found.stratum[line].tolist() == [3, 2, 3]  # on the surface: not pruned, though short and dangling
    assert found.stratum[wire].tolist() == [3, 2, 3]  # inside
    assert found.stratum[centre] == 3
    assert len(found.segments) == 48 + 4
    assert found.curve.max() + 1 == 12 + 2
    changed = find_strata(TetMesh(mesh.points, mesh.tets, edges=Cells(edges, [1, 2, 3, 3, 3])))
    assert changed.stratum[line].tolist() == [3, 3, 3]
    ghost = find_strata(TetMesh(mesh.points, mesh.tets, edges=Cells(np.array([[0, len(mesh.points) - 1]]))))
    assert summary(ghost) == summary(find_strata(mesh))


def test_short_dangling_creases_are_pruned_long_ones_stay():
    mesh = kuhn_cube(12)
    flat = find_strata(mesh)
    for raised, stays in ((2, False), (4, False), (7, True)):
        ridge = [point_at(mesh, 0.5, y / 12, 1.0) for y in range(3, 3 + raised)]
        points = mesh.points.copy()
        points[ridge, 2] += 0.08  # bends by 88 degrees along the ridge, by less than 60 around it
        bent = find_strata(TetMesh(points, mesh.tets), crease_angle=60.0)
        assert (bent.stratum[ridge] >= 2).all() == stays
        assert stays or (bent.stratum == flat.stratum).all()
        # The same ridge with its edges tagged stays, however short.
        edges = np.column_stack([ridge[:-1], ridge[1:]])
        kept = find_strata(TetMesh(points, mesh.tets, edges=Cells(edges)), crease_angle=60.0)
        assert (kept.stratum[ridge] >= 2).all()


@pytest.mark.parametrize(("sides", "stays"), [(3, False), (5, False), (9, True)])
def test_a_rim_round_a_few_triangles_is_noise_round_more_it_is_a_crease(sides, stays):
    """A cone cut off at the top, where a polygon of sides - 2 triangles bends by 45 degrees all round."""
    rings = [(0.1, sides, 1.0), (1.1, 36, 0.0)]
    turns = [2.0 * np.pi * np.arange(n) / n for _, n, _ in rings]
    points = np.concatenate(
        [
            np.column_stack([r * np.cos(turn), r * np.sin(turn), np.full(n, z)])
            for (r, n, z), turn in zip(rings, turns, strict=True)
        ]
    )
    found = surface_strata(SurfaceMesh(points, ConvexHull(points).simplices), crease_angle=30.0)
    assert found.patch.max() + 1 == 2 + stays
    assert (found.stratum[:sides] == 1 + stays).all()
    assert (found.stratum[sides:] == 2).all()


def test_pinched_vertices_are_corners():
    """Two tets that share one vertex: smooth or not, it can not move."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]], dtype=float)
    mesh = TetMesh(points, [[0, 1, 2, 3], [0, 4, 5, 6]])
    assert find_strata(mesh, crease_angle=180.0).stratum.tolist() == [3, 1, 1, 1, 1, 1, 1]


def test_edge_where_two_bodies_touch_is_a_crease():
    points = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 0]], dtype=float)
    found = find_strata(TetMesh(points, [[0, 1, 2, 3], [0, 1, 4, 5]]), crease_angle=180.0)
    assert found.segments.tolist() == [[0, 1]]
    assert found.stratum.tolist() == [3, 3, 1, 1, 1, 1]


def test_strata_of_a_single_tet():
    found = find_strata(single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]))
    assert summary(found) == (4, 6, [0, 0, 0, 4])


def test_enclosed_volume():
    for mesh in (kuhn_cube(2), l_shape(1), ball(4)):
        tets = mesh.points[mesh.tets]
        total = np.linalg.det(tets[:, 1:] - tets[:, :1]).sum() / 6.0
        boundary = mesh.topology.boundary
        assert enclosed_volume(mesh.points, boundary) == pytest.approx(total)
        assert enclosed_volume(mesh.points + 1e6, boundary) == pytest.approx(total, rel=1e-8)
        assert enclosed_volume(mesh.points, boundary[:, ::-1]) == pytest.approx(-total)


def test_shifted_planes():
    found = measure_deviation(square(), square(0.25, n=7))
    assert found.max_ab == pytest.approx(0.25)
    assert found.max_ba == pytest.approx(0.25)
    assert found.max == pytest.approx(0.25)
    assert measure_deviation(square(), square(), 0.1).max == pytest.approx(0.0, abs=1e-15)


def test_directions_differ():
    small, large = square(size=1.0), square(size=2.0, n=3)
    found = measure_deviation(small, large)
    assert found.max_ab == pytest.approx(0.0, abs=1e-15)
    assert found.max_ba == pytest.approx(np.sqrt(2.0))
    assert found.at_ba == (2.0, 2.0, 0.0)


def test_samples_inside_triangles_see_what_vertices_miss():
    """A big triangle over a dent: all its vertices are on the other surface."""
    dent = square(n=8)
    points = dent.points.copy()
    middle = int(np.flatnonzero((points == [0.5, 0.5, 0.0]).all(axis=1))[0])
    points[middle, 2] = -0.2
    dented = SurfaceMesh(points, dent.triangles)
    found = measure_deviation(square(), dented, spacing=0.05)
    assert found.max_ba == pytest.approx(0.2)
    nearest = distances(np.array([[0.5, 0.5, 0.0]]), dented)[0]
    assert nearest - found.error_ab <= found.max_ab <= 0.2
    assert found.max_ab > 0.05
    assert found.error_ab == pytest.approx(0.05 / np.sqrt(3.0))


@pytest.mark.parametrize("radius", [1.001, 1.1, 2.0])
def test_concentric_spheres(radius):
    a, b = sphere_surface(800), sphere_surface(1000, radius)
    found = measure_deviation(a, b, spacing=0.1 * radius)
    sag = 0.006  # of these facets, for radius 1
    assert radius - 1.0 - sag * radius <= found.max_ab <= radius - 1.0 + 2 * sag
    assert radius - 1.0 <= found.max_ba + 1e-12 <= radius - 1.0 + sag * radius + 1e-9


def test_distances_equal_brute_force_on_uneven_triangles():
    """Long thin triangles beside tiny ones: the nearest center says little about the nearest triangle."""
    rng = np.random.default_rng(2)
    fan = np.column_stack([np.cos(np.linspace(0, 1, 30)) * 10, np.sin(np.linspace(0, 1, 30)) * 10, np.zeros(30)])
    points = np.vstack([[[0, 0, 0]], fan, rng.normal(size=(60, 3)) * 0.05 + [5, 0, 1], [[3, 3, 3]]])
    triangles = [[0, k, k + 1] for k in range(1, 30)] + [[31 + 3 * k, 32 + 3 * k, 33 + 3 * k] for k in range(20)]
    triangles += [[91, 91, 91], [0, 0, 91]]  # degenerate: a point and a segment
    surface = SurfaceMesh(points, triangles)
    queries = rng.uniform(-2, 12, (400, 3)) * [1, 1, 0.2]
    assert np.allclose(distances(queries, surface), brute_force(queries, surface), rtol=1e-12, atol=1e-12)


def brute_force(queries, surface):
    """Nearest of a triangle's plane, edges and vertices, one by one."""
    best = np.full(len(queries), np.inf)
    for triangle in surface.points[surface.triangles]:
        for k in range(3):
            p, along = triangle[k], triangle[(k + 1) % 3] - triangle[k]
            t = np.clip((queries - p) @ along / max(along @ along, 1e-300), 0, 1)
            best = np.minimum(best, np.linalg.norm(queries - p - t[:, None] * along, axis=1))
        frame = np.column_stack([triangle[1] - triangle[0], triangle[2] - triangle[0]])
        if np.linalg.matrix_rank(frame) == 2:
            weights = np.linalg.lstsq(frame, (queries - triangle[0]).T, rcond=None)[0]
            foot = triangle[0] + (frame @ weights).T
            inside = (weights >= 0).all(axis=0) & (weights.sum(axis=0) <= 1)
            best = np.where(inside, np.minimum(best, np.linalg.norm(queries - foot, axis=1)), best)
    return best


def test_one_triangle_and_one_point():
    single_triangle = SurfaceMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert distances(np.array([[0.2, 0.2, 3.0], [-3.0, 0, 0], [1, 1, 0]]), single_triangle) == pytest.approx(
        [3.0, 3.0, np.sqrt(0.5)]
    )
    dot = SurfaceMesh([[1.0, 2.0, 3.0]], [[0, 0, 0]])
    assert distances(np.zeros((1, 3)), dot) == pytest.approx([np.sqrt(14.0)])
    assert measure_deviation(dot, dot).max == 0.0


def test_spacing_must_be_positive():
    with pytest.raises(ValueError, match=r"^spacing is 0\.0; it must be positive$"):
        measure_deviation(square(), square(), 0.0)


def test_uneven_triangles_do_not_take_millions_of_samples():
    tiny = square(n=20, size=0.001)
    points = np.vstack([tiny.points, [[0, 0, 1], [1000, 0, 1], [0, 1000, 1]]])
    count = len(tiny.points)
    surface = SurfaceMesh(points, np.vstack([tiny.triangles, [[count, count + 1, count + 2]]]))
    found = measure_deviation(surface, surface)
    assert found.max == pytest.approx(0.0, abs=1e-12)
    assert 1000.0 / np.sqrt(3.0) / 256 < found.error_ab < 10.0


def same_ways(triangles, patch):
    """How many edges between two triangles of a patch both run through the same way."""
    _, owners, starts, sizes, forward = surface_edges(triangles, int(triangles.max()) + 1)
    first = starts[sizes == 2]
    alike = patch[owners[first]] == patch[owners[first + 1]]
    return int((alike & (forward[first] == forward[first + 1])).sum())


@pytest.mark.parametrize("seed", range(3))
def test_a_patch_winds_one_way_however_the_tets_are_ordered(seed):
    mesh = interleaved_ball(seed)
    interfaces = mesh.topology.interfaces
    assert same_ways(interfaces, np.zeros(len(interfaces), dtype=np.int64)) > 10
    found = find_strata(mesh)
    assert same_ways(found.triangles, found.patch) == 0
    assert np.array_equal(np.sort(found.triangles[-len(interfaces) :], axis=1), np.sort(interfaces, axis=1))
    assert np.array_equal(
        (found.triangles[-len(interfaces) :] != interfaces).any(axis=1), found.turned[-len(interfaces) :]
    )


def test_a_sheet_inside_a_region_winds_one_way():
    mesh = interleaved_ball(1)
    sheet = TetMesh(mesh.points, mesh.tets, facets=Cells(mesh.topology.interfaces))
    found = find_strata(sheet)
    assert same_ways(found.triangles, found.patch) == 0


def test_a_strip_with_one_side_stays_as_it_is():
    strip = np.array([[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4], [4, 5, 1], [5, 0, 1]])  # closed with half a turn
    _, owners, starts, sizes, forward = surface_edges(strip, 6)
    first = starts[sizes == 2]
    links = owners[first], owners[first + 1], forward[first] == forward[first + 1]
    assert links[2].any()
    assert not turned_triangles(*links, np.zeros(6, dtype=np.int64)).any()
