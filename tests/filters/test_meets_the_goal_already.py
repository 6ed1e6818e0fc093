"""A mesh that meets the goal already stays as it is, to the bit, unless a new one is asked for."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import ball, kuhn_cube, sphere_surface

from wct_plugin import apply_filter, read
from wct_plugin.cli import main
from wct_plugin.errors import OptionError
from wct_plugin.measure.deviation import measure_deviation

SPHERE = sphere_surface(2000)


def run(mesh, **options):
    return apply_filter("meshing_well_centered", mesh, **options)


def same(one, other):
    return np.array_equal(one.points, other.points) and np.array_equal(one.tets, other.tets)


def cube_84():
    return apply_filter("create_cube", variant=84)[0]


@pytest.mark.parametrize("boundary", ["move", "keep", "fixed"])
def test_a_mesh_that_meets_the_goal_stays_as_it_is(boundary):
    """Its smallest h/R is a hundredth of the margin, which is no reason to make it anew."""
    mesh = replace(cube_84(), point_data={"u": np.arange(35.0)}, cell_data={"v": np.arange(84)})
    kept, metrics = run(mesh, boundary=boundary)
    assert metrics["kept"]
    assert metrics["bad"] == 0
    assert same(kept, mesh)
    assert np.array_equal(kept.point_data["u"], mesh.point_data["u"])
    assert np.array_equal(kept.cell_data["v"], mesh.cell_data["v"])


@pytest.mark.parametrize("options", [{"force": True}, {"edge_length": 0.4}], ids=["force", "edge_length"])
def test_force_and_an_edge_length_make_it_anew(options):
    better, metrics = run(cube_84(), **options)
    assert not metrics["kept"]
    assert metrics["bad"] == 0
    assert not same(better, cube_84())


def test_a_second_run_changes_nothing_within_the_tolerance_of_the_reference():
    mesh = ball(4)
    once, metrics = run(mesh, reference=SPHERE, tolerance=1e-2)
    assert not metrics["kept"]
    twice, metrics = run(once, reference=SPHERE, tolerance=1e-2)
    assert metrics["kept"]
    assert same(twice, once)
    assert same(run(once, tolerance=1e-2)[0], once)  # the reference comes with the mesh
    nearer, metrics = run(once, reference=SPHERE, tolerance=3e-3)
    assert not metrics["kept"]
    assert measure_deviation(once.boundary_surface(), SPHERE).max > 3e-3 * SPHERE.diagonal
    assert measure_deviation(nearer.boundary_surface(), SPHERE).max <= 3e-3 * SPHERE.diagonal


def test_the_cheapest_change_cannot_be_forced():
    with pytest.raises(OptionError, match="force asks for a new mesh, goal delaunay for the cheapest change"):
        run(kuhn_cube(2), goal="delaunay", force=True)


def test_on_the_command_line_it_is_said_and_force_makes_it_anew(tmp_path, capsys):
    names = [str(tmp_path / name) for name in ("in.vtu", "out.vtu", "anew.vtu")]
    assert main.run(["create", "cube", names[0], "--variant", "84"]) == 0
    capsys.readouterr()
    assert main.run(["optimize", *names[:2]]) == 0
    assert "the mesh meets the goal already; it stays as it is (--force makes it anew)" in capsys.readouterr().out
    assert main.run(["optimize", names[0], names[2], "--force"]) == 0
    assert "stays as it is" not in capsys.readouterr().out
    first, second, third = map(read, names)
    assert same(first, second)
    assert not same(first, third)
