"""Measures against the paper's figures, rational arithmetic, barycentric coordinates and invariances."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.builders import ball, bcc, jittered_cube, kuhn_cube, regular_tet, rotation, single
from support.measures import MEASURES
from support.printed import PAPER_TETS

from wct_plugin.measure import quality, shape_polynomials
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import EDGES, FACETS


def exact_flags(points: np.ndarray) -> tuple[bool, bool, bool]:
    """3WC, 2WC and acute of one tet in rational arithmetic, from definitions other than the module's."""
    x = [[Fraction(float(c)) for c in p] for p in points]

    def sub(a, b):
        return [p - q for p, q in zip(a, b, strict=True)]

    def dot(a, b):
        return sum(p * q for p, q in zip(a, b, strict=True))

    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

    def solve(rows, right):  # Cramer
        det = dot(rows[0], cross(rows[1], rows[2]))
        columns = [[row[k] for row in rows] for k in range(3)]
        out = []
        for k in range(3):
            mixed = [list(right) if j == k else columns[j] for j in range(3)]
            out.append(dot(mixed[0], cross(mixed[1], mixed[2])) / det)
        return out

    edges = [sub(x[k], x[0]) for k in (1, 2, 3)]
    center = solve(edges, [dot(e, e) / 2 for e in edges])  # from vertex 0
    weights = solve([[e[k] for e in edges] for k in range(3)], center)  # barycentric coordinates 1, 2, 3
    three = min(*weights, 1 - sum(weights)) > 0
    two = all(
        dot(sub(x[b], x[a]), sub(x[c], x[a])) > 0
        for a in range(4)
        for b in range(4)
        for c in range(b)
        if a not in (b, c)
    )
    acute = True
    for p, q in EDGES:
        r, s = (k for k in range(4) if k not in (p, q))
        along = sub(x[q], x[p])
        sides = [sub(x[k], x[p]) for k in (r, s)]
        feet = [sub([c * dot(along, along) for c in side], [c * dot(side, along) for c in along]) for side in sides]
        acute &= dot(*feet) > 0
    return three, two, acute


def flags(points: np.ndarray) -> tuple[bool, bool, bool]:
    found = quality.measure(single(points))
    return bool(found.well_centered_3[0]), bool(found.well_centered_2[0]), bool(found.acute[0])


@pytest.mark.parametrize("name", PAPER_TETS)
def test_paper_tets_to_every_printed_digit(name):
    points, printed, letters = PAPER_TETS[name]
    found = quality.measure(single(points))
    low_h, high_h, low_face, high_face, low_dihedral, high_dihedral, ratio = (
        float(getattr(found, measure)[0]) for measure in MEASURES
    )
    assert [f"{v:.3f}" for v in (low_h, high_h)] == printed[:2]
    assert [f"{v:.2f}" for v in (low_face, high_face, low_dihedral, high_dihedral)] == printed[2:6]
    assert [f"{ratio:.3f}"] * 2 == printed[6:]
    assert "".join("NY"[flag] for flag in flags(np.array(points))) == letters
    assert found.completely_well_centered[0] == letters.startswith("YY")


def test_paper_circumcenters_are_the_origin_and_radii_one():
    for name, (points, _, _) in PAPER_TETS.items():
        radius = np.sqrt(5.0) if name == "sommerville" else 1.0
        mesh = single(points)
        assert np.allclose(quality.circumcenters(mesh.points, mesh.tets), 0.0, atol=1e-13)
        assert np.allclose(quality.circumradii(mesh.points, mesh.tets), radius, rtol=1e-13)


def test_regular_tet_closed_forms():
    mesh = regular_tet(edge=2.0)
    args = mesh.points, mesh.tets
    assert np.allclose(quality.heights_over_radius(*args), 1.0 / 3.0)
    assert np.allclose(quality.face_angles(*args), 60.0)
    assert np.allclose(quality.heights_and_cotangents(*args)[2], 1.0 / np.sqrt(3.0))
    assert np.allclose(quality.dihedral_angles(*args), np.degrees(np.arccos(1.0 / 3.0)))
    assert np.allclose(quality.radius_over_edge(*args), np.sqrt(3.0 / 8.0))
    assert np.allclose(quality.volumes(*args), 8.0 / (6.0 * np.sqrt(2.0)))


def test_columns_are_in_the_documented_order():
    """A corner of the cube: right angles exactly where FACETS and EDGES say."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    expected = np.where(FACETS == 0, 90.0, 45.0)
    expected[0] = 60.0
    right = [90.0 if 0 in edge else np.degrees(np.arccos(1.0 / np.sqrt(3.0))) for edge in EDGES]
    for turn in ([0, 1, 2, 3], [1, 2, 0, 3], [3, 1, 0, 2], [2, 0, 1, 3]):
        place = np.argsort(turn)  # vertex k of the tet is point turn[k]
        tets = np.array([turn])
        corner = place[0]
        angles = quality.face_angles(points, tets).reshape(4, 3)
        assert np.allclose(angles, np.where(np.arange(4)[:, None] == corner, 60.0, np.where(corner == FACETS, 90, 45)))
        assert np.allclose(
            quality.dihedral_angles(points, tets)[0],
            [90.0 if corner in edge else np.degrees(np.arccos(1.0 / np.sqrt(3.0))) for edge in EDGES],
        )
        heights = quality.heights_over_radius(points, tets)[0]
        assert heights[corner] == pytest.approx(-1.0 / 3.0)
        assert np.allclose(np.delete(heights, corner), 1.0 / np.sqrt(3.0))
    assert np.allclose(quality.face_angles(points, np.arange(4)[None]).reshape(4, 3), expected)
    assert np.allclose(quality.dihedral_angles(points, np.arange(4)[None])[0], right)


def test_measure_agrees_with_the_single_functions():
    mesh = ball(5)
    found, args = quality.measure(mesh), (mesh.points, mesh.tets)
    heights = quality.heights_over_radius(*args)
    faces, dihedrals = quality.face_angles(*args), quality.dihedral_angles(*args)
    assert np.allclose(found.min_height, heights.min(axis=1))
    assert np.allclose(found.max_height, heights.max(axis=1))
    assert (found.worst_facet == heights.argmin(axis=1)).all()
    assert np.allclose(found.min_face_angle, faces.min(axis=1))
    assert np.allclose(found.max_face_angle, faces.max(axis=1))
    assert np.allclose(found.min_dihedral_angle, dihedrals.min(axis=1))
    assert np.allclose(found.max_dihedral_angle, dihedrals.max(axis=1))
    assert np.allclose(found.radius_over_edge, quality.radius_over_edge(*args))
    assert np.allclose(found.volume, quality.volumes(*args))
    assert len(found) == len(mesh.tets)
    values, errors = quality.heights(*args)
    assert np.allclose(values, heights * quality.circumradii(*args)[:, None])
    assert (errors > 0).all()
    with pytest.raises(ValueError, match="read-only"):
        found.min_height[0] = 1.0


def test_signs_of_h_are_those_of_the_circumcenter_s_barycentric_coordinates():
    mesh = ball(6)
    corners = mesh.points[mesh.tets]
    system = np.concatenate([np.swapaxes(corners, 1, 2), np.ones((len(corners), 1, 4))], axis=1)
    centers = quality.circumcenters(mesh.points, mesh.tets)
    right = np.column_stack([centers, np.ones(len(centers))])
    weights = np.linalg.solve(system, right[..., None])[..., 0]
    heights = quality.heights_over_radius(mesh.points, mesh.tets)
    clear = np.abs(weights) > 1e-9
    assert clear.mean() > 0.99
    assert (np.sign(weights) == np.sign(heights))[clear].all()
    inside = clear.all(axis=1)
    assert (quality.measure(mesh).well_centered_3 == (weights > 0).all(axis=1))[inside].all()
    distance = np.linalg.norm(corners - centers[:, None], axis=2)
    assert np.allclose(distance, quality.circumradii(mesh.points, mesh.tets)[:, None])


def test_a_bigger_mesh_crosses_chunks():
    """More tets than are treated together: the same tet gives the same numbers wherever it stands."""
    mesh = kuhn_cube(12)  # 10368
    found = quality.measure(mesh)
    assert len(found) > shape_polynomials.CHUNK
    for name in MEASURES:
        values = getattr(found, name)
        assert np.ptp(values) < 1e-9
    assert found.volume.sum() == pytest.approx(1.0)


def test_sommerville_tiling_is_completely_well_centered_and_not_acute():
    found = quality.measure(bcc(3))
    assert found.completely_well_centered.all()
    assert not found.acute.any()  # two right dihedral angles each, exactly
    assert np.allclose(found.min_height, np.sqrt(0.1))


@pytest.mark.parametrize("offset", [0.0, 3.7, -1e6])
@pytest.mark.parametrize("seed", range(3))
def test_right_angles_never_pass_for_acute(offset, seed):
    """The corner of a cube, rotated, moved and rounded: whatever the flag says is exactly true."""
    cube = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    path = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]], dtype=float)
    for points in (cube, path, np.array(PAPER_TETS["sommerville"][0], dtype=float)):
        moved = points @ rotation(seed).T + offset
        assert flags(moved) == exact_flags(moved)
    assert flags(cube) == (False, False, False)
    assert flags(path) == (False, False, False)


@given(st.integers(0, 2**32 - 1), st.floats(-18, -1), st.floats(-7, 0), st.sampled_from([0.0, 1.0, 1e5]))
def test_flags_are_exact(seed, wobble, flatness, offset):
    """Near right angles, near circumcenters in a facet, slivers, far from the origin: judged by rational arithmetic."""
    rng = np.random.default_rng(seed)
    names = list(PAPER_TETS)
    base = np.array(PAPER_TETS[names[seed % len(names)]][0], dtype=float)
    if seed % 3 == 0:
        base = np.array([[0, 0, 0], [1, 0, 0], [0.5, 1, 0], [0.5, 0.0, 1]])  # right angles in and between facets
    if seed % 3 == 1:
        base = np.array([[0, 0, 0], [2, 0, 0], [0.8, 1.2, 0], [1.0, 0.5, 1.0]])  # circumcenter slides into a facet
        base[3] = base[:3].mean(axis=0) + np.array([0, 0, 1])
    points = base * [1, 1, 10.0**flatness] + rng.normal(size=(4, 3)) * 10.0**wobble
    points = points @ rotation(seed % 1000).T + offset
    if np.linalg.det(points[1:] - points[0]) == 0:
        return
    found = quality.measure(single(points))
    assert flags(points) == exact_flags(points)
    assert flags(points) == (found.min_height[0] > 0, found.max_face_angle[0] < 90, found.max_dihedral_angle[0] < 90)


def test_spires_keep_their_flag_whatever_vertex_comes_first():
    """A tiny acute base and an apex 1e5 away: 3WC, and beyond doubt from any vertex."""
    angle = 2.0 * np.pi * np.arange(3) / 3.0
    base = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(3)])
    points = np.vstack([base, [[0.0, 0.0, 1e5]]])
    for turn in ([0, 1, 2, 3], [3, 0, 2, 1], [1, 3, 0, 2]):
        assert flags(points[turn]) == exact_flags(points[turn]) == (True, True, True)


def test_bound_of_the_height_holds():
    rng = np.random.default_rng(3)
    for flatness in (1.0, 1e-3, 1e-6, 1e-9):
        points = rng.normal(size=(4, 3)) * [1, 1, flatness]
        mesh = single(points)
        values, errors = quality.heights(mesh.points, mesh.tets)
        x = [[Fraction(float(c)) for c in p] for p in mesh.points[mesh.tets[0]]]
        for facet in range(4):
            squared, sign = _exact_height(x, facet)
            exact = sign * float(squared) ** 0.5
            assert abs(values[0, facet] - exact) <= errors[0, facet] + 4e-16 * abs(exact)


def _exact_height(x, facet):
    """Square and sign of the circumcenter's height over a facet, exactly."""
    corners = [x[int(k)] for k in FACETS[facet]]
    apex = x[facet]

    def sub(a, b):
        return [p - q for p, q in zip(a, b, strict=True)]

    def dot(a, b):
        return sum(p * q for p, q in zip(a, b, strict=True))

    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

    u, v, w = sub(corners[1], corners[0]), sub(corners[2], corners[0]), sub(apex, corners[0])
    normal = cross(u, v)
    numerator = (
        dot(u, u) * dot(cross(v, w), normal) + dot(v, v) * dot(cross(w, u), normal) + dot(w, w) * dot(normal, normal)
    )
    scaled = numerator / (2 * dot(normal, w)) * (1 if dot(normal, w) > 0 else -1)
    return scaled * scaled / dot(normal, normal), (1 if scaled > 0 else -1)


@given(
    st.integers(0, 1000),
    st.sampled_from([1e-12, 1e-3, 1.0, 7e5]),
    st.floats(-100, 100),
    st.permutations(range(4)),
)
def test_invariant_under_rigid_motion_scaling_and_renumbering(seed, size, shift, order):
    mesh = jittered_cube(2, seed % 7)
    rng = np.random.default_rng(seed)
    number = rng.permutation(len(mesh.points))
    points = np.empty_like(mesh.points)
    points[number] = (mesh.points @ rotation(seed).T + shift) * size
    moved = TetMesh(points, number[mesh.tets][:, list(order)])
    before, after = quality.measure(mesh), quality.measure(moved)
    for name in MEASURES:
        assert np.allclose(getattr(before, name), getattr(after, name), rtol=1e-9, atol=1e-9)
    assert np.allclose(before.volume * size**3, after.volume, rtol=1e-9)
    clear = np.abs(before.min_height) > 1e-9
    assert (before.well_centered_3 == after.well_centered_3)[clear].all()
    assert np.allclose(
        quality.circumcenters(mesh.points, mesh.tets) @ rotation(seed).T + shift,
        quality.circumcenters(moved.points, moved.tets) / size,
        atol=1e-8,
    )


@pytest.mark.parametrize("size", [1e-300, 1e-150, 1e150, 1e300])
def test_no_unit_of_length_over_or_underflows(size):
    points, _, letters = PAPER_TETS["n2y3y"]
    scaled = np.array(points) * size
    assert "".join("NY"[flag] for flag in flags(scaled)) == letters
    found = quality.heights_over_radius(scaled, np.arange(4)[None])
    assert np.allclose(found, quality.heights_over_radius(np.array(points), np.arange(4)[None]), atol=1e-13)
    assert np.allclose(quality.circumradii(scaled, np.arange(4)[None]), size)


def test_inverted_and_flat_tets_of_plain_arrays():
    points, tets = np.array(PAPER_TETS["n2y3y"][0]), np.array([[0, 1, 2, 3], [0, 2, 1, 3]])
    volumes = quality.volumes(points, tets)
    assert volumes[0] == pytest.approx(-volumes[1])
    sides = quality.heights_over_radius(points, tets)
    assert np.allclose(sides[0], sides[1][[0, 2, 1, 3]])
    flat = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], dtype=float)
    assert quality.volumes(flat, np.arange(4)[None])[0] == 0.0
    assert not np.isfinite(quality.circumradii(flat, np.arange(4)[None])).any()
    assert np.isinf(quality.heights(flat, np.arange(4)[None])[1]).all()
    assert np.allclose(np.sort(quality.dihedral_angles(flat, np.arange(4)[None])[0]), [0, 0, 0, 0, 180, 180])


def test_a_tet_that_is_flat_in_all_digits_but_one_has_numbers_on_its_flags_side():
    """Found by fuzzing: coplanar but for 1e-323 of its size, its circumcenter well inside, h/R was no number."""
    a, small = 1.9426688922257292e83, 9.598059608932038e-240
    mesh = TetMesh(np.array([[0, a, a], [0, small, 0], [a, a, a], [a, 0, small]]), np.array([[0, 1, 2, 3]]))
    measured = quality.measure(mesh)
    assert measured.well_centered_3.all()
    assert not measured.well_centered_2.any()
    assert (measured.min_height > 0).all()
    assert (measured.max_face_angle >= 90).all()
