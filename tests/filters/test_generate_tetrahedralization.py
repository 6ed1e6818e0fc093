"""A surface becomes tets, and travels on as what the boundary is measured against."""

import pytest
from builders import sphere_surface

import wct_plugin as wct
from wct_plugin.errors import OptionError


def test_the_surface_travels_on_as_the_reference():
    surface = sphere_surface(200)
    mesh, metrics = wct.apply_filter("generate_tetrahedralization", surface, edge_length=0.2)
    assert mesh.reference is surface
    assert metrics == {"tets": len(mesh.tets), "points": len(mesh.points)}
    assert mesh.repairs.flipped == 0
    _, report = wct.apply_filter("get_quality", mesh)
    assert report["deviation"]["fraction_of_diagonal"] < 1e-2

    better, _ = wct.apply_filter("apply_coord_well_centering", mesh)
    assert better.reference is surface


def test_options_out_of_range():
    with pytest.raises(OptionError, match="option 'epsilon' is 0; input should be greater than 0"):
        wct.apply_filter("generate_tetrahedralization", sphere_surface(50), epsilon=0)
