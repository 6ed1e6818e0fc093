"""The tilings of space, slabs and prisms: closed forms, the condition on a and b, and periods that fit."""

import numpy as np
import pytest
from support.printed import PAPER_TETS, columns

import wct_plugin as wct
from wct_plugin.errors import OptionError
from wct_plugin.measure import quality
from wct_plugin.mesh.topology import FACETS


def tiling(**options):
    return wct.apply_filter("create_lattice_tiling", **options)


def test_the_default_is_sommervilles():
    mesh, metrics = tiling(nx=3, p=2, q=3)
    assert len(mesh.tets) == 6 * 3 * 2 * 3
    assert columns(mesh) == PAPER_TETS["sommerville"][1]
    assert metrics["condition_met"]
    assert metrics["completely_well_centered"]


@pytest.mark.parametrize("a", [0.3, 0.5, 0.51, 0.7, 1.1])
@pytest.mark.parametrize("b", [0.4, 0.5, 0.501, 0.9, 3.0])
def test_well_centered_if_and_only_if_a_and_b_exceed_one_half(a, b):
    mesh, metrics = tiling(a=a, b=b, nx=2, p=2, q=2)
    assert not mesh.repairs
    assert metrics["condition_met"] == (a > 0.5 and b > 0.5)
    assert metrics["completely_well_centered"] == metrics["condition_met"]
    volumes = quality.volumes(mesh.points, mesh.tets)
    assert volumes == pytest.approx(np.full(len(volumes), a * b / 6), rel=1e-12)


def test_circumcenters_of_the_first_type_are_the_closed_form():
    a, b = 0.8, 0.65
    mesh, _ = tiling(a=a, b=b, nx=1, p=1, q=1)
    first = (mesh.points[mesh.tets] == 0).all(axis=2).any(axis=1)  # with the origin, at the end of an edge along x
    with_edge = (mesh.points[mesh.tets] == [1, 0, 0]).all(axis=2).any(axis=1)
    (tet,) = np.flatnonzero(first & with_edge)
    center = quality.circumcenters(mesh.points, mesh.tets[tet : tet + 1])[0]
    assert center == pytest.approx([0.5, (a * a - 0.25) / (2 * a), (b * b - 0.25) / (2 * b)], rel=1e-13)


@pytest.mark.parametrize(
    ("a", "height", "tets"), [(0.55, 0.095, 3.3), (1.0, 0.076, 1.8), (1.65, 0.053, 1.1), (3, 0.031, 0.6)]
)
def test_a_slab_of_one_layer_may_be_stretched(a, height, tets):
    """In one direction, with clearance and number as in docs/hardness.md."""
    mesh, _ = tiling(domain="slab", q=1, a=a, b=0.55, nx=2, p=2)
    measured = quality.measure(mesh)
    assert measured.min_height.min() == pytest.approx(height, abs=1e-3)
    assert np.cos(np.radians(measured.max_face_angle.max())) == pytest.approx(0.095, abs=1e-3)
    volume = quality.volumes(mesh.points, mesh.tets).sum()
    assert len(mesh.tets) * 0.55**3 / volume == pytest.approx(tets, abs=0.06)


@pytest.mark.parametrize(("domain", "repeats"), [("cell", 3), ("slab", 2), ("prism", 1)])
@pytest.mark.parametrize("counts", [(3, 2, 2), (4, 3, 1), (3, 3, 3)])
def test_periods_close_the_domain(domain, repeats, counts):
    """With points that periods take to each other made one, facets are shared by two but on the flat sides."""
    nx, p, q = counts
    mesh, metrics = tiling(a=0.9, b=0.6, domain=domain, nx=nx, p=p, q=q)
    classes = mesh.point_data["periodic_class"]
    assert len(metrics["periods"]) == repeats
    for period in np.array(metrics["periods"]):  # points that differ by a period are of one class
        shifted = mesh.points[:, None] - mesh.points[None] - period
        one, other = np.nonzero(np.abs(shifted).max(axis=2) < 1e-9)
        assert len(one)
        assert np.array_equal(classes[one], classes[other])
    vertices = nx * (p + (domain == "prism")) * (q + (domain != "cell"))
    assert len(np.unique(classes)) == vertices
    triples = np.sort(classes[mesh.tets][:, FACETS].reshape(-1, 3), axis=1)
    if min(nx, p, q) >= 3:  # fewer, and different facets may have the same three classes
        _, times = np.unique(triples, axis=0, return_counts=True)
        sides = {"cell": 0, "slab": 2 * p, "prism": 2 * (p + q)}[domain]
        assert (times == 1).sum() == 2 * nx * sides
        assert times.max() == 2
    flat_sides = {"cell": (), "slab": (2,), "prism": (1, 2)}[domain]
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    for axis in flat_sides:
        assert low[axis] == 0
        assert high[axis] == pytest.approx([0, p * 0.9, q * 0.6][axis])


def test_sizes():
    slab, _ = tiling(domain="slab", q=3, size=0.25)
    assert np.ptp(slab.points[:, 2]) == pytest.approx(0.25, rel=1e-14)
    prism, _ = tiling(domain="prism", p=3, q=2, size=1.5)
    assert np.ptp(prism.points, axis=0)[1:] == pytest.approx([1.5, 1.0], rel=1e-14)
    cell, metrics = tiling(nx=4, size=10)
    assert metrics["periods"][0] == pytest.approx([10, 0, 0])
    assert quality.volumes(cell.points, cell.tets).sum() == pytest.approx(10 * 2 * 2 * 2.5**2 / 2, rel=1e-13)
    edges, _ = tiling(edge_length=2.0)
    assert edges.points[:, 0].max() == pytest.approx(2.0 * 2.5)


@pytest.mark.parametrize("options", [{"a": 0}, {"b": -1.0}, {"nx": 0}, {"size": 0.0}])
def test_options_out_of_range_are_refused(options):
    ((name, value),) = options.items()
    with pytest.raises(OptionError, match=rf"option '{name}' is {value}; input should be greater than"):
        tiling(**options)


def test_two_scales_are_refused():
    with pytest.raises(OptionError, match="exclude each other"):
        tiling(size=1, edge_length=1)
