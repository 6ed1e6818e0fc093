"""Options are declared once and refused clearly; the registry knows ours and says what is wrong with others'."""

from importlib.metadata import EntryPoint
from typing import Literal

import pytest
from pydantic import Field, model_validator
from support.builders import jittered_cube, sphere_surface

from wct_plugin.errors import OptionError, WctError
from wct_plugin.mesh import TetMesh
from wct_plugin.pipeline.stage import FilterStage, Options, apply_filter, filter_names, find_filter, parse_options


class ShiftOptions(Options):
    by: float = Field(1.0, gt=0, le=2, description="How far")
    axis: Literal["x", "y"] = Field("x", description="Where to")


class Shift(FilterStage[ShiftOptions]):
    """Shift the mesh."""

    name = "shift"
    takes = TetMesh
    gives = TetMesh
    declaration = ShiftOptions

    def run(self, mesh, progress):
        return mesh, {"by": self.options.by}


class TaggedOptions(Options):
    tag: str = Field("", description="Not to be had")


class Tagged(Shift):
    """Shift, with a label."""

    name = "odd"
    declaration = TaggedOptions


def test_our_filters_are_registered():
    assert filter_names() == [
        "apply_coord_well_centering",
        "compute_power_weights",
        "compute_scalar_by_well_centeredness",
        "create_cube",
        "create_cube_corner",
        "create_from_voxels",
        "create_lattice_tiling",
        "create_tetrahedron",
        "create_tetrahedron_subdivision",
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


class PairOptions(Options):
    low: float = Field(0.0, description="Least")
    high: float = Field(description="Greatest")

    @model_validator(mode="after")
    def _ordered(self):
        if self.low > self.high:
            raise ValueError("'low' must not be above 'high'")
        return self


def test_options_that_are_missing_or_do_not_fit_together():
    for values, message in (({}, "here: option 'high' is missing"), ({"low": 2, "high": 1}, "here: 'low' must not be")):
        with pytest.raises(OptionError, match=message):
            parse_options(PairOptions, values, "here")


def test_a_filter_validates_before_it_runs():
    class Picky(Shift):
        def validate(self):
            raise OptionError("no such neighbour")

    with pytest.raises(OptionError, match="no such neighbour"):
        Picky()(jittered_cube(2, 0))


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("support.builders:bcc", "is not a wct_plugin.plugins.FilterStage"),
        (f"{__name__}:Shift", "calls itself 'shift'; both names must be the same"),
        (f"{__name__}:Tagged", "has an option 'tag', which means something else in a pipeline"),
    ],
)
def test_what_is_registered_as_a_filter_and_is_none(monkeypatch, value, message):
    monkeypatch.setattr(
        "wct_plugin.pipeline.stage._entries", lambda: {"odd": EntryPoint("odd", value, "wct_plugin.filters")}
    )
    with pytest.raises(WctError, match=message):
        find_filter("odd")


def test_of_two_filters_of_one_name_neither_is_taken(monkeypatch):
    entries = [EntryPoint("twin", f"{package}:Twin", "wct_plugin.filters") for package in ("one", "other")]
    monkeypatch.setattr("wct_plugin.pipeline.stage.entry_points", lambda group: entries)
    with pytest.raises(WctError, match=r"filters.twin \(one:Twin and other:Twin\) is registered twice"):
        find_filter("twin")


def test_unknown_filter():
    with pytest.raises(OptionError, match=r"unknown filter 'get_qualty'; did you mean 'get_quality'\? \(allowed: "):
        find_filter("get_qualty")


def test_a_filter_that_cannot_be_imported_is_named(monkeypatch):
    broken = EntryPoint("broken", "no_such_module_here:Filter", "wct_plugin.filters")
    monkeypatch.setattr("wct_plugin.pipeline.stage._entries", lambda: {"broken": broken})
    with pytest.raises(WctError, match=r"filters.broken \(no_such_module_here:Filter\) cannot be imported: ModuleNotF"):
        find_filter("broken")


def test_a_surface_where_tets_are_needed():
    message = "filters.shift needs a tet mesh, here is a surface; put filters.generate_tetrahedralization before it"
    with pytest.raises(OptionError, match=message):
        Shift()(sphere_surface(20))


def test_apply_filter_refuses_unknown_options():
    with pytest.raises(OptionError, match="unknown option 'wurst'"):
        apply_filter("get_quality", jittered_cube(3, 0), wurst=3)
