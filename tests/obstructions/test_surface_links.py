"""Flat patches and straight creases: what is ruled out stays out of reach, and what is next to it does not."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import rotation
from support.trying import clearance, improved, inside_of, part_of_a_star

import wct_plugin as wct
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.strata import find_strata
from wct_plugin.obstructions import find_reasons, surface_links


def found(mesh, goal="2wc", boundary="slide"):
    every = np.arange(len(mesh.tets))
    return find_reasons(mesh, find_strata(mesh), every, goal=goal, boundary=boundary, connectivity="fixed")


def said_at(mesh, vertex, **options):
    return {one.why for one in found(mesh, **options) if one.cells[0] == (vertex,)}


def tagged(points, tets):
    """The mesh with each of its flat faces through vertex 0 tagged, however small it is."""
    mesh = TetMesh(points, tets)
    triangles = mesh.topology.boundary[(mesh.topology.boundary == 0).any(axis=1)]
    plane = points[triangles].any(axis=1) @ [1, 2, 4]
    return replace(mesh, facets=Cells(triangles, plane))


def on_a_face(count, above, seed):
    """Vertex 0 in a face z = 0 with ``count`` neighbours there and ``above`` others; and what may move of them."""
    rng = np.random.default_rng(seed)
    angle = 2 * np.pi * (np.arange(count) + rng.uniform(-0.2, 0.2, count)) / count
    rim = np.column_stack([np.cos(angle), np.sin(angle)])
    points, tets = part_of_a_star(rim, inside_of(rim, above, rng), half_sphere)
    points[1 : count + 1, 2] = 0.0
    free = np.ones_like(points, dtype=bool)
    free[0] = False
    free[1 : count + 1, 2] = False
    return points, tets, free


def half_sphere(flat):
    return np.column_stack([flat, np.sqrt(np.maximum(0.0, 1.0 - (flat**2).sum(axis=1)))])


def best_on_a_face(count, above, seeds):
    starts = [on_a_face(count, above, seed) for seed in seeds]
    return max(clearance(improved(points, tets, free, "2wc"), tets, "2wc") for points, tets, free in starts)


@pytest.mark.parametrize(("count", "above", "why"), [(3, 5, "few"), (4, 6, "few"), (6, 1, "spanned")])
def test_a_face_vertex_with_few_facets_or_a_spanned_plane_never_has_acute_facets(count, above, why):
    theorem = {"few": surface_links.FEW_FACETS, "spanned": surface_links.SPANNED}[why]
    for seed in range(2):
        mesh = tagged(*on_a_face(count, above, seed)[:2])
        assert theorem in said_at(mesh, 0)
        assert said_at(mesh, 0, goal="3wc") == set()
    assert best_on_a_face(count, above, range(3)) < 1e-12


def test_a_face_vertex_with_five_facets_has_acute_ones():
    for seed in range(40):
        points, tets, free = on_a_face(5, 6, seed)
        open_to_all = not said_at(tagged(points, tets), 0)
        if open_to_all and clearance(improved(points, tets, free, "2wc"), tets, "2wc") > 0.02:
            return
    pytest.fail("none found")


def test_which_neighbours_span():
    ring = [1, 2, 3, 4, 5]
    pairs = np.array([[9, 1], [3, 9], [9, 5], [8, 1], [8, 3], [1, 2], [7, 9]])
    assert list(surface_links._spanning(ring, pairs)) == [9]
    assert list(surface_links._spanning(ring, pairs[1:])) == []  # 1 and 2 follow each other, neither is joined to 9


def on_an_edge(one, two, inner, seed):
    """Vertex 0 on the edge between faces y = 0 and x = 0, with its neighbours on the edge, on each face and inside."""
    rng = np.random.default_rng(seed)
    turn = [np.pi * (np.arange(1, n + 1) + rng.uniform(-0.2, 0.2, n)) / (n + 1) for n in (one, two)]
    angle = np.concatenate([[np.pi, 0.0], np.pi + turn[0], np.pi - turn[1]])
    rim = np.column_stack([np.cos(angle), np.sin(angle)])
    points, tets = part_of_a_star(rim, inside_of(rim, inner, rng), quarter_sphere)
    if not inner:
        tets = strip(one, two)
    points[1:3, :2] = points[3 : 3 + one, 1] = points[3 + one : 3 + one + two, 0] = 0.0
    free = np.ones_like(points, dtype=bool)
    free[:3] = False
    free[3 : 3 + one, 1] = False
    free[3 + one : 3 + one + two, 0] = False
    return points, tets, free


def strip(one, two):
    """Tets at vertex 0 that zigzag between its neighbours on the two faces, from end to end of the edge."""
    left, right = [1, *range(3, 3 + one), 2], [1, *range(3 + one, 3 + one + two), 2]
    tets = [[0, left[0], left[1], right[1]]]
    i, j = 1, 1
    while i < one or j < two:
        if i < one and (i <= j or j == two):
            tets.append([0, left[i], left[i + 1], right[j]])
            i += 1
        else:
            tets.append([0, left[i], right[j + 1], right[j]])
            j += 1
    return np.array([*tets, [0, left[one], 2, right[two]]])[:, [1, 0, 2, 3]]


def quarter_sphere(flat):
    """Lower half circle to y = 0, upper one to x = 0, from end to end of the edge along z."""
    across = np.sqrt(np.maximum(1e-30, 1.0 - flat[:, 0] ** 2))
    turn = np.pi / 4 * (1.0 + np.clip(flat[:, 1] / across, -1.0, 1.0))
    return np.column_stack([across * np.cos(turn), across * np.sin(turn), flat[:, 0]])


@pytest.mark.parametrize(("one", "two", "inner", "why"), [(1, 2, 4, "few"), (2, 2, 0, "along"), (3, 2, 0, "along")])
def test_an_edge_vertex_with_few_facets_or_a_short_way_along_it_never_has_acute_facets(one, two, inner, why):
    theorem = {"few": surface_links.FEW_FACETS, "along": surface_links.ALONG_CREASE}[why]
    best = -1.0
    for seed in range(3):
        points, tets, free = on_an_edge(one, two, inner, seed)
        if clearance(points, tets, "2wc") > -1.0:
            assert theorem in said_at(tagged(points, tets), 0)
            best = max(best, clearance(improved(points, tets, free, "2wc"), tets, "2wc"))
    assert -1.0 < best < 1e-12


def test_an_edge_vertex_with_inner_neighbours_between_the_faces_has_acute_facets():
    for seed in range(60):
        points, tets, free = on_an_edge(2, 2, 3, seed)
        open_to_all = clearance(points, tets, "2wc") > -1.0 and not said_at(tagged(points, tets), 0)
        if open_to_all and clearance(improved(points, tets, free, "2wc"), tets, "2wc") > 0.02:
            return
    pytest.fail("none found")


def test_faces_closer_than_90_degrees_do_not_connect():
    """On faces 63 degrees apart two neighbours may lie to different sides along the edge, and yet at an acute angle."""
    points, tets, _ = on_an_edge(2, 2, 0, 0)
    assert surface_links.ALONG_CREASE in said_at(tagged(points, tets), 0)
    sheared = points @ np.array([[1.0, 0, 0], [0.5, 1, 0], [0, 0, 1]])
    assert surface_links.ALONG_CREASE not in said_at(tagged(sheared, tets), 0)
    wide = points @ np.array([[1.0, 0, 0], [-0.5, 1, 0], [0, 0, 1]])
    assert surface_links.ALONG_CREASE in said_at(tagged(wide, tets), 0)


def corner_of(turn, count):
    """A corner, vertex 0, of a flat face that fills an angle there between two creases, and a vertex above."""
    x, y = {90: (0, 1), 135: (-1, 1), 180: (-1, 0), 225: (-1, -1), 270: (0, -1), 300: (1, -2)}[turn]
    between = np.linspace(0.0, np.arctan2(y, x) % (2.0 * np.pi), count + 1)[1:-1]
    ring = np.array([[1.0, 0, 0], *([np.cos(t), np.sin(t), 0.0] for t in between), [x, y, 0]])
    points = np.concatenate([np.zeros((1, 3)), ring, [[0.0, 0.1, 1.0]]])
    tets = np.array([[0, k, k + 1, count + 2] for k in range(1, count + 1)])
    mesh = TetMesh(points, tets)
    return replace(mesh, facets=Cells(tets[:, :3], [1] * count), nodes=Cells(np.array([[0]]), [1]))


@pytest.mark.parametrize(
    ("turn", "count", "few"),
    [(90, 2, False), (180, 2, True), (135, 2, False), (225, 2, True), (225, 3, False), (270, 3, True), (300, 3, True)],
)
def test_a_corner_that_stays_needs_a_facet_more_than_its_quarter_turns(turn, count, few):
    assert (surface_links.FEW_FACETS in said_at(corner_of(turn, count), 0)) == few


CUBES = {"3wc": ["30", "32", "33"], "cwc": ["84", "104", "194", "194_best"]}


@pytest.mark.parametrize(("goal", "variant"), [(goal, name) for goal, names in CUBES.items() for name in names])
def test_no_theorem_is_refuted_by_the_well_centered_cubes(goal, variant):
    """All tets are looked at as if they were bad; in no place may the goal be out of reach."""
    mesh, _ = wct.apply_filter("create_cube", variant=variant)
    for boundary in ("slide", "fixed"):
        assert found(mesh, goal, boundary) == []
    every = np.arange(len(mesh.tets))
    assert find_reasons(mesh, find_strata(mesh), every, goal=goal, boundary="fixed", connectivity="free") == []


def test_patches_that_are_flat_but_for_rounding_are_left_alone():
    mesh = tagged(*on_a_face(4, 6, 0)[:2])
    assert said_at(mesh, 0) == {surface_links.FEW_FACETS}
    assert said_at(replace(mesh, points=mesh.points @ rotation(1).T), 0) == set()
