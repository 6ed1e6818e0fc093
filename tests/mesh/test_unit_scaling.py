"""Size is no matter: the same mesh at any power of two gives the same bits, at any other size a mesh as good."""

import re
from dataclasses import replace

import numpy as np
import pytest
from support.builders import ball, cylinder, jittered_cube, kuhn_cube, sphere_surface, two_region_cube
from support.refusals import refused

from wct_plugin import apply_filter, write
from wct_plugin.errors import InputError
from wct_plugin.measure import duals, quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import SurfaceMesh, unit_scaling
from wct_plugin.reports.report import make_report

EXPONENTS = [-298, -20, 297]
SPHERE = sphere_surface(500)


def test_the_unit_brings_the_diagonal_to_that_of_the_unit_cube_or_near():
    for points in ([[0, 0, 0], [0.5, 3.99, 1]], [[1e-90, 0, 0], [3e-90, 0, 0]], [[-7e89, 1, 2], [7e89, 3, 4]]):
        assert 1.5 <= np.linalg.norm(np.ptp(unit_scaling.normalized(np.array(points, dtype=float)), axis=0)) < 3.0
    assert unit_scaling.exponent(kuhn_cube(1).points) == 0
    assert unit_scaling.exponent(np.ones((3, 3))) == 0


def test_there_and_back_changes_nothing():
    mesh = replace(ball(3), reference=SPHERE, point_data={"h": np.arange(len(ball(3).points))})
    small = unit_scaling.scaled(mesh, -250)
    assert np.array_equal(small.points, mesh.points * 2.0**-250)
    assert np.array_equal(small.reference.points, SPHERE.points * 2.0**-250)
    assert np.array_equal(small.point_data["h"], mesh.point_data["h"])
    back = unit_scaling.scaled(small, 250)
    assert np.array_equal(back.points, mesh.points)
    assert np.array_equal(back.reference.points, SPHERE.points)


MESHES = {
    "move": (ball(3), {"goal": "3wc", "tolerance": 1e-2, "reference": SPHERE}),
    "edge length": (kuhn_cube(2), {"goal": "3wc", "edge_length": "h"}),
    "regions": (two_region_cube(4), {"goal": "3wc"}),
    "fixed": (cylinder(8, 2), {"goal": "3wc", "boundary": "fixed"}),
    "keep": (ball(2), {"goal": "3wc", "boundary": "keep"}),
    "Delaunay": (ball(3), {"goal": "delaunay"}),
    "one-sided": (ball(3), {"goal": "one-sided", "tolerance": 1e-2, "reference": SPHERE}),
    "one-sided, fixed": (jittered_cube(3, 1, 0.1), {"goal": "one-sided", "boundary": "fixed"}),
    "vertices only": (jittered_cube(3), {}),
}


def optimized(name, by):
    """The result brought back, and its metrics; of the point data only ``h`` is a length."""
    mesh, options = MESHES[name]
    heat = mesh.points @ [1.0, 2.0, 3.0]
    lengths = np.ldexp(np.full(len(mesh.points), 0.3), by)
    mesh = unit_scaling.scaled(replace(mesh, point_data={"h": lengths, "heat": heat}), by)
    if "reference" in options:
        options = {**options, "reference": unit_scaling.scaled(options["reference"], by)}
    filter_name = "apply_coord_well_centering" if name == "vertices only" else "meshing_well_centered"
    better, metrics = apply_filter(filter_name, mesh, **options)
    assert better.reference is options.get("reference")
    return np.ldexp(better.points, -by), better.tets, better.point_data["heat"], metrics


# Spheres as coarse as these bend their edges and change their volume a little with most seeds, and say so.
@pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")
@pytest.mark.parametrize("name", MESHES)
def test_a_power_of_two_changes_no_bit(name):
    points, tets, heat, metrics = optimized(name, 0)
    for by in EXPONENTS:
        again = optimized(name, by)
        assert np.array_equal(again[1], tets)
        assert np.array_equal(again[0], points)
        assert np.array_equal(again[2], heat)
        if "deviation" in metrics:
            assert again[3]["deviation"]["max"] == np.ldexp(metrics["deviation"]["max"], by)
            for fraction in ("shape", "tolerance"):
                assert again[3][fraction] == metrics[fraction]


@pytest.mark.parametrize("size", [1e-88, 1e-30, 1e-3, 1e70, 2e89])
def test_any_size_becomes_well_centered_within_the_tolerance(size):
    mesh = ball(4)
    surface = SurfaceMesh(SPHERE.points * size, SPHERE.triangles)
    better, metrics = apply_filter(
        "meshing_well_centered", replace(mesh, points=mesh.points * size), goal="3wc", tolerance=5e-3, reference=surface
    )
    assert metrics["bad"] == 0
    ordinary = replace(better, points=better.points / size, reference=None)
    assert quality.measure(ordinary).well_centered_3.all()
    apart = measure_deviation(ordinary.boundary_surface(), SPHERE).max
    assert apart <= 5e-3 * SPHERE.diagonal
    assert metrics["deviation"]["fraction_of_diagonal"] == pytest.approx(apart / SPHERE.diagonal, rel=1e-9)
    assert metrics["volumes"]["0"]["after"] / size**2 / size == pytest.approx(4.0 / 3.0 * np.pi, rel=0.05)


def test_the_report_is_the_same_at_any_size():
    mesh = replace(jittered_cube(3, 1), reference=SPHERE)
    expected = make_report(mesh).to_dict()
    for by in EXPONENTS:
        found = make_report(unit_scaling.scaled(mesh, by)).to_dict()
        assert found["volume"] == np.ldexp(expected["volume"], 3 * by)
        assert found["deviation"]["max"] == np.ldexp(expected["deviation"]["max"], by)
        assert found["deviation"]["fraction_of_diagonal"] == expected["deviation"]["fraction_of_diagonal"]
        for tet, other in zip(found["worst"], expected["worst"], strict=True):
            assert tet.pop("centroid") == np.ldexp(other["centroid"], by).tolist()
            assert tet == {key: value for key, value in other.items() if key != "centroid"}
        sized = ("volume", "deviation", "worst")
        assert {key: found[key] for key in found if key not in sized} == {
            key: expected[key] for key in expected if key not in sized
        }


@pytest.mark.parametrize("weights", [None, np.linspace(0.0, 0.02, 27)], ids=["circumcentric", "power"])
def test_duals_and_hodge_stars_scale_as_their_units_say(weights):
    mesh = jittered_cube(2, 1)
    powers = {0: 3, 1: 1, 2: -1, 3: -3}
    expected = duals.compute_duals(mesh, weights)
    for by in EXPONENTS:
        bigger = unit_scaling.scaled(mesh, by)
        found = duals.compute_duals(bigger, None if weights is None else np.ldexp(weights, 2 * by))
        for k, power in powers.items():
            star = duals.hodge_star(bigger, k, found)
            assert np.array_equal(np.ldexp(star, -power * by), duals.hodge_star(mesh, k, expected))


def test_sampling_steps_are_lengths_of_the_surfaces():
    small, near = SPHERE, sphere_surface(300)
    expected = measure_deviation(small, near, 0.02)
    found = measure_deviation(unit_scaling.scaled(small, -280), unit_scaling.scaled(near, -280), np.ldexp(0.02, -280))
    assert np.ldexp(found.max_ab, 280) == expected.max_ab
    assert np.ldexp(found.at_ba, 280).tolist() == list(expected.at_ba)
    assert np.ldexp(found.error_ab, 280) == expected.error_ab


@pytest.mark.parametrize("size", [1e-250, 1e-95, 1e95, 1e250])
@pytest.mark.parametrize(
    "name",
    [
        "meshing_well_centered",
        "apply_coord_well_centering",
        "compute_power_weights",
        "compute_scalar_by_well_centeredness",
        "get_quality",
    ],
)
def test_sizes_whose_volumes_are_no_numbers_are_refused(name, size):
    mesh = kuhn_cube(1)
    message = re.escape(
        f"the mesh: the bounding box's diagonal is {np.sqrt(3.0) * size:.3g}; allowed is 1e-90 to 1e+90"
    )
    with pytest.raises(InputError, match=message):
        apply_filter(name, replace(mesh, points=mesh.points * size))


def test_the_command_line_names_file_size_and_range(tmp_path, capsys):
    mesh = kuhn_cube(1)
    path = tmp_path / "tiny.vtu"
    write(path, replace(mesh, points=mesh.points * 1e-100))
    expected = (
        f"{path}: the bounding box's diagonal is 1.73e-100; allowed is 1e-90 to 1e+90: choose another unit of length"
    )
    assert refused(capsys, "report", path).endswith(expected)
    assert refused(capsys, "optimize", path, tmp_path / "out.vtu").endswith(expected)
    assert not (tmp_path / "out.vtu").exists()


@pytest.mark.parametrize("by", [-200, 200])
def test_a_reference_of_quite_another_size_is_refused(by):
    far = unit_scaling.scaled(SPHERE, by)
    with pytest.raises(
        InputError, match=r"^the reference: the bounding box's diagonal is \S+, that of the mesh 1.73; "
    ):
        apply_filter("meshing_well_centered", kuhn_cube(1), reference=far)
    with pytest.raises(InputError, match=r"allowed is a factor of 1e\+20 between them$"):
        make_report(replace(kuhn_cube(1), reference=far))
