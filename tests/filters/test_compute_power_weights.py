"""Weighted well-centered: orthocenters by solving for them, shares of tets, and what is refused."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import csr_array, hstack
from support.builders import bcc, geodesic_ball, jittered_cube, kuhn_cube, shaken_cube
from support.comparing import assert_same
from support.flags import center
from support.refusals import refused

import wct_plugin as wct
from benchmarks.odt import odt_delaunay
from wct_plugin.errors import InputError, WctError
from wct_plugin.measure import quality
from wct_plugin.measure.duals import compute_duals
from wct_plugin.measure.negative_duals import count_negative_duals
from wct_plugin.measure.orthocenters import slopes
from wct_plugin.measure.quality import measure
from wct_plugin.mesh import TetMesh
from wct_plugin.weights import linear_programs
from wct_plugin.weights.infeasibility import contradiction


def weigh(mesh, **options):
    return wct.apply_filter("compute_power_weights", mesh, **options)


def barycentrics(mesh, weights):
    """(m, 4) of each tet's orthocenter, one linear system each."""
    return np.array([center(mesh.points[tet], weights[tet])[1] for tet in mesh.tets])


@pytest.fixture(scope="module")
def relaxed():
    """An ODT-relaxed ball with a boundary of acute triangles, an eighth of its tets without their circumcenter."""
    mesh = geodesic_ball(5)
    return TetMesh(*odt_delaunay(mesh.points, mesh.tets, sweeps=10))


def test_what_it_writes_is_true(relaxed):
    marked, metrics = weigh(relaxed)
    weights = marked.point_data["power_weight"]
    contained = (barycentrics(relaxed, weights) > 0).all(axis=1)
    assert np.array_equal(marked.cell_data["orthocenter_margin"] > 0, contained)
    assert metrics["weighted_well_centered"]["count"] == contained.sum()
    assert metrics["without_orthocenter"] == np.flatnonzero(~contained).tolist()
    assert metrics["3wc"]["count"] == measure(relaxed).well_centered_3.sum()
    assert metrics["3wc"]["percent"] < 95
    assert metrics["weighted_well_centered"]["percent"] > 99.9
    assert weights.min() == 0.0
    assert marked.point_data["weighted_dual_volume"].sum() == pytest.approx(measure(relaxed).volume.sum())
    assert_same(marked, relaxed, without=r"point_data|cell_data")
    assert not relaxed.point_data
    for kind, of in (("circumcentric", compute_duals(relaxed)), ("weighted", compute_duals(relaxed, weights))):
        assert metrics["negative_duals"][kind] == count_negative_duals(relaxed, of).to_dict()


def test_all_where_almost_all_contain_their_circumcenter():
    """Weights move orthocenters as positions move circumcenters: a few misses can always be mended."""
    mesh = bcc(5)
    points = mesh.points.copy()
    inner = np.flatnonzero(~mesh.topology.boundary_points)
    points[inner] += np.random.default_rng(0).uniform(-0.035, 0.035, (len(inner), 3))
    one = inner[np.argmin(np.linalg.norm(points[inner] - 2.5, axis=1))]
    points[one] += [0.3, 0.02, 0.0]
    moved = TetMesh(points, mesh.tets)
    share = measure(moved).well_centered_3.mean()
    assert 0.99 < share < 1.0
    marked, metrics = weigh(moved, strict=True, margin=0.02)
    assert metrics["weighted_well_centered"]["percent"] == 100.0
    assert metrics["margin"] == marked.cell_data["orthocenter_margin"].min() > 0.01
    found = compute_duals(moved, marked.point_data["power_weight"])
    assert min(found.lengths.min(), found.areas.min(), found.volumes.min()) > 0


def test_the_margin_of_sommervilles_tiling_is_not_lowered():
    """All heights are 0.3162 R there: the aim is what is reached, or what symmetry gives, with no weights needed."""
    mesh = bcc(3)
    plain = weigh(mesh, margin=1e-3)[1]["margin"]
    wide = weigh(mesh, margin=0.2)[1]["margin"]
    assert wide >= plain > 0.1


def test_slopes_are_differences():
    mesh = jittered_cube(2)
    table = slopes(mesh.points, mesh.tets)
    assert np.abs(table.sum(axis=2)).max() < 1e-12
    weights = np.random.default_rng(1).uniform(0.0, 0.1, len(mesh.points))
    lifted, plain = barycentrics(mesh, weights), barycentrics(mesh, 0.0 * weights)
    altitudes = 3.0 * measure(mesh).volume[:, None] / facet_areas(mesh)
    assert np.einsum("mfi,mi->mf", table, weights[mesh.tets]) == pytest.approx((lifted - plain) * altitudes)


def facet_areas(mesh):
    corners = mesh.points[mesh.tets[:, [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]]]
    return (
        np.linalg.norm(np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0]), axis=2) / 2
    )


def test_scale_does_not_matter():
    mesh = jittered_cube(2, 1)
    margins = [
        weigh(TetMesh(mesh.points * scale, mesh.tets), margin=0.02)[0].cell_data["orthocenter_margin"]
        for scale in (1.0, 1024.0)
    ]
    assert margins[0] == pytest.approx(margins[1], abs=1e-9)


def test_a_tet_too_flat_to_know_is_left_out():
    """Four points of a cube's face but for rounding: where its circumcenter lies is anyone's guess."""
    mesh = kuhn_cube(2)
    quad = [i for i in range(27) if mesh.points[i, 0] == 0.0 and mesh.points[i].max() <= 0.5]
    points = mesh.points.copy()
    a, b, c, d = quad
    points[a, 0] -= 1e-15
    flat = TetMesh(points, np.vstack([mesh.tets, [a, b, c, d]]))
    marked, metrics = weigh(flat)
    assert np.isfinite(marked.point_data["power_weight"]).all()
    assert len(mesh.tets) in metrics["without_orthocenter"]


def test_it_is_deterministic_and_can_be_stopped():
    mesh = shaken_cube(2)
    assert_same(weigh(mesh)[0], weigh(mesh)[0])
    seen = []
    stopped, metrics = weigh(mesh, progress=lambda state: seen.append(state) or False)
    assert len(seen) == 1
    assert metrics["weighted_well_centered"] == metrics["3wc"]
    assert (stopped.point_data["power_weight"] == 0).all()


def test_what_no_weights_can_do_is_proven():
    """The multipliers make a sum of all conditions that is the same for any weights, and not positive."""
    mesh = shaken_cube(2)
    metrics = weigh(mesh)[1]
    proven = metrics["contradictions"]["proven"]
    assert metrics["contradictions"]["missed_at_least"] == 1
    assert len(metrics["without_orthocenter"]) == len(proven) == 1
    one = proven[0]
    multipliers = np.array(one["multipliers"]) * measure(mesh).volume[one["tets"]] ** 2
    multipliers /= multipliers.max()
    sums = []
    for seed in range(5):
        weights = np.random.default_rng(seed).uniform(0.0, 0.2, len(mesh.points))
        sums.append(multipliers @ barycentrics(mesh, weights)[one["tets"], one["facets"]])
    assert min(multipliers) >= 0
    assert sums == pytest.approx([sums[0]] * 5, abs=1e-9)
    assert sums[0] < -1e-6
    assert metrics["without_orthocenter"][0] in one["tets"]


def test_programmes_leave_fewer_without_than_descent(monkeypatch):
    mended = weigh(shaken_cube(3), margin=1e-3)[1]["without_orthocenter"]
    monkeypatch.setattr(linear_programs, "_MENDED", 0)
    assert len(mended) < len(weigh(shaken_cube(3), margin=1e-3)[1]["without_orthocenter"])


def test_the_smallest_margin_is_almost_the_largest_there_can_be(relaxed):
    """One programme over all tets at once, which takes no longer than ours in a mesh as small as this, knows it."""
    heights = quality.heights(relaxed.points, relaxed.tets)[0]
    table = slopes(relaxed.points, relaxed.tets)
    edges = relaxed.points[relaxed.tets[:, [0, 0, 0, 1, 1, 2]]] - relaxed.points[relaxed.tets[:, [1, 2, 3, 2, 3, 3]]]
    length = np.sqrt((edges**2).sum(axis=2).mean(axis=1))
    count, size = len(relaxed.tets), len(relaxed.points)
    rows = np.repeat(np.arange(4 * count), 4)
    columns = np.repeat(relaxed.tets, 4, axis=0).ravel()
    matrix = csr_array((-(table / length[:, None, None]).ravel(), (rows, columns)), shape=(4 * count, size))
    system = hstack([matrix, csr_array(np.ones((4 * count, 1)))])
    bounds = [(None, None)] * size + [(None, 0.1)]
    best = linprog(
        np.append(np.zeros(size), -1.0), system, (heights / length[:, None]).ravel(), bounds=bounds, method="highs"
    )
    assert 0.9 * -best.fun < weigh(relaxed)[1]["margin"] < -best.fun * (1 + 1e-6)


def test_nothing_contradicts_itself_where_weights_exist():
    mesh = bcc(2)
    heights = quality.heights(mesh.points, mesh.tets)[0]
    kept = np.ones(len(mesh.tets), dtype=bool)
    assert all(contradiction(mesh.points, mesh.tets, heights, tet, kept) is None for tet in range(len(mesh.tets)))


def test_refusals(tmp_path, capsys):
    with pytest.raises(
        WctError, match=r"give tet \d+ its orthocenter; none exist: tets( \d+)+ exclude each other; with"
    ):
        weigh(shaken_cube(2), strict=True)
    grid = kuhn_cube(1)
    with pytest.raises(InputError, match=r"points 0 and 6 are both \(0.0, 0.0, 0.0\) \(and 3 more\); each place"):
        weigh(TetMesh(np.vstack([grid.points, grid.points]), np.vstack([grid.tets[:3], grid.tets[3:] + 8])))
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, 0], [0, 0, -1], [-1, 0, 0]], dtype=float)
    by_edge = TetMesh(corners, [[0, 1, 2, 3], [0, 1, 4, 5]])
    with pytest.raises(InputError, match=r"edge \(0, 1\) is in 4 boundary facets; at most two"):
        weigh(by_edge)
    by_point = TetMesh(corners, [[0, 1, 2, 3], [0, 4, 5, 6]])
    with pytest.raises(InputError, match="several sheets of the boundary touch at point 0; each"):
        weigh(by_point)
    wct.write(tmp_path / "in.vtu", by_edge)
    chain = tmp_path / "chain.json"
    chain.write_text(f'["{tmp_path / "in.vtu"}", "filters.compute_power_weights", "{tmp_path / "out.vtu"}"]')
    chain.write_text(
        chain.read_text().replace('"filters.compute_power_weights"', '{"type": "filters.compute_power_weights"}')
    )
    assert "in.vtu: edge (0, 1) is in 4 boundary facets" in refused(capsys, "run", chain)
    with pytest.raises(wct.OptionError, match=r"option 'margin' is 0\.3"):
        weigh(grid, margin=0.3)
