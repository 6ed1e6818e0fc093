"""The compiled Delaunay triangulation against Qhull, rational arithmetic and closed forms."""

import itertools
import threading
from fractions import Fraction

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Delaunay

from wct_plugin.core import _core
from wct_plugin.exact.predicates import orientation


def as_set(tets):
    return {tuple(row) for row in np.sort(tets, axis=1).tolist()}


def grid(n, spacing=1.0):
    axis = np.arange(n)
    return spacing * np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3).astype(float)


def rotation(seed):
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q


def determinant(rows):
    if len(rows) == 1:
        return rows[0][0]
    return sum(
        (-1) ** j * value * determinant([row[:j] + row[j + 1 :] for row in rows[1:]])
        for j, value in enumerate(rows[0])
        if value
    )


def exact_side(corners, point):
    """1 for a point inside the sphere of a positive tet, 0 on it, -1 outside: rational arithmetic, by cofactors."""
    rows = [[Fraction(float(x)) - Fraction(float(y)) for x, y in zip(corner, point, strict=True)] for corner in corners]
    det = -determinant([[*row, sum(x * x for x in row)] for row in rows])
    return (det > 0) - (det < 0)


def exact_volume(points, tets):
    total = Fraction(0)
    for tet in tets:
        a, b, c, d = ([Fraction(float(x)) for x in points[i]] for i in tet)
        total += determinant([[x - y for x, y in zip(p, a, strict=True)] for p in (b, c, d)])
    return total / 6


def check(points, *, locally_exact=True):
    """Assert that the result is a Delaunay triangulation of all the points; return it."""
    tets, neighbours = _core.delaunay(points)
    assert tets.dtype == neighbours.dtype == np.int64
    assert tets.shape == neighbours.shape
    assert np.array_equal(np.unique(tets), np.arange(len(points)))
    assert (orientation(points, tets) == 1).all()  # exact: none is flat

    # Neighbours are mutual and share the facet; facets without one close up to a sphere (Euler).
    tet, corner = np.nonzero(neighbours >= 0)
    other = neighbours[tet, corner]
    assert (np.sum(neighbours[other] == tet[:, None], axis=1) == 1).all()
    facet = tets[tet][np.arange(4) != corner[:, None]].reshape(-1, 3)
    assert ((tets[other][:, :, None] == facet[:, None, :]).any(axis=1)).all()
    tet_out, corner_out = np.nonzero(neighbours < 0)
    hull = np.sort(tets[tet_out][np.arange(4) != corner_out[:, None]].reshape(-1, 3), axis=1)
    edges, uses = np.unique(hull[:, [[0, 1], [0, 2], [1, 2]]].reshape(-1, 2), axis=0, return_counts=True)
    assert (uses == 2).all()
    assert len(np.unique(hull)) - len(edges) + len(hull) == 2

    # Each facet locally Delaunay, which makes the whole Delaunay. In floating point, then exactly where that is unsure.
    apex = tets[other][np.arange(4) == np.argmax(neighbours[other] == tet[:, None], axis=1)[:, None]]
    rows = points[tets[tet]] - points[apex][:, None]
    lifted = np.concatenate([rows, np.sum(rows * rows, axis=2, keepdims=True)], axis=2)
    size = np.prod(np.max(np.abs(lifted), axis=1), axis=1)
    with np.errstate(under="ignore"):
        side = -np.linalg.det(lifted)
    unsure = np.flatnonzero(~(side < -1e-11 * size))
    if locally_exact:
        for i in unsure:
            assert exact_side(points[tets[tet[i]]], points[apex[i]]) <= 0
    return tets, neighbours


@pytest.mark.parametrize("count", [5, 40, 1000, 8000])
def test_random_points_give_qhulls_tets(count):
    points = np.random.default_rng(count).random((count, 3))
    tets, _ = check(points)
    assert as_set(tets) == as_set(Delaunay(points).simplices)


def test_neighbours_are_qhulls():
    points = np.random.default_rng(1).normal(size=(300, 3))
    tets, neighbours = check(points)
    qhull = Delaunay(points)

    def pairs(simplices, across):
        return {
            (tuple(sorted(s)), tuple(sorted(simplices[n])) if n >= 0 else None)
            for s, row in zip(simplices.tolist(), across.tolist(), strict=True)
            for n in row
        }

    assert pairs(tets, neighbours) == pairs(qhull.simplices, qhull.neighbors)


def test_neighbour_i_lies_opposite_vertex_i():
    tets, neighbours = _core.delaunay(np.random.default_rng(2).random((200, 3)))
    for tet, row in zip(tets.tolist(), neighbours.tolist(), strict=True):
        for vertex, other in zip(tet, row, strict=True):
            assert other < 0 or set(tet) - {vertex} <= set(tets[other].tolist())


def test_one_tet():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    for order in itertools.permutations(range(4)):
        tets, neighbours = check(points[list(order)])
        assert tets.shape == (1, 4)
        assert (neighbours == -1).all()


@pytest.mark.parametrize("seed", range(20))
def test_no_point_in_any_sphere_exactly(seed):
    rng = np.random.default_rng(seed)
    points = np.unique(rng.integers(0, 4, size=(14, 3)).astype(float) * [1.0, 0.1, 1 / 3][seed % 3], axis=0)
    tets, _ = check(points)
    for tet in tets:
        assert all(exact_side(points[tet], points[i]) <= 0 for i in range(len(points)) if i not in tet)
    corners = {tuple(p) for p in points.tolist()}
    assert len(corners) == len(points)
    assert float(exact_volume(points, tets)) == pytest.approx(ConvexHull(points).volume, rel=1e-12)


@pytest.mark.parametrize("spacing", [1.0, 0.1, 1e-7])
def test_cartesian_grid(spacing):
    n = 5
    points = grid(n, spacing)
    tets, _ = check(points)
    volume = (
        Fraction(float(points[:, 0].max())) * Fraction(float(points[:, 1].max())) * Fraction(float(points[:, 2].max()))
    )
    assert exact_volume(points, tets) == volume


def test_rotated_grid_fills_its_hull():
    points = grid(10) @ rotation(3)
    tets, _ = check(points, locally_exact=False)
    edges = points[tets[:, 1:]] - points[tets[:, :1]]
    assert np.linalg.det(edges).sum() / 6 == pytest.approx(729.0, rel=1e-12)


def test_bcc_lattice_gives_the_bcc_tets():
    n = 6
    points = np.vstack([grid(n), grid(n - 1) + 0.5])
    tets, _ = check(points)
    assert exact_volume(points, tets) == (n - 1) ** 3
    # No two spheres coincide inside: every tet away from the hull is the BCC tet, of volume 1/12.
    inside = ((points[tets] > 0) & (points[tets] < n - 1)).all(axis=(1, 2))
    volumes = np.linalg.det(points[tets[inside, 1:]] - points[tets[inside, :1]]) / 6
    assert inside.sum() > 100
    assert volumes == pytest.approx(1 / 12)


def test_numbering_does_not_change_the_tets():
    points = grid(5, 0.1)
    shuffle = np.random.default_rng(4).permutation(len(points))
    tets, _ = _core.delaunay(points)
    shuffled, _ = _core.delaunay(points[shuffle])
    assert as_set(shuffle[shuffled]) == as_set(tets)


def test_points_on_a_sphere():
    points = np.random.default_rng(5).normal(size=(1500, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    tets, neighbours = check(points, locally_exact=False)
    assert (neighbours < 0).sum() == 2 * len(points) - 4  # all are on the hull
    edges = points[tets[:, 1:]] - points[tets[:, :1]]
    assert np.linalg.det(edges).sum() / 6 == pytest.approx(ConvexHull(points).volume, rel=1e-10)


def test_exactly_cospherical_points():
    points = np.array([p for p in itertools.product(range(-13, 14), repeat=3) if sum(x * x for x in p) == 169], float)
    tets, _ = check(points)
    assert float(exact_volume(points, tets)) == pytest.approx(ConvexHull(points).volume, rel=1e-12)


def test_nearly_coplanar_points():
    rng = np.random.default_rng(6)
    for scale in (1e-3, 1e-9, 1e-15, 1e-100):
        points = rng.random((150, 3)) * [1, 1, scale]
        tets, _ = check(points, locally_exact=scale > 1e-20)
        volume = exact_volume(points, tets) / Fraction(scale)
        expected = ConvexHull(points / [1, 1, scale]).volume
        assert float(volume) == pytest.approx(expected, rel=1e-12)


def test_plane_with_one_point_above():
    plane = np.array([[i, j, 0.0] for i in range(9) for j in range(9)])
    points = np.vstack([plane, [[4.0, 4.0, 3.0]]])
    tets, _ = check(points)
    assert len(tets) == 2 * 64
    assert (tets == len(plane)).any(axis=1).all()


def test_clusters_of_many_scales():
    rng = np.random.default_rng(7)
    points = np.vstack([rng.random(3) + rng.random((60, 3)) * 10.0**-k for k in range(10)])
    check(points)


def test_nested_clusters_around_the_origin():
    points = np.vstack([np.random.default_rng(8).normal(size=(100, 3)) * 10.0**-k for k in range(0, 60, 6)])
    check(points, locally_exact=False)


@pytest.mark.parametrize("offset", [1e3, 1e8, 1e14])
def test_far_from_the_origin(offset):
    points = np.random.default_rng(9).random((500, 3)) + offset
    check(np.unique(points, axis=0))


def test_lattice_far_from_the_origin_has_the_same_tets():
    tets, _ = check(grid(5))
    moved, _ = check(grid(5) + 2.0**40)
    assert as_set(moved) == as_set(tets)


@pytest.mark.parametrize("scale", [2.0**-400, 2.0**-300, 2.0**300, 2.0**1000])
def test_scale_of_any_power_of_two_leaves_the_tets(scale):
    points = np.random.default_rng(10).random((60, 3))
    tets, _ = _core.delaunay(points)
    scaled, _ = _core.delaunay(points * scale)
    assert np.array_equal(scaled, tets)


def test_coordinates_of_all_magnitudes():
    rng = np.random.default_rng(14)
    points = rng.choice([-1.0, 1.0], size=(60, 3)) * 10.0 ** rng.uniform(-300, 300, size=(60, 3))
    tets, _ = _core.delaunay(points)
    assert np.array_equal(np.unique(tets), np.arange(len(points)))
    assert (orientation(points, tets) == 1).all()


def test_same_input_same_arrays():
    points = np.vstack([np.random.default_rng(11).random((3000, 3)), grid(8, 0.125)])
    points = np.unique(points, axis=0)
    first = _core.delaunay(points)
    results = []
    threads = [threading.Thread(target=lambda: results.append(_core.delaunay(points))) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 3
    for result in results:
        assert np.array_equal(result[0], first[0])
        assert np.array_equal(result[1], first[1])


def test_input_stays_as_it_is():
    points = np.random.default_rng(12).random((50, 3))
    points.setflags(write=False)
    before = points.copy()
    _core.delaunay(points)
    assert np.array_equal(points, before)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (np.zeros((0, 3)), "needs at least 4 points, got 0"),
        (np.eye(3), "needs at least 4 points, got 3"),
        (np.zeros((5, 3)), "coincide"),
        (np.outer(np.arange(6.0), [0.1, 0.2, 0.3]), "all 6 points lie in one plane"),
        (np.array([[i, j, 5.0] for i in range(4) for j in range(4)]), "all 16 points lie in one plane"),
        (np.array([[0, 0, 0], [1, 0, 0], [0, np.nan, 0], [0, 0, 1.0]]), "point 2 is not finite"),
        (np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, np.inf]]), "point 3 is not finite"),
    ],
)
def test_refuses(points, message):
    with pytest.raises(ValueError, match=message):
        _core.delaunay(points)


@pytest.mark.parametrize(("i", "j"), [(0, 1), (3, 250), (498, 499)])
def test_names_coinciding_points(i, j):
    points = np.random.default_rng(13).random((500, 3))
    points[j] = points[i]
    with pytest.raises(ValueError, match=f"points {i} and {j} coincide"):
        _core.delaunay(points)


def test_zeros_of_either_sign_coincide():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-0.0, 0, 0]])
    with pytest.raises(ValueError, match="points 0 and 4 coincide"):
        _core.delaunay(points)
