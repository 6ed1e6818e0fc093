"""The energy against its definition in NumPy, its gradient against differences."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from support.core_meshes import cosines, cube, flatness, heights, rotation, volumes

from wct_plugin.core import _core

FORMS = [
    {"margin3": 0.12, "power3": 2.5, "margin2": 0.08, "power2": 2.5, "weight2": 0.0, "weight_quality": 0.003},
    {"margin3": 0.12, "power3": 2.5, "margin2": 0.08, "power2": 2.0, "weight2": 0.5, "weight_quality": 0.003},
    {"margin3": 0.9, "power3": 2.0, "margin2": 0.9, "power2": 3.0, "weight2": 2.0, "weight_quality": 0.0},
    {"margin3": 0.6, "power3": 3.0, "margin2": 0.7, "power2": 1.5, "weight2": 1.0, "weight_quality": 0.1},
    {"margin3": 0.9, "power3": 1.5, "margin2": 0.9, "power2": 1.0, "weight2": 1.0, "weight_quality": 0.0},
    {"margin3": 0.7, "power3": 1.7, "margin2": 0.5, "power2": 2.2, "weight2": 1.0, "weight_quality": 0.2},
]
ONE_TET = np.array([[0, 1, 2, 3]])
coordinates = arrays(np.float64, (4, 3), elements=st.floats(-1, 1, width=32))


def expected_energy(points, tets, form):
    h, c = heights(points, tets), cosines(points, tets)
    return (
        (np.maximum(0, form["margin3"] - h) ** form["power3"]).sum(axis=1)
        + form["weight2"] * (np.maximum(0, form["margin2"] - c) ** form["power2"]).sum(axis=1)
        + form["weight_quality"] * ((h - 1 / 3) ** 2).sum(axis=1)
    )


def squashed(seed, thickness):
    """A positive tet between a fat one and a flat one."""
    rng = np.random.default_rng(seed)
    points = rng.standard_normal((4, 3)) * [1, 1, thickness]
    return points if volumes(points, ONE_TET)[0] > 0 else points[[0, 1, 3, 2]]


@pytest.mark.parametrize("form", FORMS)
def test_energy_is_its_definition(form):
    mesh = cube(cells=3)
    energies, _ = _core.tet_energy(mesh.points, mesh.tets, **form)
    np.testing.assert_allclose(energies, expected_energy(mesh.points, mesh.tets, form), rtol=1e-10, atol=1e-13)
    assert np.ptp(energies) > 0


@pytest.mark.parametrize("thickness", [1.0, 0.1, 0.01, 0.001])
@pytest.mark.parametrize("form", FORMS)
def test_gradient_is_the_slope(form, thickness):
    for seed in range(10):
        points = squashed(seed, thickness)
        if flatness(points, ONE_TET)[0] < 1e-4:
            continue
        _, gradient = _core.tet_energy(points, ONE_TET, **form)
        step = 1e-6 * thickness
        slopes = np.zeros((4, 3))
        for i in np.ndindex(4, 3):
            ahead, behind = points.copy(), points.copy()
            ahead[i] += step
            behind[i] -= step
            slopes[i] = (
                _core.tet_energy(ahead, ONE_TET, **form)[0][0] - _core.tet_energy(behind, ONE_TET, **form)[0][0]
            ) / (2 * step)
        np.testing.assert_allclose(gradient, slopes, rtol=2e-5, atol=2e-5 * (1e-3 + np.abs(slopes).max()))


@settings(max_examples=60, deadline=None)
@given(coordinates, st.sampled_from(FORMS))
def test_gradient_predicts_small_steps(points, form):
    """Along random directions, and with no more asked than a tet away from flat can give."""
    if volumes(points, ONE_TET)[0] < 0:
        points = points[[0, 1, 3, 2]].copy()
    assume(np.isfinite(flatness(points, ONE_TET)[0]) if np.ptp(points) > 0.1 else False)
    assume(flatness(points, ONE_TET)[0] > 0.01)
    assume(min(np.linalg.norm(points[i] - points[j]) for i in range(4) for j in range(i)) > 0.1)
    # Away from the hinges' kinks, where a power of 1 has no slope.
    values = np.concatenate(
        [heights(points, ONE_TET).ravel() - form["margin3"], cosines(points, ONE_TET).ravel() - form["margin2"]]
    )
    assume(np.abs(values).min() > 1e-3)
    _, gradient = _core.tet_energy(points, ONE_TET, **form)
    direction = np.random.default_rng(1).standard_normal((4, 3))
    step = 1e-6
    ahead, behind = (_core.tet_energy(points + s * direction, ONE_TET, **form)[0][0] for s in (step, -step))
    scale = np.linalg.norm(gradient) * np.linalg.norm(direction)
    assert (ahead - behind) / (2 * step) == pytest.approx((gradient * direction).sum(), abs=1e-4 * (1 + scale))


@pytest.mark.parametrize("form", FORMS)
def test_gradient_of_a_mesh_sums_its_tets(form):
    mesh = cube(cells=2)
    _, gradient = _core.tet_energy(mesh.points, mesh.tets, **form)
    total = np.zeros_like(mesh.points)
    for tet in mesh.tets:
        total[tet] += _core.tet_energy(np.ascontiguousarray(mesh.points[tet]), ONE_TET, **form)[1]
    np.testing.assert_allclose(gradient, total, rtol=1e-12, atol=1e-12 * np.abs(total).max())


@pytest.mark.parametrize("form", FORMS)
def test_a_star_is_its_part_of_the_mesh(form):
    """Every point, whichever corner of its tets it is."""
    mesh = cube(cells=3)
    energies, gradient = _core.tet_energy(mesh.points, mesh.tets, **form)
    for point in range(len(mesh.points)):
        energy, slope = _core.star_energy(mesh.points, mesh.tets, point, **form)
        around = energies[(mesh.tets == point).any(axis=1)]
        assert energy == pytest.approx(around.sum(), rel=1e-10)
        np.testing.assert_allclose(slope, gradient[point], rtol=1e-8, atol=1e-9 * np.abs(gradient).max())
    with pytest.raises(ValueError, match="no point 64"):
        _core.star_energy(mesh.points, mesh.tets, 64, **form)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(1e-6, 1e6), st.floats(-10, 10), st.sampled_from(FORMS))
def test_rigid_motion_and_scale_change_nothing(seed, scale, shift, form):
    mesh = cube(cells=2)
    turn = rotation(seed)
    energies, gradient = _core.tet_energy(mesh.points, mesh.tets, **form)
    there = np.ascontiguousarray(scale * (mesh.points @ turn.T + shift))
    moved_energies, moved_gradient = _core.tet_energy(there, mesh.tets, **form)
    np.testing.assert_allclose(moved_energies, energies, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(scale * moved_gradient @ turn, gradient, rtol=1e-6, atol=1e-7 * np.abs(gradient).max())


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.permutations(range(4)), st.sampled_from(FORMS))
def test_renumbering_changes_nothing(seed, order, form):
    points = squashed(seed, 0.5)
    assume(flatness(points, ONE_TET)[0] > 1e-3)
    order = list(order)
    if volumes(points[order], ONE_TET)[0] < 0:
        order[2], order[3] = order[3], order[2]
    energy, gradient = _core.tet_energy(points, ONE_TET, **form)
    other, turned = _core.tet_energy(np.ascontiguousarray(points[order]), ONE_TET, **form)
    assert other[0] == pytest.approx(energy[0], rel=1e-8, abs=1e-12)
    np.testing.assert_allclose(turned, gradient[order], rtol=1e-6, atol=1e-6 * np.abs(gradient).max())


def test_regular_tet_has_no_energy():
    points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    form = FORMS[1] | {"weight_quality": 1.0}
    energies, gradient = _core.tet_energy(points, np.array([[0, 2, 1, 3]]), **form)
    np.testing.assert_allclose(energies, 0, atol=1e-30)
    np.testing.assert_allclose(gradient, 0, atol=1e-15)


@pytest.mark.parametrize(("height", "finite"), [(2e-5, True), (0.5e-5, False), (0.0, False), (-1.0, False)])
def test_flat_and_inverted_tets_are_infinite_and_pull_nothing(height, finite):
    side = 3**0.5 / 2
    # With longest edge 1 and a base of area side / 2 the flatness is side * height.
    points = np.array([[0, 0, 0], [1, 0, 0], [0.5, side, 0], [0.5, 0.3, height / side]])
    energies, gradient = _core.tet_energy(points, ONE_TET, **FORMS[0])
    assert np.isfinite(energies[0]) == finite
    assert np.isfinite(gradient).all()
    assert gradient.any() == finite


def test_lanes_do_not_mix():
    """Tets are measured several at a time: their energies must be those of each alone, to the bit."""
    mesh = cube(cells=2)
    together, _ = _core.tet_energy(mesh.points, mesh.tets, **FORMS[1])
    alone = [_core.tet_energy(mesh.points, mesh.tets[i : i + 1], **FORMS[1])[0][0] for i in range(len(mesh.tets))]
    assert together.tolist() == alone


def test_bad_arguments_are_refused():
    mesh = cube(cells=2)
    with pytest.raises(ValueError, match=r"points has shape \(27, 2\)"):
        _core.tet_energy(np.ascontiguousarray(mesh.points[:, :2]), mesh.tets, **FORMS[0])
    with pytest.raises(ValueError, match=r"tets has shape \(48, 3\)"):
        _core.tet_energy(mesh.points, np.ascontiguousarray(mesh.tets[:, :3]), **FORMS[0])
    with pytest.raises(ValueError, match="tets names point 27; there are 27"):
        _core.tet_energy(mesh.points, mesh.tets + 1, **FORMS[0])
    with pytest.raises(ValueError, match="tets names point -1"):
        _core.tet_energy(mesh.points, mesh.tets - 1, **FORMS[0])
    with pytest.raises(ValueError, match="tets must hold int64"):
        _core.tet_energy(mesh.points, mesh.tets.astype(np.int32), **FORMS[0])
    with pytest.raises(ValueError, match="points must hold float64"):
        _core.tet_energy(mesh.points.astype(np.float32), mesh.tets, **FORMS[0])
    points = mesh.points.copy()
    points[3, 1] = np.nan
    with pytest.raises(ValueError, match="point 3 is not finite"):
        _core.tet_energy(points, mesh.tets, **FORMS[0])
    with pytest.raises(ValueError, match="powers"):
        _core.tet_energy(mesh.points, mesh.tets, **FORMS[0] | {"power3": 0.5})


def test_no_tets():
    energies, gradient = _core.tet_energy(np.zeros((2, 3)), np.zeros((0, 4), dtype=np.int64), **FORMS[0])
    assert energies.shape == (0,)
    assert (gradient == np.zeros((2, 3))).all()
