"""A new start: closest points, curvatures, and what a resampled domain must keep."""

from dataclasses import fields, replace
from itertools import combinations

import numpy as np
import pytest
from scipy.spatial import cKDTree
from support.boxes import CUBE, box, cube_surface
from support.builders import ball, fin, kuhn_cube, l_shape
from support.core_meshes import FACETS, NO_LABELS, NO_SEGMENTS, sampled, start

from wct_plugin.core import _core
from wct_plugin.core.domain import StratifiedMesh, StratifiedSurface
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.triangle_surfaces import pinched
from wct_plugin.meshing.reference import own_boundary


def grid(u, v, close_u, close_v):
    """Triangles of a u x v grid of quads, wrapped where asked."""
    i, j = np.meshgrid(np.arange(u if close_u else u - 1), np.arange(v if close_v else v - 1), indexing="ij")
    a, b = i * v + j, ((i + 1) % u) * v + j
    c, d = ((i + 1) % u) * v + (j + 1) % v, i * v + (j + 1) % v
    return np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])


def torus(u=96, v=48, big=1.0, small=0.35):
    s, t = np.meshgrid(np.arange(u) * 2 * np.pi / u, np.arange(v) * 2 * np.pi / v, indexing="ij")
    ring = big + small * np.cos(t)
    points = np.stack([ring * np.cos(s), ring * np.sin(s), small * np.sin(t)], -1).reshape(-1, 3)
    return points, grid(u, v, True, True), t.ravel()


def rotation():
    q, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    return q * np.linalg.det(q)


def volumes(points, tets):
    a, b, c, d = np.moveaxis(points[tets], 1, 0)
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def boundary(tets):
    facets = tets[:, FACETS].reshape(-1, 3)
    _, first, count = np.unique(np.sort(facets, axis=1), axis=0, return_index=True, return_counts=True)
    assert count.max() <= 2
    return facets[first[count == 1]]


def edge_uses(triangles):
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return np.unique(ends, axis=0, return_counts=True)[1]


def same_bits(one, other):
    return all(np.array_equal(getattr(one.mesh, f.name), getattr(other.mesh, f.name)) for f in fields(StratifiedMesh))


@pytest.fixture(scope="module", params=[False, True], ids=["straight", "turned"])
def cube(request):
    turn = rotation() if request.param else None
    points, tets = box(6, turn)
    result = sampled(cube_surface(turn), points, tets)
    return result, points, tets, turn


def test_closest_points_against_dense_samples():
    rng = np.random.default_rng(1)
    points = rng.normal(size=(60, 3))
    triangles = np.array([rng.choice(60, 3, replace=False) for _ in range(40)])
    queries = rng.normal(size=(50, 3)) * 1.5
    found, triangle, distance = _core.closest_points(points, triangles, queries)
    n = 60
    weights = np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]) / n
    samples = np.einsum("wk,tkd->twd", weights, points[triangles])
    dense = np.linalg.norm(samples[None] - queries[:, None, None], axis=-1).min(axis=(1, 2))
    assert (distance <= dense + 1e-12).all()
    assert (dense - distance < 0.1).all()
    assert np.allclose(np.linalg.norm(found - queries, axis=1), distance, atol=1e-12)
    a, b, c = np.moveaxis(points[triangles[triangle]], 1, 0)
    normal = np.cross(b - a, c - a)
    off = np.einsum("ij,ij->i", found - a, normal) / np.linalg.norm(normal, axis=1)
    assert np.abs(off).max() < 1e-12


def test_curvatures_of_a_torus():
    points, triangles, angle = torus()
    found = _core.surface_curvatures(points, triangles, np.zeros(len(triangles), dtype=np.int64))
    first, second = found.reshape(-1, 3, 2)[..., 0].ravel(), found.reshape(-1, 3, 2)[..., 1].ravel()
    t = angle[triangles].ravel()
    assert np.allclose(first, 1 / 0.35, rtol=0.03)
    assert np.allclose(second, np.cos(t) / (1 + 0.35 * np.cos(t)), atol=0.06)


def test_curvatures_of_a_cylinder_away_from_its_rims():
    u, v = 64, 24
    s, z = np.meshgrid(np.arange(u) * 2 * np.pi / u, np.linspace(0, 2, v), indexing="ij")
    points = np.stack([0.5 * np.cos(s), 0.5 * np.sin(s), z], -1).reshape(-1, 3)
    triangles = grid(u, v, True, False)
    found = _core.surface_curvatures(points, triangles, np.zeros(len(triangles), dtype=np.int64))
    inner = ((points[:, 2] > 0.4) & (points[:, 2] < 1.6))[triangles].ravel()
    values = found.reshape(-1, 2)[inner]
    assert np.allclose(np.abs(values[:, 0]), 2.0, rtol=0.02)
    assert np.abs(values[:, 1]).max() < 0.02


def test_planes_have_no_curvature():
    surface = cube_surface()
    found = _core.surface_curvatures(surface.points, surface.triangles, surface.patch)
    assert (found == 0.0).all()


def test_cube_keeps_its_planes_edges_corners_and_volume(cube):
    result, _, _, turn = cube
    points, tets, stratum = result.mesh.points, result.mesh.tets, result.mesh.stratum
    back = points if turn is None else points @ turn
    assert (volumes(points, tets) > 0).all()
    assert volumes(points, tets).sum() == pytest.approx(1.0, abs=1e-12)
    on_planes = (np.abs(back[:, :, None] - [0.0, 1.0]).min(axis=2) < 1e-12).sum(axis=1)
    assert (on_planes == stratum).all()
    assert (stratum == 3).sum() == 8
    surface = boundary(tets)
    assert (edge_uses(surface) == 2).all()
    assert (stratum[surface] > 0).all()
    assert len(result.exposed) == len(result.pinched) == 0


def test_cube_is_nearly_well_centered_and_keeps_its_size(cube):
    result, _, tets, _ = cube
    assert 0.8 < len(result.mesh.tets) / len(tets) < 1.3
    # Of so small a mesh a good part is at its corners, whose divided angles are crowded at first.
    assert result.stats["bad"] < 0.09 * len(result.mesh.tets)


def test_its_work_is_that_of_its_sweeps_and_rounds(cube):
    """25 sweeps at 120 and 1 to 21 rounds at 400 per point, of which relaxation changes the number by some percent."""
    points = len(cube[0].mesh.points)
    assert 0.9 * (25 * 120 + 400) * points < cube[0].work < 1.1 * (25 * 120 + 21 * 400) * points


def test_seeds_keep_their_distance(cube):
    result, _, _, _ = cube
    points, tets, size = result.mesh.points, result.mesh.tets, result.mesh.size
    ends = np.unique(np.sort(tets[:, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]].reshape(-1, 2), axis=1), axis=0)
    length = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1) / size[ends].mean(axis=1)
    assert length.min() > 0.2
    assert np.quantile(length, 0.01) > 0.5
    assert 0.8 < np.median(length) < 1.1


def test_facets_keep_the_tolerance_of_a_coarsely_faceted_surface():
    # 14-gon tubes: bends of 26 degrees, a sag of their own near the tolerance; every edge is a ridge to be bridged.
    u, v = 28, 14
    surface, triangles, _ = torus(u, v)
    points = np.concatenate([surface, [[np.cos(s), np.sin(s), 0.0] for s in np.arange(u) * 2 * np.pi / u]])
    tets = []
    for i in range(u):
        for j in range(v):
            k, m = (i + 1) % u, (j + 1) % v
            a, b, c, d = i * v + j, k * v + j, k * v + m, i * v + m
            p, q = u * v + i, u * v + k
            tets += [(a, b, c, q), (a, c, d, q), (a, d, p, q)]  # an axis segment, and the two triangles of a quad
    tets = np.array(tets)
    flip = volumes(points, tets) < 0
    tets[flip] = tets[flip][:, [0, 1, 3, 2]]
    tolerance = 0.02
    on = StratifiedSurface(
        surface,
        triangles,
        np.zeros(len(triangles), dtype=np.int64),
        NO_SEGMENTS,
        NO_LABELS,
        np.array([[0, -1]]),
    )
    result = sampled(on, points, tets, tolerance=tolerance)
    facets = boundary(result.mesh.tets)
    n = 12
    weights = np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]) / n
    samples = np.einsum("wk,tkd->twd", weights, result.mesh.points[facets])
    far = _core.closest_points(surface, triangles, samples.reshape(-1, 3))[2].reshape(len(facets), -1).max(axis=1)
    assert (far > tolerance).mean() < 0.01
    back = _core.closest_points(result.mesh.points, facets, surface)[2]
    assert (back > tolerance).mean() < 0.01
    assert volumes(result.mesh.points, result.mesh.tets).sum() == pytest.approx(volumes(points, tets).sum(), rel=5e-3)


def test_edges_are_shorter_round_places_where_they_are_to_be():
    points, tets = box(4)
    place, size = np.array([[1.0, 0.5, 0.5]]), np.array([0.1])
    plain = sampled(cube_surface(), points, tets)
    finer = sampled(cube_surface(), points, tets, finer_at=place, finer_size=size)
    assert finer.intact

    def edges(mesh, near):
        ends = mesh.mesh.points[mesh.mesh.tets[:, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]]]
        here = (np.linalg.norm(ends.mean(axis=(1, 2)) - place, axis=1) < 0.2) == near
        return np.linalg.norm(ends[here, :, 0] - ends[here, :, 1], axis=-1).mean()

    assert edges(plain, near=True) > 0.2
    assert edges(finer, near=True) < 1.25 * size[0]
    assert edges(finer, near=False) > 1.2 * size[0]
    with pytest.raises(ValueError, match="finer_size has length 0; it must be 1"):
        sampled(cube_surface(), points, tets, finer_at=place)
    with pytest.raises(ValueError, match="finer_size"):
        sampled(cube_surface(), points, tets, finer_at=place, finer_size=np.array([0.0]))


def test_same_input_same_bits():
    points, tets = box(4)
    runs = [sampled(cube_surface(), points, tets) for _ in range(2)]
    assert same_bits(*runs)
    other = sampled(cube_surface(), points, tets, seed=2)
    assert not np.array_equal(runs[0].mesh.points, other.mesh.points)


def test_any_number_of_threads_gives_the_same_bits():
    """A curved surface and enough of it that every loop is cut into several chunks."""
    mesh = ball(4)
    runs = [start(mesh, own_boundary(mesh, 40.0), tolerance=2.5e-3, threads=threads) for threads in (1, 2, 3)]
    assert len(runs[0].mesh.points) > 600
    assert all(same_bits(runs[0], other) for other in runs[1:])


def test_progress_can_stop_it():
    points, tets = box(16)
    calls = []
    result = sampled(cube_surface(), points, tets, progress=lambda done, bad: bool(calls.append(done)))
    assert len(calls) == 1
    assert result.stats["stopped"]


def test_bad_arguments_are_refused():
    points, tets = box(2)
    surface = cube_surface()
    with pytest.raises(ValueError, match="tolerance"):
        sampled(surface, points, tets, tolerance=0.0)
    with pytest.raises(ValueError, match="gap"):
        sampled(surface, points, tets, gap=0.0)
    with pytest.raises(ValueError, match="triangles names point 1"):
        sampled(replace(surface, triangles=surface.triangles + 100), points, tets)
    with pytest.raises(TypeError, match="patch is a list"):
        sampled(replace(surface, patch=surface.patch.tolist()), points, tets)


def squeezed_box(width, keep):
    """A unit cube of 6^3 cells without those ``keep`` drops, its third layer along x ``width`` thick."""
    points, tets = box(6)
    tets = tets[keep(points[tets].mean(axis=1))]
    used, tets = np.unique(tets, return_inverse=True)
    points = points[used]
    points[:, 0] = np.interp(points[:, 0], [0, 1 / 3, 1 / 2, 1], [0, (1 - width) / 2, (1 + width) / 2, 1])
    return TetMesh(points, tets.reshape(-1, 4))


def in_layer(centroids):
    return (centroids[:, 0] > 1 / 3) & (centroids[:, 0] < 1 / 2)


def euler(tets):
    cells = (np.concatenate([tets[:, list(c)] for c in combinations(range(4), k)]) for k in (1, 2, 3, 4))
    return sum((-1) ** k * len(np.unique(np.sort(part, axis=1), axis=0)) for k, part in enumerate(cells))


@pytest.mark.parametrize("width", [0.1, 0.05])
@pytest.mark.parametrize(
    "keep",
    [
        lambda c: ~(in_layer(c) & (c[:, 2] > 1 / 3)),  # a slot
        lambda c: in_layer(c) | (c[:, 2] < 2 / 3),  # a web
        lambda c: ~(in_layer(c) & ((c[:, 2] > 1 / 2) | (c[:, 1] > 1 / 2))),  # two halves joined by a bridge
    ],
    ids=["slot", "web", "bridge"],
)
def test_close_sheets_stay_apart(keep, width):
    mesh = squeezed_box(width, keep)
    assert volumes(*resampled(mesh)).sum() == pytest.approx(volumes(mesh.points, mesh.tets).sum(), rel=1e-6)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_surface_that_cuts_across_a_slot_is_not_the_domain(seed):
    """Facets six times as long as the slot is wide reach from wall to wall, mostly without a topological trace."""
    mesh = squeezed_box(0.02, lambda c: ~(in_layer(c) & (c[:, 2] > 1 / 3)))
    assert not start(mesh, own_boundary(mesh, 40.0), gap=100.0, seed=seed).intact


def resampled(mesh):
    """Points and tets of a new start, a ball like the mesh and with a manifold surface."""
    result = start(mesh, own_boundary(mesh, 40.0))
    assert result.intact
    facets = np.sort(result.mesh.tets[:, FACETS].reshape(-1, 3), axis=1)
    facets, count = np.unique(facets, axis=0, return_counts=True)
    skin = facets[count == 1]
    edges = np.sort(skin[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2))
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    assert not pinched(skin, len(result.mesh.points)).any()
    assert euler(result.mesh.tets) == euler(mesh.tets) == 1
    assert volumes(result.mesh.points, result.mesh.tets).min() > 0
    return result.mesh.points, result.mesh.tets


def test_edges_are_no_longer_than_the_creases_they_meet():
    """A step far lower than the edges wanted: nothing but the length of its upright creases tells of it."""
    height = 0.05
    mesh = squeezed_box(height, lambda c: (c[:, 0] < 1 / 3) | (in_layer(c) & (c[:, 2] > 1 / 2)))
    found = start(mesh, own_boundary(mesh, 40.0), size=np.full(len(mesh.points), 0.3))
    points, facets = found.mesh.points, found.mesh.facets
    ends = facets[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    upright = [[0.5 + side * height / 2, y, 0.5] for side in (-1, 1) for y in (0.0, 1.0)]
    away, at = cKDTree(points).query(upright)
    assert away.max() < 1e-12
    touching = ends[np.isin(ends, at).any(axis=1)]
    assert np.linalg.norm(points[touching[:, 0]] - points[touching[:, 1]], axis=1).max() < 2 * height


def test_creases_have_no_gaps_where_sizes_change():
    """Points of a patch come to lie on its creases there; left on them, they take the crease's edge away."""
    mesh = fin()
    own = own_boundary(mesh, 40.0)
    rng = np.random.default_rng(5)
    for seed in range(1, 31):
        places = rng.uniform(0.0, (5.0, 4.0, 4.0), (rng.integers(2, 8), 3))
        found = start(mesh, own, finer_at=places, finer_size=np.full(len(places), rng.uniform(0.2, 0.6)), seed=seed)
        assert found.intact
        ends = np.bincount(found.mesh.creases.ravel(), minlength=len(found.mesh.points))
        assert (ends[found.mesh.stratum == 2] == 2).all()
        assert ends[found.mesh.stratum == 3].tolist() == [3] * len(own.corners)
        on_patch = found.mesh.stratum[found.mesh.facets] == 1
        assert ((found.mesh.label[found.mesh.facets] == found.mesh.facet_patch[:, None]) | ~on_patch).all()


def test_what_a_fold_of_the_surface_buries_is_interior():
    """A sheet of no thickness hangs inside the cube: nothing of the mesh's surface is there to keep its points on."""
    surface, fold = cube_surface(), np.array([[0.3, 0.3, 0.5], [0.7, 0.3, 0.5], [0.5, 0.7, 0.5]])
    surface = StratifiedSurface(
        np.concatenate([CUBE, fold]),
        np.concatenate([surface.triangles, [[8, 9, 10], [8, 10, 9]]]),
        np.append(surface.patch, [6, 7]),
        np.concatenate([surface.segments, [[8, 9], [9, 10], [8, 10]]]),
        np.arange(15),
        np.tile([0, -1], (8, 1)),
        np.arange(11),
    )
    points, tets = box(4)
    found = sampled(surface, points, tets)
    away, at = cKDTree(found.mesh.points).query(fold)
    assert away.max() < 1e-12
    assert (found.mesh.stratum[at] == 0).all()
    assert (found.mesh.label[at] == -1).all()
    outside = np.isin(np.arange(len(found.mesh.points)), found.mesh.facets)
    assert ((found.mesh.stratum > 0) == outside).all()


@pytest.mark.parametrize("mesh", [kuhn_cube(6), l_shape(4)], ids=["cube", "L"])
def test_no_facet_fills_a_right_angle_of_a_face(mesh):
    # Such a facet is not acute, and to open it later takes long.
    found = start(mesh, own_boundary(mesh, 40.0))
    points, crease = found.mesh.points, {tuple(edge) for edge in np.sort(found.mesh.creases, axis=1).tolist()}
    filled = 0
    for facet in found.mesh.facets:
        for v, a, b in (np.roll(facet, k) for k in range(3)):
            if found.mesh.stratum[v] == 3 and {tuple(sorted((v, a))), tuple(sorted((v, b)))} <= crease:
                p, q = points[a] - points[v], points[b] - points[v]
                filled += p @ q < 0.02 * np.linalg.norm(p) * np.linalg.norm(q)
    assert filled == 0
