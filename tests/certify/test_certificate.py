"""Exact certificates: what they prove, what they name, and that nothing slips through by one unit in the last place."""

import json
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from support.builders import bcc, delaunay, jittered_cube, kuhn_cube, kuhn_grid, regular_tet, rotation, single
from support.certifying import circumcenter, cosines, power, share_more_than_a_face
from support.printed import PAPER_TETS

import wct_plugin as wct
from wct_plugin.certify.certificate import HEAD, certify
from wct_plugin.certify.overlaps import _crossing, _Judge
from wct_plugin.cli import main
from wct_plugin.creation import bundled_meshes
from wct_plugin.errors import InputError
from wct_plugin.measure import quality
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import FACETS
from wct_plugin.reports.html_report import html
from wct_plugin.reports.report import make_report


def _joined(*meshes):
    """Several meshes in one, sharing no point."""
    offsets = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    return TetMesh(
        np.concatenate([mesh.points for mesh in meshes]),
        np.concatenate([mesh.tets + offset for mesh, offset in zip(meshes, offsets, strict=False)]),
    )


def _moved(mesh, shift, scale=1.0):
    return TetMesh(mesh.points * scale + shift, mesh.tets)


@pytest.mark.parametrize("name", PAPER_TETS)
def test_letters_of_the_paper(name):
    points, _, letters = PAPER_TETS[name]
    found = certify(single(points))
    assert found.valid
    assert [found.meets(goal) for goal in ("3wc", "2wc", "cwc")] == [
        letters[0] == "Y",
        letters[1] == "Y",
        letters[:2] == "YY",
    ]


def test_the_corner_of_a_cube_has_its_circumcenter_opposite():
    found = certify(single(np.vstack([np.zeros(3), np.eye(3)])))
    assert found.checks["3wc"].violations == 1
    assert found.checks["3wc"].ties == 0
    assert found.checks["3wc"].first[0].value == "-1/2"
    assert found.checks["2wc"].violations == found.checks["2wc"].ties == 3


def test_a_circumcenter_in_a_facet_is_not_inside_and_one_unit_in_the_last_place_decides():
    """Facet 0 1 2 is an equatorial one: its circumcenter is the tet's, which floating point cannot see."""
    base = np.array([[0.6, 0.8, 0.0], [-1.0, 0.0, 0.0], [0.6, -0.8, 0.0]]) * 5
    tet = single(np.vstack([base, [0.0, 0.0, 5.0]]))
    found = certify(tet).checks["3wc"]
    assert (found.violations, found.ties, found.exactly) == (1, 1, 1)
    assert found.first[0].value == "0"
    for nudge, count in ((np.nextafter(5.0, 6.0), 0), (np.nextafter(5.0, 4.0), 1)):
        moved = certify(single(np.vstack([base, [0.0, 0.0, nudge]]))).checks["3wc"]
        assert (moved.violations, moved.ties) == (count, 0)
    assert -1e-15 < Fraction(moved.first[0].value) < 0


def test_right_angles_are_told_from_nearly_right_ones():
    corners = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.7, 0.0], [0.1, 0.2, 0.6]])
    for x, ties, acute in ((0.0, 1, 1), (5e-324, 0, 0), (-5e-324, 0, 1)):
        corners[2, 0] = x
        found = certify(single(corners)).checks["2wc"]
        assert found.ties == ties
        assert sum(set(one.vertices) == {0, 1, 2} for one in found.first) == acute


def test_cospherical_points_are_delaunay_and_one_unit_in_the_last_place_is_not():
    cube = kuhn_cube(1)
    found = certify(cube)
    assert found.meets("delaunay")
    assert not found.meets("3wc")
    assert found.checks["delaunay"].ties == found.checks["delaunay"].elements == 6
    points = cube.points.copy()
    points[1] -= [0.0, 0.0, 2.0**-53]  # inwards: now inside the sphere of the tets that do not have it
    nudged = certify(TetMesh(points, cube.tets)).checks["delaunay"]
    assert nudged.violations
    assert all(one.value.startswith("-") for one in nudged.first)


def test_counts_agree_with_floating_point_where_that_is_sure():
    mesh = jittered_cube(8)
    found, measured = certify(mesh), quality.measure(mesh)
    assert found.valid
    assert found.meets("delaunay")
    assert found.checks["3wc"].violations == (~measured.well_centered_3).sum()
    assert found.checks["3wc"].exactly == 0
    assert found.checks["2wc"].exactly == found.checks["2wc"].ties  # right angles between the cube's edges
    bad = sorted({one.tets[0] for one in found.checks["3wc"].first})
    assert bad == np.flatnonzero(~measured.well_centered_3)[:5].tolist()


@pytest.mark.parametrize("seed", range(3))
def test_a_rotated_tiling_is_proven_completely_well_centered(seed):
    mesh = bcc(3)
    found = certify(TetMesh(mesh.points @ rotation(seed).T + 7.0, mesh.tets))
    assert found.valid
    assert all(found.meets(goal) for goal in ("delaunay", "3wc", "2wc", "cwc"))


@pytest.mark.parametrize("name", bundled_meshes.names())
def test_bundled_meshes_are_proven_as_they_are(name):
    found = certify(TetMesh(*bundled_meshes.load(name)))
    assert found.valid
    assert found.meets("3wc")
    assert found.meets("delaunay")
    assert found.meets("cwc") == (name not in ("cube_30", "cube_32", "cube_33"))


def test_a_ball_of_voxels_is_proven_completely_well_centered_in_every_tet():
    grid = np.indices((8, 8, 8)) - 3.5
    mesh, _ = wct.apply_filter("create_from_voxels", voxels=(grid**2).sum(axis=0) <= 16, spacing=0.1)
    found = certify(mesh)
    assert found.meets("cwc")
    assert found.checks["3wc"].elements == 194 * ((grid**2).sum(axis=0) <= 16).sum()
    assert found.checks["3wc"].exactly == 0


# --- conformity -----------------------------------------------------------------------------------------------------


def test_overlapping_tets_are_found():
    tet = regular_tet()
    for mesh, what in (
        (_joined(tet, _moved(tet, [0.1, 0.0, 0.0])), "cross"),
        (_joined(tet, tet), "coincide"),
        (_joined(tet, _moved(tet, 0.0, 0.25)), "overlap"),  # one inside the other: their boundaries do not meet
        (_joined(kuhn_cube(2), _moved(tet, 0.5, 0.1)), "overlap"),
        (_joined(kuhn_cube(1), _moved(kuhn_cube(1), [1.0, 0.0, 0.0])), "coincide"),  # a crack of no width
        (_joined(kuhn_cube(1), _moved(kuhn_cube(1), [1.0, 0.5, 0.5])), "touch"),
        (_joined(tet, _moved(tet, tet.points[0] - tet.points[1])), "touch"),  # in one point that is two
    ):
        found = certify(mesh)
        assert not found.valid
        assert not found.meets("delaunay")
        assert any(what in one.what for one in found.checks["conformity"].first)


def test_two_tets_on_one_side_of_their_facet():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, 1], [0.3, 0.3, 2.0]])
    found = certify(TetMesh(points, np.array([[0, 1, 2, 3], [0, 1, 2, 4]]))).checks["conformity"]
    assert "tets 0 and 1" in str(found.first[0])
    assert "same side of their common facet" in str(found.first[0])


def test_a_full_turn_and_a_half_is_one_too_many():
    """Nine wedges of 60 degrees around an edge: matched one after the other, but the last three lie on the first."""
    turn = np.arange(10) * np.pi / 3
    rim = np.column_stack([np.cos(turn), np.sin(turn), 0.01 * turn])
    points = np.vstack([[0, 0, -1], [0, 0, 1], rim])
    wheel = np.array([[0, 1, 2 + k, 3 + k] for k in range(9)])
    assert certify(TetMesh(points, wheel[:5])).valid
    assert not certify(TetMesh(points, wheel)).valid


@pytest.mark.parametrize(
    ("triangle", "common"),
    [
        ([(5, 0), (9, 0), (5, 4)], False),  # apart
        ([(3, 3), (5, 3), (3, 5)], False),  # apart, but their boxes are not
        ([(1, 1), (2, 1), (1, 2)], True),  # one inside the other
        ([(3, -1), (3, 3), (-1, 3)], True),  # a star of six points: no corner of one inside the other
        ([(2, 2), (5, 2), (5, 5)], True),  # a corner on an edge
        ([(4, 0), (8, 0), (8, 4)], False),  # a common vertex
        ([(4, 0), (1, 1), (8, 4)], True),  # a common vertex, and more
        ([(0, 0), (3, 0), (0, -3)], True),  # along half of an edge
        ([(0, 0), (4, 0), (0, -4)], False),  # a common edge
        ([(0, 0), (4, 0), (1, 1)], True),  # a common edge, folded over
    ],
)
@pytest.mark.parametrize("lift", [(0, 0), (1, 2)])
def test_two_facets_in_one_plane(triangle, common, lift):
    """Tets on either side of a plane that share the vertices their facets there have in common."""
    flat = np.array([(0, 0), (4, 0), (0, 4), *triangle], dtype=float)
    base = np.column_stack([flat, flat @ lift])
    points, number = np.unique(np.vstack([base, [1, 1, 50], [1, 1, -50]]), axis=0, return_inverse=True)
    number = number.ravel()
    mesh = TetMesh(points, number[[[0, 1, 2, 6], [3, 4, 5, 7]]])
    bases = [set(number[:3].tolist()), set(number[3:6].tolist())]
    one, other = (next(k for k, row in enumerate(mesh.topology.boundary.tolist()) if set(row) == b) for b in bases)
    assert ([min(one, other), max(one, other)] in _crossing(mesh, _Judge(points)).tolist()) == common
    assert certify(mesh).valid == (not common)


def test_sound_meshes_of_every_kind_pass():
    tet = regular_tet()
    hollow = kuhn_grid((3, 3, 3), lambda c: np.abs(c - 1.5).max(axis=1) > 0.6)
    for mesh in (
        hollow,  # a shell inside another one
        _joined(hollow, _moved(kuhn_cube(1), 1.25, 0.5)),  # and a piece in the cavity
        _joined(tet, _moved(tet, 3.0)),
        kuhn_grid((2, 2, 1), lambda c: (c[:, 0] < 1) == (c[:, 1] < 1)),  # two cubes that share an edge alone
        kuhn_grid((2, 2, 2), lambda c: (c < 1).all(axis=1) | (c > 1).all(axis=1)),  # and a vertex alone
    ):
        assert certify(mesh).valid
        assert certify(TetMesh(mesh.points @ rotation(3).T, mesh.tets)).valid


def _lattice_mesh(rng, count):
    """Delaunay of a few points of a coarse lattice, so that vertices, edges and planes often coincide."""
    lattice = np.array(list(np.ndindex(4, 4, 4)), dtype=float)
    while True:
        points = lattice[rng.choice(len(lattice), count, replace=False)]
        if np.linalg.matrix_rank(points[1:] - points[0]) == 3:
            return delaunay(points)


def _one_vertex_elsewhere(rng):
    mesh = _lattice_mesh(rng, 7)
    points = mesh.points.copy()
    points[rng.integers(len(points))] = rng.integers(0, 4, 3)
    return TetMesh(points, mesh.tets[rng.random(len(mesh.tets)) < 0.8][:9])


def _two_meshes(rng):
    both = _joined(_lattice_mesh(rng, 4), _moved(_lattice_mesh(rng, 5), rng.integers(-1, 3, 3)))
    if rng.random() < 0.5:
        return both
    points, number = np.unique(both.points, axis=0, return_inverse=True)
    return TetMesh(points, number.ravel()[both.tets])


@pytest.mark.parametrize("make", [_one_vertex_elsewhere, _two_meshes])
@pytest.mark.parametrize("seed", range(3))
def test_agrees_with_all_pairs_of_tets(make, seed):
    rng = np.random.default_rng(seed)
    verdicts = []
    while len(verdicts) < 6:
        try:
            mesh = make(rng)
            found = certify(mesh)
        except InputError:  # flat tets, no tets, or three at a facet
            continue
        sound = not any(share_more_than_a_face(mesh.points, *pair) for pair in combinations(mesh.tets, 2))
        assert found.valid == sound
        verdicts.append(sound)
    assert 0 < sum(verdicts) < 6


# --- where it is shown ----------------------------------------------------------------------------------------------


def test_in_the_report(tmp_path):
    mesh = kuhn_cube(2)
    plain, exact = make_report(mesh), make_report(mesh, exact=True)
    assert plain.certificate is None
    assert plain.to_dict()["certificate"] is None
    found = exact.to_dict()["certificate"]
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    assert found["valid"]
    assert found["delaunay"]
    assert not found["cwc"]
    assert found["checks"]["3wc"]["violations"] == found["checks"]["3wc"]["elements"] == 48
    assert found["checks"]["3wc"]["first"][0]["value"] == "0"
    assert replace(exact, certificate=None).to_dict() == plain.to_dict()
    page = html([exact], "cube")
    assert "Exact certificate, 1: mesh: proven: valid, Delaunay" in page
    assert "Exact certificate" not in html([plain], "cube")


def test_on_the_command_line(tmp_path, capsys):
    for name, mesh in (("good", bcc(2)), ("bad", _joined(regular_tet(), regular_tet())), ("flat", kuhn_cube(1))):
        wct.write(tmp_path / f"{name}.vtu", mesh)
    good, bad, flat = (str(tmp_path / f"{name}.vtu") for name in ("good", "bad", "flat"))
    assert main.run(["report", good, "--exact", "--goal", "cwc"]) == 0
    assert "proven: valid, Delaunay, 3WC, 2WC, CWC" in capsys.readouterr().out
    assert main.run(["report", flat, "--exact"]) == 0
    assert main.run(["report", flat, "--exact", "--goal", "3wc"]) == 1
    assert "smallest barycentric coordinate is 0" in capsys.readouterr().out
    assert main.run(["report", bad]) == 0
    assert main.run(["report", bad, "--exact"]) == 1
    assert "not a valid mesh" in capsys.readouterr().out
    assert main.run(["report", bad, good, "--exact", "--json", "-"]) == 1
    assert [one["certificate"]["valid"] for one in json.loads(capsys.readouterr().out)] == [False, True]


# --- what a violation says ------------------------------------------------------------------------------------------


def _negative_power_pair():
    """Two flat tets at a facet, each with its last vertex inside the other's sphere, and a sound tet apart."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.25, 0.25, 0.25], [0.25, 0.25, -0.25]])
    pair = TetMesh(points, np.array([[0, 1, 2, 3], [0, 2, 1, 4]]))
    return _joined(_moved(regular_tet(), 5.0), pair)


def test_a_violation_names_its_tets_its_vertices_and_its_exact_value():
    mesh = _negative_power_pair()
    found = certify(mesh)
    assert found.valid
    (delaunay,) = found.checks["delaunay"].first
    across = int(np.setdiff1d(mesh.tets[2], mesh.tets[1])[0])
    assert (delaunay.tets, delaunay.vertices) == ((1, 2), (*mesh.tets[1].tolist(), across))
    assert Fraction(delaunay.value) == power(mesh.points[mesh.tets[1]], mesh.points[across]) < 0
    for one, tet in zip(found.checks["3wc"].first, (1, 2), strict=True):
        assert (one.tets, one.vertices) == ((tet,), tuple(mesh.tets[tet].tolist()))
        assert Fraction(one.value) == min(circumcenter(mesh.points[mesh.tets[tet]])[1])
    named = {one.vertices: one for one in found.checks["2wc"].first}
    triangles = np.unique(np.sort(mesh.tets[:, FACETS].reshape(-1, 3), axis=1), axis=0)
    bad = sum(min(cosines(mesh.points[corners])) <= 0 for corners in triangles)
    assert (found.checks["2wc"].violations, len(named)) == (bad, 5)
    for vertices, one in named.items():
        assert set(vertices) < set(mesh.tets[one.tets[0]].tolist())
        assert Fraction(one.value) == min(cosines(mesh.points[list(vertices)])) <= 0


def test_values_keep_all_their_digits_or_six_and_never_become_zero():
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.2, 0.6]])
    for x, text in (
        (-0.125, "-1/8"),
        (-(2.0**-120), f"-1/{2**120}"),
        (-(2.0**-130), "-7.34684e-40"),
        (-5e-324, "-4.94066e-324"),
    ):
        corners[2, 0] = x
        values = [one.value for one in certify(single(corners)).checks["2wc"].first if set(one.vertices) == {0, 1, 2}]
        assert values == [text]


def test_five_violations_are_named_and_all_are_counted(monkeypatch):
    """Whatever the size of the pieces in which cells are gathered."""
    mesh = kuhn_cube(2)
    whole = certify(mesh)
    assert [len(whole.checks[name].first) for name in ("3wc", "2wc")] == [5, 5]
    assert whole.checks["3wc"].violations == whole.checks["3wc"].ties == len(mesh.tets) == 48
    overlapping = _joined(kuhn_cube(1), kuhn_cube(1))
    assert (
        len(certify(overlapping).checks["conformity"].first) == 5 < certify(overlapping).checks["conformity"].violations
    )
    monkeypatch.setattr("wct_plugin.certify.certificate._BLOCK", 5)
    assert certify(mesh).to_dict() == whole.to_dict()


def test_conformity_names_both_tets_and_their_vertices():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, 1], [0.3, 0.3, 2.0]])
    found = certify(TetMesh(points, np.array([[0, 1, 2, 3], [0, 1, 2, 4]]))).checks["conformity"]
    assert (found.first[0].tets, found.first[0].vertices, found.first[0].value) == ((0, 1), (0, 1, 2, 3, 4), "")
    assert (found.elements, found.ties, found.passed) == (7, 0, False)


def test_words_of_a_certificate():
    good, bad = certify(bcc(2)), certify(_joined(regular_tet(), regular_tet()))
    assert good.headline() == "proven: valid, Delaunay, 3WC, 2WC, CWC"
    assert bad.headline() == "not a valid mesh"
    assert not any(bad.meets(goal) for goal in ("delaunay", "3wc", "2wc", "cwc"))
    assert [row[0] for row in good.rows()] == ["orientation", "conformity", "Delaunay", "3WC", "2WC"]
    assert all(len(row) == len(HEAD) for row in good.rows())
    assert [row[3] for row in good.rows()] == ["0", "-", "0", "0", "0"]
    assert good.lines() == []
    flat = certify(kuhn_cube(1))
    assert flat.headline() == "proven: valid, Delaunay"
    assert flat.rows()[3][:4] == ("3WC", "6 tets", "6", "6")
    assert len(flat.lines()) == 10
    assert flat.lines()[0].startswith("3WC: tet 0, vertices 0 ")
