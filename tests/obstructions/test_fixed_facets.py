"""Facets that stay: what they rule out is out of reach however hard one tries, and a little beside it is not."""

import numpy as np
import pytest
from support.builders import jittered_cube, kuhn_cube, kuhn_grid, single, two_region_cube

from wct_plugin.measure import quality
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.strata import find_strata
from wct_plugin.mesh.topology import FACETS
from wct_plugin.obstructions import find_reasons, fixed_facets


def found(mesh, goal, boundary="fixed"):
    every = np.arange(len(mesh.tets))
    return find_reasons(mesh, find_strata(mesh), every, goal=goal, boundary=boundary, connectivity="free")


def verdicts(mesh, goal, boundary="fixed"):
    """Per tet the first theorem about it."""
    out = [""] * len(mesh.tets)
    for reason in reversed(found(mesh, goal, boundary)):
        for tet in reason.tets:
            out[tet] = reason.why
    return out


def verdict(points, goal):
    return verdicts(single(points), goal)[0]


def ruled_out(mesh, of, acute):
    """Rows of all facets of the surface, each with a side wherever it bounds a region."""
    sides = np.zeros((len(of.triangles), 2), dtype=int)
    sides[: len(mesh.topology.boundary), 1] = -1
    return fixed_facets.ruled_out(mesh.points, of.triangles, sides, acute=acute)


def triples(rows):
    return {tuple(row) for row in np.sort(rows, axis=-1).reshape(-1, 3).tolist()}


def test_a_right_facet_rules_out_cwc_to_the_last_bit():
    tet = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 0.9, 0], [0.5, 0.4, 0.8]])
    assert verdict(tet, "cwc") == verdict(tet, "2wc") == ""
    right = tet.copy()
    right[2] = [0, 1, 0]
    right[3] = [0.45, 0.45, 0.9]
    assert verdict(right, "cwc") == verdict(right, "2wc") == fixed_facets.NOT_ACUTE
    right[2, 0] = np.nextafter(0.0, 1.0)  # the angle is now acute by less than any rounding error
    assert verdict(right, "cwc") == ""


def test_a_right_facet_with_no_room_rules_out_3wc():
    """Over the long edge of a right facet the tet must lean out by more than 90 degrees, to the last bit."""
    base = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert verdict([*base, [0.4, 0.4, 0.9]], "3wc") == fixed_facets.NO_ROOM
    assert verdict([*base, [0.5, 0.5, 0.9]], "3wc") == fixed_facets.NO_ROOM
    assert verdict([*base, [np.nextafter(0.5, 1.0), 0.5, 0.9]], "3wc") == ""
    assert verdict([*base, [0.7, 0.7, 0.9]], "3wc") == ""


@pytest.mark.parametrize(("apex", "lean", "possible"), [(0.0, 0.0, False), (0.0, 1.0, True), (0.03, 0.0, True)])
def test_a_tet_on_a_right_facet_has_no_room_within_90_degrees(apex, lean, possible):
    """The third vertex moves freely in the upright plane on the longest edge, or within 1 degree beyond it.

    With ``apex`` a facet of less than 90 degrees stands there.
    """
    base = np.array([[0.5, 0, 0], [-0.5, 0, 0], [0, -0.5 - apex, 0]])
    rng = np.random.default_rng(1)
    outward = np.array([0.0, np.sin(np.radians(lean)), np.cos(np.radians(lean))])
    corners = outward * rng.uniform(0.01, 3.0, (30000, 1)) + [1.0, 0, 0] * rng.uniform(-1, 1, (30000, 1))
    tets = np.concatenate([np.broadcast_to(base, (30000, 3, 3)), corners[:, None]], axis=1)
    mesh = TetMesh(tets.reshape(-1, 3), np.arange(120000).reshape(-1, 4)[:, [0, 2, 1, 3]])
    best = quality.measure(mesh).min_height.max()
    assert (best > 1e-3) if possible else (best <= 1e-12)
    assert verdict(tets[0], "3wc") == ("" if possible else fixed_facets.NO_ROOM)


@pytest.mark.parametrize(("apex", "possible"), [(0.5, False), (0.45, False), (0.52, True)])
def test_two_flat_facets_at_one_edge_cannot_both_carry_3wc_tets(apex, possible):
    """Two triangles in a plane share their longest edge: their tets have 180 degrees there between them."""
    points = np.array([[0.5, 0, 0], [-0.5, 0, 0], [0, -apex, 0], [0, apex, 0], [0, -0.4, 0.7], [0, 0.4, 0.7]])
    mesh = TetMesh(points, np.array([[0, 1, 2, 4], [0, 3, 1, 5], [0, 1, 4, 5]]))
    blamed = [(one.cells, one.tets) for one in found(mesh, "3wc") if one.why == fixed_facets.NO_ROOM_FOR_TWO]
    assert blamed == ([] if possible else [(((0, 1, 2), (0, 1, 3), (0, 1)), (0, 1))])
    corners = np.random.default_rng(0).uniform([-1, -1, 0.01], [1, 1, 2], (40000, 3))
    tets = np.concatenate([np.broadcast_to(points[:3], (40000, 3, 3)), corners[:, None]], axis=1)
    many = TetMesh(tets.reshape(-1, 3), np.arange(160000).reshape(-1, 4))
    good = corners[quality.measure(many).min_height > 0.0]
    assert len(good) > 1000
    smallest = np.degrees(np.arctan2(good[:, 2], -good[:, 1])).min()  # dihedral angle at the edge
    assert (2.0 * smallest < 180.0) == possible


def test_a_dihedral_angle_above_90_is_needed_at_the_longest_edge_of_a_facet_that_is_not_acute():
    """The theorem itself on random tets that contain their circumcenter."""
    rng = np.random.default_rng(0)
    points = rng.normal(size=(200_000, 4, 3))
    points /= np.linalg.norm(points, axis=2)[..., None]
    mesh = TetMesh(points.reshape(-1, 3), np.arange(800_000).reshape(-1, 4))
    good = points[quality.measure(mesh).min_height > 0]
    tried = 0
    for facet in FACETS:
        opposite = (set(range(4)) - set(facet.tolist())).pop()
        for k in range(3):
            apex, one, two = (good[:, facet[(k + j) % 3]] for j in range(3))
            wide = np.einsum("ij,ij->i", one - apex, two - apex) <= 0
            edge = (two - one)[wide]
            n = [np.cross(edge, (x - one)[wide]) for x in (apex, good[:, opposite])]
            assert (np.einsum("ij,ij->i", *n) < 0).all()
            tried += wide.sum()
    assert tried > 5000


def test_no_cube_face_may_be_two_right_triangles():
    """Every facet of Kuhn's cube is one half of a square: nothing fixed can be 3WC there."""
    mesh = kuhn_cube(3)
    said = verdicts(mesh, "3wc")
    assert set(said) == {"", fixed_facets.NO_ROOM_FOR_TWO}
    assert {t for t, why in enumerate(said) if why} == set(mesh.topology.boundary_half_facets[:, 0].tolist())
    assert len(found(mesh, "3wc")) == 6 * 9


def test_no_proof_is_refuted_by_a_well_centered_tet():
    """Random tets that contain their circumcenter: whatever their facets, nothing rules them out."""
    points = np.random.default_rng(0).normal(size=(4000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    tets = np.arange(4000).reshape(-1, 4)
    measured = quality.measure(TetMesh(points, tets))
    good, acute = measured.well_centered_3, measured.well_centered_2
    for tet in tets[good]:
        assert found(single(points[tet]), "3wc") == []
    for tet in tets[good & acute][:10]:
        assert found(single(points[tet]), "cwc") == []
    for tet in tets[good & ~acute]:
        assert found(single(points[tet]), "cwc") != []
    assert (
        good & ~acute
    ).sum() > 10  # some of them have facets that are not acute, where the proofs have something to say


def test_facets_that_are_not_fixed_rule_nothing_out():
    mesh = kuhn_grid((3, 3, 3))
    assert found(mesh, "cwc", "keep") == found(mesh, "cwc", "move") == []
    surface = triples(mesh.topology.boundary)
    for tet, why in zip(mesh.tets, verdicts(mesh, "cwc"), strict=True):
        assert bool(why) == bool(triples(tet[FACETS]) & surface)


@pytest.mark.parametrize("goal", ["cwc", "3wc"])
def test_an_interface_is_fixed_from_both_sides(goal):
    mesh = two_region_cube(2)
    said = verdicts(mesh, goal)
    assert all(said[tet] for tet in mesh.topology.interface_pairs[:, [0, 2]].ravel())


@pytest.mark.parametrize("goal", ["cwc", "3wc"])
def test_a_tagged_facet_inside_is_fixed_from_both_sides(goal):
    """The tags make the same surface as two regions would."""
    parts = two_region_cube(2)
    interface = parts.topology.interfaces
    cube = TetMesh(parts.points, parts.tets)
    assert set(map(str, found(parts, goal))) > set(map(str, found(cube, goal)))
    order = np.random.default_rng(0).permutation(len(interface))
    tagged = TetMesh(parts.points, parts.tets, facets=Cells(interface[order], np.full(len(interface), 7)))
    assert verdicts(tagged, goal) == verdicts(parts, goal)


@pytest.mark.parametrize("goal", ["cwc", "3wc"])
def test_facets_ruled_out_are_those_that_rule_out_each_tet_on_them(goal):
    mesh = TetMesh(*(lambda m: (m.points * [1.0, 0.9, 1.2], m.tets))(jittered_cube(3)))
    of = find_strata(mesh)
    rows = ruled_out(mesh, of, acute=goal == "cwc")
    out = triples(of.triangles[rows])
    for tet, why in zip(mesh.tets, verdicts(mesh, goal), strict=True):
        assert bool(why) == bool(triples(tet[FACETS]) & out)
    assert 0 < len(rows) < len(of.triangles)


@pytest.mark.parametrize("acute", [True, False])
def test_every_facet_of_kuhns_cube_rules_its_tets_out(acute):
    mesh = two_region_cube(2)  # the interface's facets from both sides
    of = find_strata(mesh)
    assert np.array_equal(ruled_out(mesh, of, acute=acute), np.arange(len(of.triangles)))


def test_a_facet_is_not_ruled_out_where_one_side_has_room():
    """Of an interface along a right edge one side may have room for the tet that leans out, the other not."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.7, 0.7, 0.9], [0.3, 0.3, -0.9]])
    tets = np.array([[0, 1, 2, 3], [0, 2, 1, 4]])
    mesh = TetMesh(points, tets, regions=np.array([1, 2]))
    of = find_strata(mesh)
    assert fixed_facets.NO_ROOM in [
        one.why for one in found(mesh, "3wc") if (0, 1, 2) in one.cells and one.tets == (1,)
    ]
    assert not any((0, 1, 2) in one.cells for one in found(mesh, "3wc") if one.tets == (0,))
    rows = ruled_out(mesh, of, acute=False)
    assert (0, 1, 2) not in triples(of.triangles[rows])


def test_three_sheets_at_an_edge():
    """A wall parts a wedge of 143 degrees: neither side leaves room, and no two facets are in one wedge twice."""
    points = np.array([[5.0, 0, 0], [-5, 0, 0], [0, 5, 0], [0, 3, 4], [0, -4, 3]])
    mesh = TetMesh(points, np.array([[1, 0, 2, 3], [1, 0, 3, 4]]), regions=np.array([1, 2]))
    alone = {(one.cells[0], one.tets) for one in found(mesh, "3wc") if one.why == fixed_facets.NO_ROOM}
    assert alone == {((0, 1, 2), (0,)), ((0, 1, 3), (0,)), ((0, 1, 3), (1,)), ((0, 1, 4), (1,))}
    wide = points * [1.0, 1.5, 1.5]  # acute: every facet has an angle below 90 degrees there
    assert not any((0, 1) in one.cells for one in found(TetMesh(wide, mesh.tets, regions=mesh.regions), "3wc"))
