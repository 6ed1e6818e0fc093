"""The compiled measures against the NumPy ones, which share no code with them, down to flags that rounding misses."""

import numpy as np
import pytest
from support.builders import ball, bcc, jittered_cube, kuhn_cube, rotation, single
from support.measures import MEASURES

from wct_plugin.core import _core
from wct_plugin.measure import compiled_quality, duals, quality
from wct_plugin.mesh import TetMesh, unit_scaling
from wct_plugin.mesh.topology import OPPOSITE_EDGES

NUMBERS = (*MEASURES, "volume")
FLAGS = ("well_centered_3", "well_centered_2", "acute")


def turned(mesh: TetMesh, seed: int = 3) -> TetMesh:
    """With every digit in use."""
    return TetMesh(mesh.points @ rotation(seed).T + 0.7, mesh.tets, mesh.regions)


def wobbled(mesh: TetMesh, size: float) -> TetMesh:
    noise = np.random.default_rng(7).normal(size=mesh.points.shape) * size
    return TetMesh(mesh.points + noise, mesh.tets, mesh.regions)


def stretched(mesh: TetMesh, flatness: float) -> TetMesh:
    return turned(TetMesh(mesh.points * [1.0, 1.0, flatness], mesh.tets, mesh.regions))


MESHES = {
    "right angles": kuhn_cube(5),
    "right angles turned": turned(kuhn_cube(4)),
    "right angles but for a rounding": wobbled(kuhn_cube(4), 1e-16),
    "right angles far away": TetMesh(kuhn_cube(3).points + 1e6, kuhn_cube(3).tets),
    "jittered": jittered_cube(5),
    "ball": ball(6),
    "lattice": bcc(3),
    "flat": stretched(kuhn_cube(3), 1e-9),
    "as flat as it gets": stretched(kuhn_cube(2), 3e-15),
    "tiny": TetMesh(bcc(2).points * 1e-89, bcc(2).tets),
    "huge": TetMesh(bcc(2).points * 1e89, bcc(2).tets),
    "two regions": TetMesh(kuhn_cube(4).points, kuhn_cube(4).tets, np.arange(len(kuhn_cube(4).tets)) % 2),
}


@pytest.mark.parametrize("name", MESHES)
def test_measures_are_those_of_numpy(name):
    mesh = MESHES[name]
    ours, theirs = compiled_quality.measure(mesh), quality.measure(mesh)
    for number in NUMBERS:
        # Arc tangents and powers are the only operations that may round otherwise.
        np.testing.assert_allclose(getattr(ours, number), getattr(theirs, number), rtol=4e-15, atol=3e-15)
    for flag in FLAGS:
        np.testing.assert_array_equal(getattr(ours, flag), getattr(theirs, flag), err_msg=flag)
    np.testing.assert_array_equal(ours.worst_facet, theirs.worst_facet)


@pytest.mark.parametrize("flag", FLAGS)
def test_flags_are_seen_on_either_side(flag):
    seen = np.concatenate([getattr(compiled_quality.measure(mesh), flag) for mesh in MESHES.values()])
    assert seen.any()
    assert not seen.all()


@pytest.mark.parametrize("name", MESHES)
def test_single_measures_are_those_of_numpy_to_the_bit(name):
    points, tets = MESHES[name].points, MESHES[name].tets
    np.testing.assert_array_equal(compiled_quality.volumes(points, tets), quality.volumes(points, tets))
    np.testing.assert_array_equal(compiled_quality.circumradii(points, tets), quality.circumradii(points, tets))
    for ours, theirs in zip(compiled_quality.heights(points, tets), quality.heights(points, tets), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_flat_and_inverted_tets_of_plain_arrays():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0.2, 0.3, 1], [2, 0, 0]])
    tets = np.array([[0, 1, 2, 3], [0, 1, 4, 2], [0, 1, 2, 4], [0, 1, 5, 4], [0, 0, 1, 4]])
    np.testing.assert_array_equal(compiled_quality.volumes(points, tets), quality.volumes(points, tets))
    np.testing.assert_array_equal(compiled_quality.circumradii(points, tets), quality.circumradii(points, tets))
    for ours, theirs in zip(compiled_quality.heights(points, tets), quality.heights(points, tets), strict=True):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("name", MESHES)
def test_dihedral_angles_are_counted_as_numpy_does(name):
    mesh = MESHES[name]
    bins = np.array([0.0, 10.5, 40.25, 44.0, 46.0, 59.5, 61.5, 88.0, 92.0, 121.3, 180.0])
    angles = quality.dihedral_angles(mesh.points, mesh.tets)
    np.testing.assert_array_equal(compiled_quality.dihedral_counts(mesh, bins), np.histogram(angles, bins)[0])


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("material", [False, True])
def test_duals_are_those_of_weights_that_are_all_zero(name, material):
    mesh = MESHES[name]
    factors = np.linspace(1.0, 3.0, len(mesh.tets)) if material else None
    ours = duals.compute_duals(mesh, coefficient=factors)
    theirs = duals.compute_duals(mesh, np.zeros(len(mesh.points)), factors)
    for field in ("lengths", "areas", "volumes"):
        np.testing.assert_array_equal(getattr(ours, field), getattr(theirs, field), err_msg=field)
    for field in ("errors", "area_errors", "volume_errors"):
        np.testing.assert_allclose(getattr(ours, field), getattr(theirs, field), rtol=1e-14, err_msg=field)


@pytest.mark.parametrize("name", MESHES)
def test_parts_without_signs(name):
    mesh, points = MESHES[name], unit_scaling.normalized(MESHES[name].points)
    heights, _, cotangents = quality.heights_and_cotangents(points, mesh.tets)
    edges = points[mesh.topology.edges]
    squares = np.square(edges[:, 1] - edges[:, 0]).sum(axis=1)[mesh.topology.tet_edges]
    parts = np.repeat(heights, 3, axis=1) * cotangents * squares[:, OPPOSITE_EDGES] / 12.0
    np.testing.assert_allclose(_core.unsigned_volumes(points, mesh.tets), np.abs(parts).sum(axis=1), rtol=1e-13)


@pytest.mark.parametrize("name", [name for name in MESHES if name not in ("tiny", "huge")])
def test_orthogonality(name):
    mesh = MESHES[name]
    pairs = mesh.topology.interior_pairs
    a, b, c = (mesh.points[corner] for corner in mesh.topology.facets[: len(pairs)].T)
    centroids = mesh.points[mesh.tets].mean(axis=1)
    normals, lines = np.cross(b - a, c - a), centroids[pairs[:, 2]] - centroids[pairs[:, 0]]
    cosines = np.einsum("ki,ki->k", normals, lines) / np.linalg.norm(normals, axis=1) / np.linalg.norm(lines, axis=1)
    np.testing.assert_allclose(
        _core.orthogonality(mesh.points, mesh.tets, pairs),
        cosines,
        atol=2e-5 if "far" in name else 1e-9 if "flat" in name else 1e-13,
    )


@pytest.mark.parametrize("count", [1, 7, 8, 9, 23])
def test_any_number_of_tets_fills_the_lanes(count):
    whole = jittered_cube(3)
    mesh = TetMesh(whole.points, whole.tets[:count])
    ours, theirs = compiled_quality.measure(mesh), quality.measure(mesh)
    np.testing.assert_array_equal(ours.min_height, theirs.min_height)
    np.testing.assert_array_equal(ours.well_centered_2, theirs.well_centered_2)


def test_the_same_bits_with_any_number_of_threads():
    mesh = turned(kuhn_cube(12))
    assert len(mesh.tets) > 2 * 4096
    for function, more in (
        (_core.measure_tets, ()),
        (_core.circumcenter_heights, ()),
        (_core.unsigned_volumes, ()),
        (_core.dual_edge_sums, (mesh.topology.tet_edges, len(mesh.topology.edges), None)),
        (_core.orthogonality, (mesh.topology.interior_pairs,)),
    ):
        one, four = (function(mesh.points, mesh.tets, *more, threads=threads) for threads in (1, 4))
        for first, second in zip(*(each if isinstance(each, tuple) else (each,) for each in (one, four)), strict=True):
            np.testing.assert_array_equal(first, second)


def test_wrong_arrays_are_refused():
    mesh = single(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]))
    with pytest.raises(ValueError, match="tets names point 9; there are 4"):
        _core.measure_tets(mesh.points, np.array([[0, 1, 2, 9]]))
    with pytest.raises(ValueError, match="coefficient has length 2; it must be 1"):
        _core.dual_edge_sums(mesh.points, mesh.tets, mesh.topology.tet_edges, 6, np.ones(2))
    with pytest.raises(ValueError, match="pairs name a tet or a facet that there is not"):
        _core.orthogonality(mesh.points, mesh.tets, np.array([[0, 0, 1, 0]]))
    with pytest.raises(ValueError, match="bins must be two numbers or more that ascend"):
        _core.dihedral_counts(mesh.points, mesh.tets, np.array([3.0, 1.0]))
