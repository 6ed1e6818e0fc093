"""Options are declared once and refused clearly; the registry knows our filters; a chain is checked before it runs."""

from typing import Literal

import pytest
from builders import jittered_cube, sphere_surface
from pydantic import Field

from wct_plugin import pipeline
from wct_plugin.errors import OptionError, WctError
from wct_plugin.mesh import TetMesh
from wct_plugin.stage import Filter, Options, apply_filter, filter_names, find_filter


class ShiftOptions(Options):
    by: float = Field(1.0, gt=0, le=2, description="How far")
    axis: Literal["x", "y"] = Field("x", description="Where to")


class Shift(Filter[ShiftOptions]):
    """Shift the mesh."""

    name = "shift"
    takes = TetMesh
    gives = TetMesh
    declaration = ShiftOptions

    def run(self, mesh, progress):
        return mesh, {"by": self.options.by}


def test_our_filters_are_registered():
    assert filter_names() == [
        "apply_coord_well_centering",
        "compute_scalar_by_well_centeredness",
        "generate_boundary_surface",
        "generate_tetrahedralization",
        "get_quality",
        "meshing_well_centered",
        "meshlab",
    ]
    for name in filter_names():
        found = find_filter(f"filters.{name}")
        assert found.name == name
        assert found.summary().endswith((".", ":"))
        for field in found.declaration.model_fields.values():
            assert field.description


def test_a_filter_is_validated_before_it_runs():
    class Picky(Shift):
        """Shift nothing."""

        def validate(self):
            raise OptionError("no such file")

        def run(self, mesh, progress):
            raise AssertionError

    with pytest.raises(OptionError, match="no such file"):
        Picky()(jittered_cube(2, 0))


def test_defaults_and_given_options():
    assert Shift().options == ShiftOptions(by=1.0, axis="x")
    assert Shift(by=2).options.by == 2.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"bye": 1}, "filters.shift: unknown option 'bye'; did you mean 'by'? (allowed: by, axis)"),
        ({"by": 3}, "filters.shift: option 'by' is 3; input should be less than or equal to 2"),
        ({"by": float("nan")}, "filters.shift: option 'by' is nan; input should be a finite number"),
        ({"by": "far"}, "filters.shift: option 'by' is 'far'; input should be a valid number"),
        ({"axis": "z"}, "filters.shift: option 'axis' is 'z'; input should be 'x' or 'y'"),
    ],
)
def test_bad_options_name_option_value_and_range(options, message):
    with pytest.raises(OptionError) as caught:
        Shift(**options)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def test_unknown_filter():
    with pytest.raises(OptionError, match=r"unknown filter 'get_qualty'; did you mean 'get_quality'\? \(allowed: "):
        find_filter("get_qualty")


def test_a_filter_that_cannot_be_imported_is_named(monkeypatch):
    from importlib.metadata import EntryPoint

    broken = EntryPoint("broken", "no_such_module_here:Filter", "wct_plugin.filters")
    monkeypatch.setattr("wct_plugin.stage._entries", lambda: {"broken": broken})
    with pytest.raises(WctError, match=r"filters.broken \(no_such_module_here:Filter\) cannot be imported: ModuleNotF"):
        find_filter("broken")


def test_a_surface_where_tets_are_needed():
    message = "filters.shift needs a tet mesh, here is a surface; put filters.generate_tetrahedralization before it"
    with pytest.raises(OptionError, match=message):
        Shift()(sphere_surface(20))


def test_the_whole_chain_is_checked_before_anything_runs():
    mesher = find_filter("generate_tetrahedralization")()
    assert pipeline.check(type(sphere_surface(20)), [mesher, Shift()]) is TetMesh
    with pytest.raises(OptionError, match="generate_tetrahedralization needs a surface, here is a tet mesh"):
        pipeline.run(jittered_cube(3, 0), [Shift(), mesher])


def test_a_chain_gives_each_filters_metrics():
    mesh = jittered_cube(3, 0)
    out, metrics = pipeline.run(mesh, [Shift(by=2), find_filter("get_quality")()])
    assert out is mesh
    assert metrics["shift"] == {"by": 2.0}
    assert metrics["get_quality"]["tets"] == len(mesh.tets)


def test_apply_filter_refuses_unknown_options():
    with pytest.raises(OptionError, match="unknown option 'wurst'"):
        apply_filter("get_quality", jittered_cube(3, 0), wurst=3)
