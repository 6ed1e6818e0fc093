"""What is left: the class of each tet, which option would free it, and proofs that nothing else would."""

import json
from dataclasses import replace

import numpy as np
import pytest
from builders import cylinder, jittered_cube, kuhn_cube, kuhn_grid, regular_tet, single, two_region_cube

from wct_plugin import fixed_facets, quality
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.remaining import CLASSES, remaining, rows, title
from wct_plugin.surface import strata
from wct_plugin.topology import FACETS


def left(mesh, goal="cwc", boundary="move", crease_angle=40.0, stopped=False):
    of = strata(mesh, crease_angle)
    return remaining(
        mesh, of, quality.measure(mesh), goal=goal, boundary=boundary, crease_angle=crease_angle, stopped=stopped
    )


@pytest.mark.parametrize("goal", ["3wc", "cwc"])
def test_every_bad_tet_is_listed_once_worst_first(goal):
    mesh = jittered_cube(4, 1)
    measured = quality.measure(mesh)
    good = measured.completely_well_centered if goal == "cwc" else measured.well_centered_3
    found = left(mesh, goal)
    assert sorted(tet["tet"] for tet in found["tets"]) == np.flatnonzero(~good).tolist()
    assert found["count"] == len(found["tets"]) == sum(found["by_place"].values())
    worst = [
        min(t["min_height"], np.cos(np.radians(t["max_face_angle"])) if goal == "cwc" else 1) for t in found["tets"]
    ]
    assert worst == sorted(worst)
    of = strata(mesh)
    for tet in found["tets"]:
        assert tet["place"] == CLASSES[max(of.stratum[v] for v in mesh.tets[tet["tet"]])]
        assert ("3WC" in tet["misses"]) == (not measured.well_centered_3[tet["tet"]])
        assert ("goal=3wc" in tet["option"]) == bool(measured.well_centered_3[tet["tet"]])
    assert json.loads(json.dumps(found)) == found
    assert len(rows(found, 7)) == 7
    assert title(found).startswith(f"{found['count']} tets miss the goal: {found['by_place']['interior']} interior")


def test_nothing_is_left_of_a_regular_tet():
    assert left(regular_tet()) == {"count": 0, "by_place": dict.fromkeys(CLASSES, 0), "proven": 0, "tets": []}


def options(found):
    """Class -> the options named for it, without the hint about the goal."""
    out = {}
    for tet in found["tets"]:
        out.setdefault(tet["place"], set()).add(tet["option"].removesuffix(", or goal=3wc"))
    return out


def test_options_of_a_polyhedron():
    mesh = jittered_cube(5, 0)
    moved = options(left(mesh))
    assert moved == {
        "interior": {"a larger effort"},
        "patch": {"a larger effort"},
        "crease": {"a smaller edge_length"},
        "corner": {"a smaller edge_length"},
    }
    kept = options(left(mesh, boundary="keep"))
    assert kept == {"interior": {"a larger effort"}} | {name: {"boundary=move"} for name in CLASSES[1:]}
    fixed = options(left(mesh, boundary="fixed"))
    assert fixed == {"interior": {"a larger effort"}} | {name: {"boundary=keep or move"} for name in CLASSES[1:]}
    assert {tet["option"] for tet in left(mesh, goal="3wc", stopped=True)["tets"]} == {"more time: it was stopped"}


def test_options_on_a_curved_surface_and_at_slight_creases():
    """A prism of 8 sides bends by 45 degrees at its long edges, and by 90 round its ends."""
    mesh = cylinder(8, 4)
    smooth = options(left(mesh, crease_angle=50.0))
    assert smooth["patch"] == {"a larger tolerance, or a smaller edge_length"}
    assert smooth["crease"] == {"a larger tolerance, or a smaller edge_length"}
    creased = left(mesh, crease_angle=40.0)
    at = {True: set(), False: set()}
    of = strata(mesh, 40.0)
    for tet in creased["tets"]:
        vertices = mesh.tets[tet["tet"]]
        ends = np.isin(mesh.points[vertices[of.stratum[vertices] >= 2]][:, 2], [0.0, 2.0]).any()
        at[bool(ends)].add(tet["option"].removesuffix(", or goal=3wc"))
    assert at == {False: {"a crease_angle above 45.0°: the crease bends no more"}, True: {"a smaller edge_length"}}


def test_a_crease_that_a_tag_makes_is_not_blamed_on_the_angle():
    mesh = cylinder(8, 4)
    triangles = mesh.topology.boundary
    tags = (mesh.points[triangles].mean(axis=1)[:, 2] > 1).astype(int)
    tagged = replace(mesh, facets=Cells(triangles, tags))
    of = strata(tagged, 50.0)
    found = options(left(tagged, crease_angle=50.0))
    assert (of.stratum[mesh.points[:, 2] == 1.0] >= 2).any()
    assert not any("crease_angle" in option for said in found.values() for option in said)


# --- proofs for fixed facets ----------------------------------------------------------------------------------------


def verdict(points, acute, tets=((0, 1, 2, 3),)):
    mesh = TetMesh(np.asarray(points, dtype=float), np.asarray(tets))
    return fixed_facets.verdicts(mesh, np.arange(len(mesh.tets)), strata(mesh), acute=acute)


def test_a_right_facet_rules_out_cwc_to_the_last_bit():
    tet = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 0.9, 0], [0.5, 0.4, 0.8]])
    assert verdict(tet, acute=True) == [""]
    right = tet.copy()
    right[2] = [0, 1, 0]
    right[3] = [0.45, 0.45, 0.9]
    assert verdict(right, acute=True) == [fixed_facets.NOT_ACUTE]
    right[2, 0] = np.nextafter(0.0, 1.0)  # the angle is now acute by less than any rounding error
    assert verdict(right, acute=True) == [""]


def test_a_right_facet_with_no_room_rules_out_3wc():
    """Over the long edge of a right facet the tet must lean out by more than 90 degrees."""
    base = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert verdict([*base, [0.4, 0.4, 0.9]], acute=False) == [fixed_facets.NO_ROOM]
    assert verdict([*base, [0.7, 0.7, 0.9]], acute=False) == [""]


def test_no_cube_face_may_be_two_right_triangles():
    """Every facet of Kuhn's cube is one half of a square: nothing fixed can be 3WC there."""
    mesh = kuhn_cube(3)
    found = left(mesh, goal="3wc", boundary="fixed")
    of_boundary = np.unique(mesh.topology.boundary_half_facets[:, 0])
    assert {tet["tet"] for tet in found["tets"] if tet["proof"]} == set(of_boundary.tolist())
    assert found["proven"] == len(of_boundary)
    assert {tet["proof"] for tet in found["tets"]} <= {"", fixed_facets.NO_ROOM, fixed_facets.NO_ROOM_FOR_TWO}


@pytest.mark.parametrize("seed", range(2))
def test_no_proof_is_refuted_by_a_well_centered_tet(seed):
    """Random tets that contain their circumcenter: whatever their facets, nothing rules them out."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(4000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    tets = points.reshape(-1, 4, 3)
    checked = 0
    for tet in tets:
        mesh = single(tet)
        measured = quality.measure(mesh)
        if measured.well_centered_3[0]:
            checked += not measured.well_centered_2[0]
            of = strata(mesh)
            assert fixed_facets.verdicts(mesh, np.array([0]), of, acute=False) == [""]
            said = fixed_facets.verdicts(mesh, np.array([0]), of, acute=True)[0]
            assert (said == "") == bool(measured.well_centered_2[0])
    assert checked > 10  # some of them have facets that are not acute, where the proofs have something to say


def test_facets_that_are_not_fixed_rule_nothing_out():
    mesh = kuhn_grid((3, 3, 3))
    found = left(mesh, boundary="keep")
    assert found["proven"] == 0
    inner = left(mesh, boundary="fixed")
    surface = {tuple(row) for row in np.sort(mesh.topology.boundary, axis=1).tolist()}
    for tet in inner["tets"]:
        facets = {tuple(row) for row in np.sort(mesh.tets[tet["tet"]][FACETS], axis=1).tolist()}
        assert bool(tet["proof"]) == bool(facets & surface)


def test_an_interface_is_fixed_from_both_sides():
    mesh = two_region_cube(2)
    proven = {tet["tet"] for tet in left(mesh, boundary="fixed")["tets"] if tet["proof"]}
    assert set(mesh.topology.interface_pairs[:, [0, 2]].ravel().tolist()) <= proven


@pytest.mark.parametrize("acute", [True, False])
def test_facets_ruled_out_are_those_that_rule_out_each_tet_on_them(acute):
    mesh = TetMesh(*(lambda m: (m.points * [1.0, 0.9, 1.2], m.tets))(jittered_cube(3)))
    of = strata(mesh)
    found = fixed_facets.ruled_out(mesh, of, acute=acute)
    facets = {tuple(row) for row in np.sort(of.triangles[found], axis=1).tolist()}
    said = fixed_facets.verdicts(mesh, np.arange(len(mesh.tets)), of, acute=acute)
    for tet, why in zip(mesh.tets, said, strict=True):
        assert bool(why) == any(tuple(row) in facets for row in np.sort(tet[FACETS], axis=1).tolist())
    assert 0 < len(found) < len(of.triangles)


def test_every_facet_of_kuhns_cube_rules_its_tets_out():
    mesh = two_region_cube(2)  # the interface's facets from both sides
    of = strata(mesh)
    assert np.array_equal(fixed_facets.ruled_out(mesh, of, acute=True), np.arange(len(of.triangles)))
    flat = fixed_facets.ruled_out(mesh, of, acute=False)
    assert len(flat) == len(of.triangles)  # no square may be two right triangles


def test_a_facet_is_not_ruled_out_where_one_side_has_room():
    """Of an interface along a right edge one side may have room for the tet that leans out, the other not."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.7, 0.7, 0.9], [0.3, 0.3, -0.9]])
    tets = np.array([[0, 1, 2, 3], [0, 2, 1, 4]])
    mesh = TetMesh(points, tets, regions=np.array([1, 2]))
    of = strata(mesh)
    shared = {0, 1, 2}
    assert fixed_facets.verdicts(mesh, np.array([1]), of, acute=False) == [fixed_facets.NO_ROOM]
    ruled_out = fixed_facets.ruled_out(mesh, of, acute=False)
    assert not any(set(of.triangles[k].tolist()) == shared for k in ruled_out)
