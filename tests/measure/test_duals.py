"""The circumcentric dual against closed forms, identities and SciPy's Voronoi cells."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Voronoi
from support.builders import (
    ball,
    bcc,
    jittered_cube,
    kuhn_cube,
    regular_tet,
    rotation,
    single,
    two_region_cube,
)
from support.flags import signed_duals

from wct_plugin.measure import quality
from wct_plugin.measure.duals import TIERS, compute_duals, dual_lengths, hodge_star, misses, tiers
from wct_plugin.mesh import TetMesh, region_parts
from wct_plugin.mesh.topology import FACETS


def interior_points(mesh):
    return np.flatnonzero(~mesh.topology.boundary_points)


def test_regular_tet():
    dual = compute_duals(regular_tet())
    assert np.allclose(dual.lengths, np.sqrt(1.0 / 24.0))  # inradius of edge 1
    assert np.allclose(dual.volumes, 1.0 / (6.0 * np.sqrt(2.0)) / 4.0)
    # Per edge a kite of the edge midpoint, two facet centers and the center: its diagonals are orthogonal.
    assert np.allclose(dual.areas, 2.0 * 0.5 * (1.0 / (2.0 * np.sqrt(3.0))) * np.sqrt(1.0 / 24.0))


def test_bcc_cells_are_truncated_octahedra():
    """The Voronoi cell of the BCC lattice with cubic cell 1: volume 1/2, edges sqrt(2)/4, squares and hexagons."""
    mesh = bcc(4)
    dual = compute_duals(mesh)
    inner = interior_points(mesh)
    assert np.allclose(dual.volumes[inner], 0.5)
    assert np.allclose(dual.lengths[: len(mesh.topology.interior_pairs)], np.sqrt(2.0) / 4.0)
    edges = mesh.topology.edges
    length = np.linalg.norm(np.diff(mesh.points[edges], axis=1)[:, 0], axis=1)
    deep = np.isin(edges, inner).all(axis=1)
    square = np.isclose(length, 1.0)
    assert (square[deep].sum(), (~square)[deep].sum()) != (0, 0)
    assert np.allclose(dual.areas[deep & square], 1.0 / 8.0)
    assert np.allclose(dual.areas[deep & ~square], 1.5 * np.sqrt(3.0) / 8.0)


@pytest.mark.parametrize("mesh", [kuhn_cube(2), jittered_cube(3), ball(4), bcc(2), two_region_cube(2)])
def test_sums(mesh):
    dual = compute_duals(mesh)
    total = quality.volumes(mesh.points, mesh.tets).sum()
    assert dual.volumes.sum() == pytest.approx(total, rel=1e-12)
    # Each edge carries a bipyramid over its dual face: a third of length times area, over all edges.
    length = np.linalg.norm(np.diff(mesh.points[mesh.topology.edges], axis=1)[:, 0], axis=1)
    assert (length * dual.areas).sum() / 3.0 == pytest.approx(total, rel=1e-12)
    # And each facet an edge of the dual: the same third.
    pairs, border = mesh.topology.interior_pairs, mesh.topology.boundary_half_facets
    tet, local = np.concatenate([pairs[:, :2], border]).T
    corners = mesh.points[mesh.tets[tet[:, None], FACETS[local]]]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2.0
    assert (area * dual.lengths).sum() / 3.0 == pytest.approx(total, rel=1e-12)
    assert np.allclose(hodge_star(mesh, 2), dual.lengths / area)


def test_cells_of_interior_vertices_are_voronoi_cells():
    mesh = jittered_cube(5, seed=3)
    volumes = compute_duals(mesh).volumes
    diagram = Voronoi(mesh.points)
    inner = interior_points(mesh)
    checked = 0
    for point in inner:
        region = diagram.regions[diagram.point_region[point]]
        if -1 in region:
            continue
        assert volumes[point] == pytest.approx(ConvexHull(diagram.vertices[region]).volume, rel=1e-9)
        checked += 1
    assert checked == len(inner) == 64


def test_areas_are_those_of_voronoi_faces():
    mesh = jittered_cube(4, seed=1)
    areas = dict(zip(map(tuple, mesh.topology.edges.tolist()), compute_duals(mesh).areas, strict=True))
    diagram = Voronoi(mesh.points)
    deep = set(interior_points(mesh).tolist())
    checked = 0
    for (p, q), ring in zip(diagram.ridge_points, diagram.ridge_vertices, strict=True):
        if p in deep and q in deep and -1 not in ring:
            corners = diagram.vertices[ring]
            normal = np.cross(corners - corners[0], np.roll(corners, -1, axis=0) - corners[0]).sum(axis=0)
            assert areas.get((min(p, q), max(p, q)), 0.0) == pytest.approx(np.linalg.norm(normal) / 2.0, abs=1e-12)
            checked += 1
    assert checked > 50


def test_hodge_star():
    mesh = bcc(3)
    dual = compute_duals(mesh)
    assert (hodge_star(mesh, 0) == dual.volumes).all()
    length = np.linalg.norm(np.diff(mesh.points[mesh.topology.edges], axis=1)[:, 0], axis=1)
    assert np.allclose(hodge_star(mesh, 1, dual), dual.areas / length)
    assert np.allclose(hodge_star(mesh, 2, dual), dual.lengths / (np.sqrt(2.0) / 4.0))  # sides 1, sqrt(3)/2 twice
    assert np.allclose(hodge_star(mesh, 3), 12.0)
    assert (hodge_star(mesh, 1) > 0).all()
    with pytest.raises(ValueError, match="k is 4"):
        hodge_star(mesh, 4)


def test_order_of_the_dual_lengths():
    mesh = jittered_cube(2)
    lengths, errors = dual_lengths(mesh)
    heights, _ = quality.heights(mesh.points, mesh.tets)
    pairs, border = mesh.topology.interior_pairs, mesh.topology.boundary_half_facets
    for k, (t, i, u, j) in enumerate(pairs):
        assert lengths[k] == heights[t, i] + heights[u, j]
    for k, (t, i) in enumerate(border, start=len(pairs)):
        assert lengths[k] == heights[t, i]
    assert (errors < 1e-10).all()


def test_tiers_of_known_meshes():
    assert TIERS == ("valid", "Delaunay", "one-sided", "3WC", "CWC")
    assert tiers(bcc(3)).name == "CWC"
    assert tiers(regular_tet()).reached == 4
    apex = [[0, -0.6, -0.8], [0.64, -0.024, -0.768], [-0.64, -0.024, -0.768], [0, 0.352, 0.936]]
    assert tiers(single(apex)).name == "3WC"
    obtuse = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.1, 0.1, 0.2]]
    assert tiers(single(obtuse)).name == "Delaunay"  # nothing inside to compare, but not one-sided
    flat = np.array([[0, 0, 0], [1, 0, 0], [0.5, 0.9, 0], [0.5, 0.3, 0.2], [0.5, 0.3, -0.2]])
    assert tiers(TetMesh(flat, [[0, 1, 2, 3], [0, 1, 2, 4]])).name == "valid"


@pytest.mark.parametrize("turn", [np.eye(3), rotation(1), 1e3 * rotation(2)])
def test_cospherical_grids_are_delaunay_but_not_one_sided(turn):
    mesh = kuhn_cube(3)
    found = tiers(TetMesh(mesh.points @ turn.T, mesh.tets))
    assert (found.delaunay, found.one_sided, found.name) == (True, False, "Delaunay")


def test_regions_do_not_matter_to_the_tier():
    mesh = bcc(2)
    split = TetMesh(mesh.points, mesh.tets, regions=np.arange(len(mesh.tets)))
    assert tiers(split) == tiers(mesh)


def test_delaunay_with_positive_boundary_makes_all_duals_positive():
    """The theorem behind the one-sided tier, on meshes that have it, no obtuse boundary, and are not well-centered."""
    found = 0
    for seed in range(6):
        mesh = jittered_cube(4, seed=seed, amount=0.1)
        tier = tiers(mesh)
        lengths, errors = dual_lengths(mesh)
        assert tier.delaunay
        assert not tier.well_centered_3
        if (lengths > errors).all():
            dual = compute_duals(mesh)
            assert tier.one_sided
            assert dual.areas.min() > 0
            assert dual.volumes.min() > 0
            found += 1
        else:
            assert not tier.one_sided
    assert found > 0


def test_three_well_centered_meshes_have_positive_duals():
    for turn in range(3):
        mesh = bcc(3)
        rng = np.random.default_rng(turn)
        inner = interior_points(mesh)
        points = mesh.points.copy()
        points[inner] += rng.uniform(-0.02, 0.02, (len(inner), 3))
        moved = TetMesh(points, mesh.tets)
        assert tiers(moved).well_centered_3
        dual = compute_duals(moved)
        assert min(dual.lengths.min(), dual.areas.min(), dual.volumes.min()) > 0


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("mesh", [kuhn_cube(2), jittered_cube(2, 5), ball(2)])
def test_every_entry_is_what_the_definition_gives(mesh, weighted):
    """Signs included: the weights are large enough to carry many orthocenters out of their tets."""
    edges = mesh.points[mesh.topology.edges]
    scale = (np.diff(edges, axis=1) ** 2).sum(axis=2).mean()
    weights = np.random.default_rng(3).uniform(0.0, 0.7, len(mesh.points)) * scale if weighted else None
    of = compute_duals(mesh, weights)
    volumes, areas, lengths = signed_duals(mesh, weights)
    assert of.volumes == pytest.approx([volumes[v,] for v in range(len(mesh.points))], abs=1e-11)
    assert of.areas == pytest.approx([areas[tuple(edge)] for edge in mesh.topology.edges.tolist()], abs=1e-11)
    facets = [tuple(sorted(facet)) for facet in mesh.topology.facets.tolist()]
    assert of.lengths == pytest.approx([lengths[facet] for facet in facets], abs=1e-11)
    assert not weighted or min(of.volumes.min(), of.areas.min(), of.lengths.min()) < 0
    assert of.volumes.sum() == pytest.approx(quality.volumes(mesh.points, mesh.tets).sum(), rel=1e-12)


def test_a_constant_weight_changes_nothing():
    mesh = jittered_cube(3)
    plain, lifted = compute_duals(mesh), compute_duals(mesh, np.full(len(mesh.points), 1e6))
    for name in ("volumes", "areas", "lengths"):
        assert getattr(lifted, name) == pytest.approx(getattr(plain, name), rel=1e-12, abs=1e-15)


def test_a_material_per_tet_is_not_averaged():
    """Materials one at a time add up to all; the star of a layered bar is that of its layers."""
    mesh = two_region_cube(4)
    both = compute_duals(mesh, coefficient=np.where(mesh.regions == 1, 2.0, 5.0))
    one, two = (compute_duals(mesh, coefficient=(mesh.regions == tag).astype(float)) for tag in (1, 2))
    for name in ("volumes", "areas", "lengths"):
        parts = 2.0 * getattr(one, name) + 5.0 * getattr(two, name)
        assert getattr(both, name) == pytest.approx(parts, abs=1e-14)
    assert one.volumes.sum() == pytest.approx(0.5)
    edges = mesh.topology.edges
    interface = (mesh.points[edges][..., 2] == 0.5).all(axis=1)
    inner = interface & ~mesh.topology.boundary_points[edges].any(axis=1)
    along = inner & (np.abs(np.diff(mesh.points[edges], axis=1)[:, 0]).max(axis=1) == 0.25)
    straight = along & ((np.diff(mesh.points[edges], axis=1)[:, 0] != 0).sum(axis=1) == 1)
    assert straight.any()
    assert both.areas[straight] == pytest.approx(3.5 / 16.0)  # half of a square face of side 1/4 in each


def test_the_errors_are_bounds():
    """Coordinates taken in another order round otherwise; flat tets, so that it shows."""
    mesh = jittered_cube(3)
    flat = TetMesh(mesh.points * [1.0, 1.0, 1e-4], mesh.tets)
    of, turned = compute_duals(flat), compute_duals(TetMesh(flat.points[:, [2, 0, 1]], flat.tets))
    for name, errors in (("volumes", "volume_errors"), ("areas", "area_errors"), ("lengths", "errors")):
        bounds = getattr(of, errors) + getattr(turned, errors)
        apart = np.abs(getattr(of, name) - getattr(turned, name))
        assert np.isfinite(bounds).all()
        assert (apart <= bounds).all()
        assert apart.max() > 0


@pytest.mark.parametrize("size", [1.0, 1e6, 1e-6])
@pytest.mark.parametrize(("short", "delaunay"), [(0.0, True), (0.9e-9, True), (1.1e-9, False)])
@pytest.mark.parametrize("apex", [1.0, 2.0])
def test_circumcenters_the_wrong_way_round_by_a_billionth_are_a_tie(size, short, delaunay, apex):
    """Two tets at a triangle with circumradius 1; the circumcenter of an apex at a lies (a - 1/a) / 2 above it."""
    height = (apex - 1 / apex) / 2
    other = -height - short * np.hypot(1.0, height)  # both circumradii are that hypotenuse
    rim = np.array([0.5, 2.1, 4.4])
    points = np.column_stack([np.cos(rim), np.sin(rim), np.zeros(3)])
    points = np.vstack([points, [0, 0, apex], [0, 0, -other - np.hypot(1.0, other)]]) * size
    mesh = TetMesh(points, [[0, 1, 2, 3], [0, 2, 1, 4]])
    assert tiers(mesh).delaunay == delaunay
    missing = misses(mesh, quality.measure(mesh), one_sided=False)
    assert missing.tolist() == [not delaunay] * 2
    if apex == 1.0:  # either circumcenter lies on the facet, so that the tie is one of each region by itself, too
        halves = replace(mesh, regions=np.array([0, 1]))
        assert misses(halves, quality.measure(halves), one_sided=False).tolist() == [not delaunay] * 2


def test_slivers_on_a_sphere_are_delaunay_where_rounding_hides_it():
    """Cospherical to the bit, and so flat that the bound is far above a billionth of the radius."""
    points = np.array(
        [[-830, 719, 358], [134, 625, 962], [60, 972, 621], [-720, 180, 885], [-1154, -47, 10]], dtype=float
    )
    mesh = TetMesh(points, [[0, 1, 2, 3], [0, 1, 3, 4]])
    _, errors = dual_lengths(mesh)
    assert len(set((points**2).sum(axis=1).tolist())) == 1
    assert errors[0] > 1e-8 * quality.circumradii(mesh.points, mesh.tets).max() > 0
    assert tiers(mesh).name == "Delaunay"


def _at(mesh, facet_bad, edge_bad, vertex_bad=()):
    """Tets that have one of these, found by vertex numbers."""
    facets = {tuple(sorted(mesh.topology.facets[row].tolist())) for row in np.flatnonzero(facet_bad)}
    edges = {tuple(sorted(mesh.topology.edges[row].tolist())) for row in np.flatnonzero(edge_bad)}
    points = set(np.flatnonzero(vertex_bad).tolist()) if len(vertex_bad) else set()
    found = []
    for tet in mesh.tets.tolist():
        mine = [tuple(sorted(tet[:k] + tet[k + 1 :])) in facets for k in range(4)]
        mine += [(min(a, b), max(a, b)) in edges for a in tet for b in tet if a != b]
        found.append(any(mine) or bool(points & set(tet)))
    return found


@pytest.mark.parametrize("halves", [False, True])
@pytest.mark.parametrize("amount", [0.3, 0.4])
def test_misses_are_the_tets_at_what_is_not_as_it_should_be(halves, amount):
    """Of a well-centered tiling in which a few vertices moved."""
    tiling = bcc(4)
    points = tiling.points.copy()
    moved = interior_points(tiling)[::3]
    points[moved] += np.random.default_rng(4).uniform(-amount, amount, (len(moved), 3))
    mesh = TetMesh(points, tiling.tets)
    if halves:
        mesh = replace(mesh, regions=(mesh.points[mesh.tets].mean(axis=1)[:, 0] > 2).astype(np.int64))
    parts = region_parts.apart(mesh)
    dual = compute_duals(parts)
    positive = _at(
        parts, dual.lengths <= dual.errors, dual.areas <= dual.area_errors, dual.volumes <= dual.volume_errors
    )
    measured = quality.measure(mesh)
    assert misses(mesh, measured, one_sided=True).tolist() == positive
    lengths, errors = dual_lengths(mesh)
    radii = quality.circumradii(mesh.points, mesh.tets)
    pairs = mesh.topology.interior_pairs
    encroached = np.zeros(len(lengths), dtype=bool)
    for row, (one, _, other, _) in enumerate(pairs.tolist()):
        encroached[row] = lengths[row] < -errors[row] - 1e-9 * (radii[one] + radii[other]) / 2
    crossed = _at(mesh, encroached, np.zeros(len(mesh.topology.edges), dtype=bool))
    if halves:
        largest = np.zeros(len(dual.lengths))
        for tet, facets in enumerate(parts.topology.tet_facets.tolist()):
            for facet in facets:
                largest[facet] = max(largest[facet], radii[tet])
        squares = (np.diff(parts.points[parts.topology.edges], axis=1)[:, 0] ** 2).sum(axis=1)
        negative = _at(
            parts, dual.lengths < -dual.errors - 1e-9 * largest, dual.areas < -dual.area_errors - 1e-9 * squares
        )
        crossed = [a or b for a, b in zip(crossed, negative, strict=True)]
    assert misses(mesh, measured, one_sided=False).tolist() == crossed
    assert all(0 < sum(one) < len(mesh.tets) for one in (positive, crossed))


def test_nothing_misses_where_all_tets_are_well_centered():
    obtuse = single([[-0.88, 0.42, -0.22], [-0.51, 0.74, -0.45], [-0.06, 0.97, -0.23], [0.67, -0.67, 0.32]])
    measured = quality.measure(obtuse)  # 3WC, with a negative dual area at an obtuse triangle
    assert misses(obtuse, measured, one_sided=True).tolist() == [True]
    assert misses(obtuse, measured, one_sided=False).tolist() == [False]
    for one_sided in (False, True):
        assert not misses(bcc(2), quality.measure(bcc(2)), one_sided=one_sided).any()
