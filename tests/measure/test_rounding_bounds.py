"""The rounding bounds behind "beyond doubt": as large as the number of roundings asks for, and hardly larger."""

from fractions import Fraction

import numpy as np
import pytest
from support.builders import ball, jittered_cube, rotation
from support.rounding import EPS, counted

from wct_plugin.measure import quality, shape_polynomials
from wct_plugin.measure.duals import compute_duals, dual_lengths
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import FACETS, OPPOSITE_EDGES

#: Polynomials, their bounds, and the most roundings that a term of each value goes through.
SIGNS = {
    "heights": ("height_bounds", [22, 19, 19, 19]),
    "face_dots": ("face_bounds", [5] * 12),
    "dihedral_dots": ("dihedral_bounds", [11] * 3 + [13] * 3),
}


def _points(seed, flatness, count=40):
    """Random tets in the unit cube, flat ones turned and so rounded; one after the other."""
    rng = np.random.default_rng(seed)
    return (rng.uniform(-0.4, 0.4, (count, 4, 3)) * [1.0, 1.0, flatness] @ rotation(seed).T).reshape(-1, 3)


def _both(points):
    """The shapes of tets in floating point, and the same code run on numbers that count its roundings."""
    tets = np.arange(len(points)).reshape(-1, 4)
    return shape_polynomials.Shapes(points.T, tets), shape_polynomials.Shapes(counted(points.T), tets)


@pytest.mark.parametrize("name", SIGNS)
@pytest.mark.parametrize("flatness", [1.0, 1e-7, 1e-14])
def test_a_bound_is_that_of_the_roundings_that_the_code_does(name, flatness):
    """k roundings take at most k eps of the sum of absolute values; a bound above 1.4 times that would waste flags."""
    shapes, exact = _both(_points(0, flatness))
    assert (shapes.base == exact.base).all()
    of_bound, most = SIGNS[name]
    rows = zip(getattr(shapes, name)(), getattr(shapes, of_bound)(), getattr(exact, name)(), most, strict=True)
    for values, bounds, numbers, roundings in rows:
        assert max(one.roundings for one in numbers) == roundings
        for value, bound, number in zip(values.tolist(), bounds.tolist(), numbers, strict=True):
            least = roundings * EPS * number.size
            assert abs(Fraction(value) - number.value) <= least
            assert least * (1 + 30 * EPS) < Fraction(bound) <= Fraction(14, 10) * least + Fraction(1e-299)


@pytest.mark.parametrize("flatness", [1.0, 1e-5, 1e-9])
def test_the_bound_of_a_height_has_its_three_parts(flatness):
    """That of its numerator, and eight roundings of the volume and six of a normal, each with some slack; doubled."""
    points = _points(1, flatness)
    shapes, exact = _both(points)
    _, errors = quality.heights(points, np.arange(len(points)).reshape(-1, 4))
    assert {one.roundings for one in exact.det} == {8}
    assert {component.roundings for component in exact.normals[0].ravel()} == {6}
    for k, det in enumerate(exact.det):
        for facet, number in enumerate(exact.heights()):
            normal = exact.normals[facet][:, k]
            area = float(sum(component.value**2 for component in normal)) ** 0.5
            size = float(sum(component.size**2 for component in normal)) ** 0.5
            volume = abs(float(det.value))
            height = abs(float(number[k].value)) / (2 * volume * area)
            numerator = 24 * float(number[k].size) / (2 * volume * area)
            parts = numerator + height * (10 * float(det.size) / volume + 10 * size / area)
            assert errors[k, facet ^ shapes.base[k]] == pytest.approx(2 * float(EPS) * parts, rel=1e-5, abs=0)


def test_a_height_is_unknown_where_its_divisor_is_in_doubt_by_a_quarter():
    rng = np.random.default_rng(5)
    points = rng.uniform(-0.4, 0.4, (3000, 4, 3)) * [1.0, 1.0, 0.0] @ rotation(2).T
    points[:, 3, 2] += 10.0 ** rng.uniform(-15.5, -13.5, 3000)
    points = points.reshape(-1, 3)
    tets = np.arange(len(points)).reshape(-1, 4)
    shapes = shape_polynomials.Shapes(points.T, tets)
    with np.errstate(divide="ignore"):
        doubt = 10 * float(EPS) * shapes.det_size / np.abs(shapes.det)
    unknown = np.isinf(quality.heights(points, tets)[1])
    sharper = 10 * float(EPS) * 30  # what a normal's own doubt may add, in triangles that are not slender
    slender = np.max(
        [np.sqrt(shape_polynomials.dot(s, s)) / a for s, a in zip(shapes.normal_sizes, shapes.areas, strict=True)], 0
    )
    fat = slender < 30
    assert unknown[fat & (doubt >= 0.25)].all()
    assert not unknown[fat & (doubt < 0.25 - sharper)].any()
    assert (fat & (doubt > 0.125) & (doubt < 0.25)).sum() > 20
    assert (fat & (doubt > 0.25) & (doubt < 0.5)).sum() > 20


@pytest.mark.parametrize("mesh", [jittered_cube(2, 3), ball(2)])
@pytest.mark.parametrize("material", [False, True])
def test_the_errors_of_duals_are_those_of_their_parts_added_up(mesh, material):
    """Per tet, facet and edge of it, l / 4 times what is unknown of cot h; to either end's volume l^2 / 24 times it."""
    coefficient = np.linspace(-2.0, 3.0, len(mesh.tets)) if material else np.ones(len(mesh.tets))
    of = compute_duals(mesh, coefficient=coefficient if material else None)
    _, errors, cotangents = quality.heights_and_cotangents(mesh.points, mesh.tets)
    heights, _ = quality.heights(mesh.points, mesh.tets)
    areas, volumes, lengths = (dict.fromkeys(range(n), 0.0) for n in (len(of.areas), len(of.volumes), len(of.lengths)))
    for t, factor in enumerate(np.abs(coefficient).tolist()):
        for facet in range(4):
            lengths[int(mesh.topology.tet_facets[t, facet])] += factor * errors[t, facet]
        for column, edge in enumerate(OPPOSITE_EDGES):
            row, cotangent = int(mesh.topology.tet_edges[t, edge]), cotangents[t, column]
            ends = mesh.topology.edges[row]
            length = np.linalg.norm(np.subtract(*mesh.points[ends]))
            doubt = abs(cotangent) * errors[t, column // 3]
            doubt += 16 * float(EPS) * (1 + cotangent**2) * abs(heights[t, column // 3])
            areas[row] += factor * doubt * length / 4
            for end in ends.tolist():
                volumes[end] += factor * doubt * length**2 / 24
    for found, expected in ((of.area_errors, areas), (of.volume_errors, volumes), (of.errors, lengths)):
        assert found == pytest.approx(list(expected.values()), rel=1e-9, abs=0)
    if not material:
        assert dual_lengths(mesh)[1] == pytest.approx(of.errors, rel=1e-12, abs=0)


def test_a_cotangent_is_as_good_as_the_duals_take_it_for():
    """16 eps of 1 + its square covers what rounding does to it, also in needles and caps; a quarter of it does not."""
    worst = 0.0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        points = rng.uniform(-0.4, 0.4, (4, 3))
        if seed % 2:
            points[2] = points[0] + rng.uniform(0.2, 0.8) * (points[1] - points[0]) + rng.normal(size=3) * 1e-3
        mesh = TetMesh(points, [[0, 1, 2, 3]])
        found = quality.heights_and_cotangents(mesh.points, mesh.tets)[2][0]
        for column, cotangent in enumerate(found.tolist()):
            square, sign = _exact_cotangent(mesh, column)
            wrong = abs(cotangent - sign * float(square) ** 0.5)
            worst = max(worst, wrong / (float(EPS) * (1 + cotangent**2)))
    assert 0.5 < worst <= 16


def _exact_cotangent(mesh, column):
    """Square and sign of the cotangent of the angle at one corner of a facet."""
    facet, corner = divmod(column, 3)
    x = [[Fraction(c) for c in mesh.points[mesh.tets[0, v]].tolist()] for v in np.roll(FACETS[facet], -corner)]
    a, b = ([p - q for p, q in zip(end, x[0], strict=True)] for end in x[1:])
    inner = sum(p * q for p, q in zip(a, b, strict=True))
    normal = sum(p * p for p in a) * sum(p * p for p in b) - inner**2
    return inner**2 / normal, (1 if inner > 0 else -1)
