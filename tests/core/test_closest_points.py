"""Nearest points of a surface and the sample farthest from one, against brute force and against NumPy."""

import re

import numpy as np
import pytest
from support.builders import sphere_surface, square

from wct_plugin.core import _core
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import SurfaceMesh


def test_the_query_before_does_not_change_an_answer():
    """Each query starts from the triangle of the one before; above a grid many triangles are equally near."""
    surface = square(n=8)
    rng = np.random.default_rng(3)
    queries = rng.integers(-2, 19, (3000, 3)) / 16.0  # corners and middles of edges among them
    order = rng.permutation(len(queries))
    found = _core.closest_points(surface.points, surface.triangles, queries)
    shuffled = _core.closest_points(surface.points, surface.triangles, queries[order])
    for one, other in zip(found, shuffled, strict=True):
        assert (one[order] == other).all()
    foot = np.column_stack([np.clip(queries[:, :2], 0.0, 1.0), np.zeros(len(queries))])
    assert found[0] == pytest.approx(foot, abs=1e-15)


def test_any_number_of_threads_gives_the_same_bits():
    a, b = sphere_surface(3000, 1.01), sphere_surface(2000)
    rng = np.random.default_rng(4)
    queries = rng.normal(size=(20_000, 3))
    alone = _core.closest_points(b.points, b.triangles, queries, threads=1)
    farthest = _core.farthest_sample(a.points, a.triangles, 0.01, b.points, b.triangles, threads=1)
    for threads in (2, 3):
        together = _core.closest_points(b.points, b.triangles, queries, threads=threads)
        assert all((one == other).all() for one, other in zip(alone, together, strict=True))
        assert farthest == _core.farthest_sample(a.points, a.triangles, 0.01, b.points, b.triangles, threads=threads)


@pytest.mark.parametrize(
    ("a", "b", "spacing"),
    [
        (sphere_surface(800, 1.1), sphere_surface(1000), 0.03),
        (sphere_surface(300), sphere_surface(4000), None),
        (square(n=3), square(0.25, n=7), None),
        (square(n=1), square(n=1), 0.1),
        (SurfaceMesh([[1.0, 2.0, 3.0]], [[0, 0, 0]]), square(n=2), None),
    ],
)
def test_compiled_deviation_is_that_of_numpy(a, b, spacing):
    ours, theirs = measure_deviation(a, b, spacing, compiled=True), measure_deviation(a, b, spacing)
    for one, other in zip(vars(ours).items(), vars(theirs).items(), strict=True):
        if not one[0].startswith("at"):  # many samples may be equally far
            assert one == (other[0], pytest.approx(other[1], rel=1e-12, abs=1e-15))


def test_the_farthest_sample_is_where_it_says():
    """A big triangle over a dent: no corner shows it."""
    dent = square(n=8)
    points = dent.points.copy()
    middle = int(np.flatnonzero((points == [0.5, 0.5, 0.0]).all(axis=1))[0])
    points[middle, 2] = -0.2
    flat = square(n=1)
    far, at = _core.farthest_sample(points, dent.triangles, 10.0, flat.points, flat.triangles)
    assert (far, at) == (pytest.approx(0.2), (0.5, 0.5, -0.2))
    assert _core.farthest_sample(flat.points, flat.triangles, 0.0, points, dent.triangles)[0] == 0.0
    far, at = _core.farthest_sample(flat.points, flat.triangles, 0.05, points, dent.triangles)
    assert 0.05 < far < 0.2
    assert np.abs(np.array(at) - [0.5, 0.5, 0.0]).max() < 0.1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"step": -1.0}, "step must not be negative"),
        ({"step": np.nan}, "step must not be negative"),
        ({"triangles": np.zeros((0, 3), dtype=np.int64)}, "the surface has no triangles"),
        ({"surface_triangles": np.array([[0, 1, 9]])}, "surface_triangles names point 9; there are 4"),
    ],
)
def test_refusals(change, message):
    flat = square(n=1)
    arguments = {"points": flat.points, "triangles": flat.triangles, "step": 0.1}
    arguments |= {"surface_points": flat.points, "surface_triangles": flat.triangles}
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        _core.farthest_sample(**(arguments | change))
