"""Topology against brute force on small meshes."""

from collections import Counter, defaultdict
from itertools import combinations, pairwise

import numpy as np
import pytest
from support.builders import ball, bcc, jittered_cube, kuhn_cube, l_shape, two_region_cube

from wct_plugin.errors import InputError
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import EDGES, FACETS, Topology, crowded_facets, folded_pairs

MESHES = {
    "kuhn": kuhn_cube(2),
    "jittered": jittered_cube(3),
    "regions": two_region_cube(2),
    "l": l_shape(1),
    "bcc": bcc(2),
    "ball": ball(3),
}


@pytest.fixture(params=MESHES)
def mesh(request):
    return MESHES[request.param]


def by_facet(mesh):
    out = defaultdict(list)
    for tet, corners in enumerate(mesh.tets):
        for local in range(4):
            out[frozenset(corners[FACETS[local]].tolist())].append((tet, local))
    return out


def test_tables():
    for local, facet in enumerate(FACETS):
        assert set(facet) == set(range(4)) - {local}
    assert [tuple(edge) for edge in EDGES] == list(combinations(range(4), 2))
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    for local, (a, b, c) in enumerate(FACETS):
        normal = np.cross(corners[b] - corners[a], corners[c] - corners[a])
        assert normal @ (corners[local] - corners[a]) < 0  # outward


def test_adjacency_and_pairs(mesh):
    facets = by_facet(mesh)
    expected = np.full((len(mesh.tets), 4), -1)
    pairs, single = set(), set()
    for sides in facets.values():
        if len(sides) == 2:
            (t, i), (u, j) = sides
            expected[t, i], expected[u, j] = u, t
            pairs.add((t, i, u, j))
        else:
            single.add(sides[0])
    assert (mesh.topology.adjacency == expected).all()
    assert set(map(tuple, mesh.topology.interior_pairs.tolist())) == pairs
    assert set(map(tuple, mesh.topology.boundary_half_facets.tolist())) == single
    assert (np.diff(mesh.topology.interior_pairs[:, 0] * 4 + mesh.topology.interior_pairs[:, 1]) > 0).all()
    across = {(t, u) for t, _, u, _ in pairs if mesh.regions[t] != mesh.regions[u]}
    assert {(t, u) for t, _, u, _ in mesh.topology.interface_pairs.tolist()} == across
    for triangle, (t, _, u, _) in zip(mesh.topology.interfaces, mesh.topology.interface_pairs, strict=True):
        assert set(triangle) == set(mesh.tets[t]) & set(mesh.tets[u])


def test_boundary_is_closed_and_outward(mesh):
    boundary = mesh.topology.boundary
    directed = Counter((a, b) for t in boundary.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True))
    assert all(directed[b, a] == count for (a, b), count in directed.items())
    corners = mesh.points[boundary]
    inside = np.linalg.det(corners).sum() / 6.0
    tets = mesh.points[mesh.tets]
    assert inside == pytest.approx(np.linalg.det(tets[:, 1:] - tets[:, :1]).sum() / 6.0)
    mask = np.zeros(len(mesh.points), dtype=bool)
    mask[boundary.ravel()] = True
    assert (mesh.topology.boundary_points == mask).all()


def test_interface_triangles_leave_their_first_tet():
    mesh = two_region_cube(2)
    topology = mesh.topology
    assert len(topology.interfaces) == 8
    for triangle, (tet, local, *_) in zip(topology.interfaces, topology.interface_pairs, strict=True):
        a, b, c = mesh.points[triangle]
        apex = mesh.points[mesh.tets[tet, local]]
        assert np.cross(b - a, c - a) @ (apex - a) < 0


def test_edges_and_valence(mesh):
    counts = Counter(tuple(sorted(pair)) for tet in mesh.tets.tolist() for pair in combinations(tet, 2))
    assert [tuple(edge) for edge in mesh.topology.edges.tolist()] == sorted(counts)
    assert mesh.topology.edge_valence.tolist() == [counts[edge] for edge in sorted(counts)]


def test_euler_characteristic_of_a_ball(mesh):
    topology = mesh.topology
    facets = len(topology.interior_pairs) + len(topology.boundary)
    assert len(mesh.points) - len(topology.edges) + facets - len(mesh.tets) == 1
    assert topology.components.tolist() == [0] * len(mesh.tets)


def test_components_join_through_facets_only():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [1, 1, 1]], dtype=float)
    mesh = TetMesh(points, [[0, 1, 2, 3], [0, 3, 4, 5], [1, 2, 3, 6]])  # the second touches in an edge
    assert mesh.topology.components.tolist() == [0, 1, 0]


def test_three_tets_on_a_facet_are_refused_when_asked_for():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -1], [0, 0, 2]], dtype=float)
    mesh = TetMesh(points, [[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]])
    with pytest.raises(InputError, match=r"^facet \(0, 1, 2\) belongs to tets 0, 1 and 2; at most two may share one$"):
        _ = mesh.topology.adjacency


@pytest.mark.parametrize("seed", range(5))
def test_facets_are_found_as_a_dictionary_of_them_finds_them(seed):
    rng = np.random.default_rng(seed)
    tets = np.array([rng.choice(9, 4, replace=False) for _ in range(60)])
    tets_at = {}
    for t, tet in enumerate(tets.tolist()):
        for corner in range(4):
            tets_at.setdefault(tuple(sorted(tet[:corner] + tet[corner + 1 :])), []).append(t)
    crowded = [[*facet, *at[:3]] for facet, at in sorted(tets_at.items()) if len(at) > 2]
    assert crowded
    assert crowded_facets(tets, 9).tolist() == crowded
    pairs, _ = folded_pairs(tets)
    assert pairs.tolist() == [list(pair) for _, at in sorted(tets_at.items()) for pair in pairwise(at)]


def test_point_numbers_may_be_large():
    mesh = kuhn_cube(2)
    spread = Topology(mesh.tets * 100_000, mesh.regions, 100_000 * len(mesh.points))
    assert (spread.adjacency == mesh.topology.adjacency).all()
    assert (spread.edges == mesh.topology.edges * 100_000).all()


@pytest.mark.parametrize("mesh", [two_region_cube(2), jittered_cube(3)])
def test_rows_of_edges_and_facets(mesh):
    topology = mesh.topology
    assert np.array_equal(topology.edges[topology.tet_edges], np.sort(mesh.tets[:, EDGES], axis=2))
    named = np.sort(topology.facets, axis=1)
    assert np.array_equal(named[topology.tet_facets], np.sort(mesh.tets[:, FACETS], axis=2))
    assert len(np.unique(named, axis=0)) == len(named)
    assert np.array_equal(topology.facets[len(topology.interior_pairs) :], topology.boundary)
    opposite = np.sort(topology.facets[:, [[1, 2], [2, 0], [0, 1]]], axis=2)
    assert np.array_equal(topology.edges[topology.facet_edges], opposite)
