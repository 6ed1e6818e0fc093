"""The inside filled anew: the surface's facets are all there, to the last bit, and the mesh between them is valid."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import ball, delaunay, jittered_cube, kuhn_cube, rotation, two_region_cube

from wct_plugin.core import _core
from wct_plugin.measure import quality
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.topology import Topology
from wct_plugin.meshing.reference import own_boundary
from wct_plugin.meshing.search_mesh import from_mesh


def refill(mesh, **options):
    own = own_boundary(mesh, 40.0)
    return _core.refill(from_mesh(mesh, own, pinned=True), own.sides, **options)


def halves(n=5):
    """A ball in two regions that meet in a jagged sheet."""
    mesh = ball(n)
    return TetMesh(mesh.points, mesh.tets, regions=(mesh.points[mesh.tets].mean(axis=1)[:, 2] > 0).astype(np.int64))


def sheet_inside():
    """A ball with tagged facets across it that part no regions."""
    mesh = halves()
    sheet = mesh.topology.interfaces
    return TetMesh(mesh.points, mesh.tets, facets=Cells(sheet, np.full(len(sheet), 7)))


def edges_inside():
    """A ball with three tagged edges away from its surface."""
    mesh = ball(5)
    deep = ~np.isin(mesh.topology.edges, mesh.topology.boundary_points).any(axis=1)
    return TetMesh(mesh.points, mesh.tets, edges=Cells(mesh.topology.edges[deep][:3], np.arange(3)))


def stretched(by):
    """A valid mesh many of whose surface facets are in no Delaunay triangulation."""
    mesh = jittered_cube(6)
    return TetMesh(mesh.points * by @ rotation(2).T, mesh.tets)


def places(points, cells):
    """Cells by where their points are, not by number."""
    return {tuple(sorted(map(tuple, points[cell].tolist()))) for cell in cells}


def rows(cells):
    return {tuple(row) for row in np.sort(cells, axis=1).tolist()}


def bad_share(points, tets):
    return 1.0 - quality.measure(TetMesh(points, tets)).completely_well_centered.mean()


CASES = {
    "cube": lambda: jittered_cube(5),
    "ball": lambda: ball(5),
    "two regions": halves,
    "sheet": sheet_inside,
    "edges": edges_inside,
    "stretched": lambda: stretched([1.0, 0.8, 1.3]),
    "squares": lambda: kuhn_cube(4),  # both diagonals of a square are Delaunay
    "squares between regions": lambda: two_region_cube(4),
}


@pytest.mark.parametrize("make", CASES.values(), ids=CASES.keys())
def test_the_surface_stays_and_the_rest_is_a_valid_mesh(make):
    mesh = make()
    own = own_boundary(mesh, 40.0)
    found = refill(mesh)
    points, tets, regions = found.points, found.tets, found.regions
    assert (_core.orientation(points, tets) == 1).all()
    topology = Topology(tets, regions, len(points))  # raises where a facet belongs to three tets
    assert places(points, topology.boundary) == places(mesh.points, mesh.topology.boundary)
    assert places(points, topology.interfaces) == places(mesh.points, mesh.topology.interfaces)
    old = found.origin >= 0
    assert np.array_equal(points[old], mesh.points[found.origin[old]])
    place = np.full(len(mesh.points), -1)
    place[found.origin[old]] = np.flatnonzero(old)
    assert (place[own.strata.stratum > 0] >= 0).all()
    facets = np.sort(np.concatenate([tets[:, [1, 2, 3]], tets[:, [0, 2, 3]], tets[:, [0, 1, 3]], tets[:, :3]]), axis=1)
    assert rows(place[own.strata.triangles]) <= rows(facets)
    assert rows(place[own.strata.segments]) <= rows(topology.edges)
    for index, region in enumerate(own.regions):
        volume = quality.volumes(mesh.points, mesh.tets[mesh.regions == region]).sum()
        assert quality.volumes(points, tets[regions == index]).sum() == pytest.approx(volume, rel=1e-12)
    assert len(tets) <= 2.1 * len(mesh.tets)  # relaxing changes the count a little
    assert bad_share(points, tets) < bad_share(mesh.points, mesh.tets)


def test_where_no_delaunay_triangulation_has_a_facet_tets_are_kept():
    """Of a surface stretched at random some facets have no ball that is empty; the tets behind them are the input's."""
    mesh = stretched([1.0, 0.8, 1.3])
    hull = places(mesh.points, delaunay(mesh.points[mesh.topology.boundary_points], 0.0).topology.boundary)
    found = refill(mesh)
    kept = places(found.points, found.tets) & places(mesh.points, mesh.tets)
    missing = places(mesh.points, mesh.topology.boundary) - hull
    assert missing
    assert kept
    assert (found.origin < 0).any()


def test_no_new_point_where_no_apex_can_be():
    """The apex of a 3WC tet lies outside of the smallest ball through the corners of each facet."""
    mesh = ball(5)
    found = refill(mesh)
    new = found.points[found.origin < 0]
    corners = mesh.points[mesh.topology.boundary]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    n = np.cross(u, v)
    square = np.einsum("ij,ij->i", n, n)[:, None]
    to = (
        np.einsum("ij,ij->i", u, u)[:, None] * np.cross(v, n) + np.einsum("ij,ij->i", v, v)[:, None] * np.cross(n, u)
    ) / (2.0 * square)
    center, radius = corners[:, 0] + to, np.linalg.norm(to, axis=1)
    fixed = mesh.points[mesh.topology.boundary_points]
    far = np.linalg.norm(fixed[None] - center[:, None], axis=2)
    empty = (far > radius[:, None] * (1.0 - 1e-9)).all(axis=1)
    assert empty.sum() > 0.9 * len(corners)
    assert (np.linalg.norm(new[None] - center[empty][:, None], axis=2) > radius[empty][:, None]).all()


def test_edges_become_as_long_as_asked():
    mesh = ball(5)
    for length in (0.25, 0.12):
        found = refill(mesh, size=np.full(len(mesh.points), length))
        topology = Topology(found.tets, found.regions, len(found.points))
        inner = topology.edges[(found.origin[topology.edges] < 0).all(axis=1)]
        ends = found.points[inner]
        assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).mean() == pytest.approx(length, rel=0.2)


def test_the_same_bits_twice():
    first, second = refill(ball(4), seed=3), refill(ball(4), seed=3)
    assert all(np.array_equal(getattr(first, name), getattr(second, name)) for name in ("points", "tets", "origin"))


def test_nothing_is_filled_between_points_that_coincide():
    mesh = ball(3)
    two = TetMesh(np.concatenate([mesh.points, mesh.points]), np.concatenate([mesh.tets, mesh.tets + len(mesh.points)]))
    assert len(refill(two).tets) == 0


def test_stopped_early_there_is_nothing():
    heard = []
    found = refill(ball(8), progress=lambda done, bad: heard.append(done) or False)
    assert found.stopped
    assert len(heard) == 1
    assert len(found.tets) == 0 or bad_share(found.points, found.tets) < 1.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"stratum": np.array([0], dtype=np.int8)}, "stratum has length 1"),
        ({"facets": np.zeros((0, 3), dtype=np.int64), "facet_patch": np.zeros(0, dtype=np.int64)}, "facets and tets"),
        ({"creases": np.array([[0, 10**6]])}, "creases names point 1000000"),
    ],
)
def test_arguments_of_no_use_are_refused(change, message):
    mesh = ball(3)
    own = own_boundary(mesh, 40.0)
    start = from_mesh(mesh, own, pinned=True)
    with pytest.raises(ValueError, match=message):
        _core.refill(replace(start, **change), own.sides)
    with pytest.raises(ValueError, match="size has length 1"):
        _core.refill(start, own.sides, size=np.array([1.0]))


def test_how_many_tets_there_will_be_is_asked_where_lengths_are_wanted():
    mesh, heard = kuhn_cube(4), []
    size = np.full(len(mesh.points), 0.1)
    found = refill(mesh, size=size, expected=lambda tets: heard.append(tets) or True)
    assert len(heard) == 1
    assert 0.5 < heard[0] / len(found.tets) < 2.0
    assert len(refill(mesh, size=size / 100.0, expected=lambda _: False).tets) == 0  # some 10 billion tets
    refill(mesh, expected=lambda tets: heard.append(tets) or True)
    assert len(heard) == 1  # no more than twice those of the mesh
