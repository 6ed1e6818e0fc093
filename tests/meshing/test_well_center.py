"""The remesher called as a function, as other programs do: no filter, no pipeline."""

import inspect
import subprocess
import sys
from dataclasses import fields

import numpy as np
import pytest
from support.builders import ball, jittered_cube, sphere_surface

from filters.meshing_well_centered import MeshingOptions
from wct_plugin import apply_filter
from wct_plugin.errors import OptionError
from wct_plugin.measure import quality
from wct_plugin.meshing.well_center import well_center
from wct_plugin.meshing.well_center_options import WellCenterOptions


def test_it_does_what_the_filter_does_to_the_bit():
    mesh = jittered_cube(3)
    better, metrics = well_center(mesh, WellCenterOptions(goal="3wc", seed=1))
    same, said = apply_filter("meshing_well_centered", mesh, goal="3wc", seed=1)
    assert quality.measure(better).well_centered_3.all()
    assert better.points.tobytes() == same.points.tobytes()
    assert np.array_equal(better.tets, same.tets)
    assert metrics["bad"] == said["bad"] == 0


def test_it_takes_a_reference_and_tells_how_it_goes_on():
    sphere, heard = sphere_surface(400), []
    better, metrics = well_center(ball(4), reference=sphere, progress=heard.append)
    assert metrics["bad"] == 0
    assert better.reference is sphere
    assert heard[-1].stage == "measuring"


def test_options_that_do_not_fit_the_mesh_are_refused():
    with pytest.raises(OptionError, match="names 'oxide', which is no group of facets"):
        well_center(jittered_cube(2), WellCenterOptions(boundary={"oxide": "fixed"}))


def test_its_options_are_those_of_the_filter_with_the_same_defaults():
    ours = {one.name: one.default for one in fields(WellCenterOptions)}
    theirs = {name: one.default for name, one in MeshingOptions.model_fields.items() if name in ours}
    assert ours == theirs
    assert set(MeshingOptions.model_fields) - set(ours) <= {"reference", "inputs", "tag", "type"}


def test_neither_filters_nor_pipelines_are_imported():
    code = (
        "import sys; from wct_plugin.meshing.well_center import well_center;"
        " assert not [m for m in sys.modules if m.startswith(('wct_plugin.filters', 'wct_plugin.pipeline'))]"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
    assert "progress" in inspect.signature(well_center).parameters
