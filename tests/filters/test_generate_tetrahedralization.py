"""A surface becomes tets, and travels on as what the boundary is measured against."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import sphere_surface, two_region_cube

import wct_plugin as wct
from wct_plugin.adapters import ftetwild, tetgen
from wct_plugin.errors import InputError, OptionError, WctWarning
from wct_plugin.mesh import SurfaceMesh
from wct_plugin.pipeline.stage import find_filter


def test_the_surface_travels_on_as_the_reference():
    surface = sphere_surface(200)
    surface = replace(surface, tags=np.full(len(surface.triangles), 7))  # one tag for all says nothing: no warning
    mesh, metrics = wct.apply_filter("generate_tetrahedralization", surface, edge_length=0.2)
    assert mesh.reference is surface
    assert metrics == {"mesher": f"fTetWild {ftetwild.version()}", "tets": len(mesh.tets), "points": len(mesh.points)}
    assert mesh.repairs.flipped == 0
    _, report = wct.apply_filter("get_quality", mesh)
    assert report["deviation"]["fraction_of_diagonal"] < 1e-2

    better, _ = wct.apply_filter("apply_coord_well_centering", mesh)
    assert better.reference is surface


def test_options_out_of_range():
    with pytest.raises(OptionError, match="option 'epsilon' is 0; input should be greater than 0"):
        wct.apply_filter("generate_tetrahedralization", sphere_surface(50), epsilon=0)


def two_rooms() -> SurfaceMesh:
    """The unit cube with a wall at z = 1/2; the floor is tagged -7, the wall 9."""
    solid = two_region_cube(2)
    triangles = np.vstack([solid.topology.boundary, solid.topology.interfaces])
    heights = solid.points[triangles][..., 2]
    floor, wall = (heights == 0).all(axis=1), (heights == 0.5).all(axis=1)
    return SurfaceMesh(solid.points, triangles, np.where(floor, -7, np.where(wall, 9, 0)))


def volumes(mesh) -> dict[int, float]:
    size = np.linalg.det(mesh.points[mesh.tets[:, 1:]] - mesh.points[mesh.tets[:, :1]]) / 6
    return {int(region): float(size[mesh.regions == region].sum()) for region in np.unique(mesh.regions)}


def heights(mesh, tag) -> np.ndarray:
    return mesh.points[mesh.facets.vertices[mesh.facets.tags == tag]][..., 2]


@pytest.mark.filterwarnings("ignore:the boundary is resampled on the mesh's own facets")
def test_tetgen_s_regions_and_tags_survive_the_optimizer():
    mesh, metrics = wct.apply_filter("generate_tetrahedralization", two_rooms(), mesher="tetgen", edge_length=0.5)
    assert metrics == {"mesher": f"TetGen {tetgen.version()}", "tets": len(mesh.tets), "points": len(mesh.points)}
    better, _ = wct.apply_filter("meshing_well_centered", mesh)
    _, report = wct.apply_filter("get_quality", better)
    assert report["3wc"]["count"] == report["tets"]
    assert report["deviation"]["fraction_of_diagonal"] < 1e-9
    for one in (mesh, better):
        assert volumes(one) == pytest.approx({1: 0.5, 2: 0.5})
        assert len(heights(one, -7)) >= 2
        assert np.abs(heights(one, -7)).max() < 1e-12
        assert np.abs(heights(one, 9) - 0.5).max() < 1e-12


def test_ftetwild_names_the_tags_it_drops():
    ball = sphere_surface(50)
    options = {"edge_length": 0.4, "epsilon": 0.02, "num_opt_iter": 1}
    sides = replace(ball, tags=(ball.points[ball.triangles].mean(axis=1)[:, 2] > 0) + 4, source="ball.stl")
    with pytest.warns(WctWarning) as told:
        mesh, _ = wct.apply_filter("generate_tetrahedralization", sides, **options)
    assert [str(each.message) for each in told] == [
        "ball.stl: fTetWild drops the tags of the surface's triangles (2 different ones); mesher 'tetgen' keeps them"
    ]
    assert not len(mesh.facets)


def test_options_out_of_range_or_of_the_other_mesher():
    for given, message in (
        ({"mesher": "tetgen", "epsilon": 5e-4}, "option 'epsilon' is for mesher 'ftetwild', not for 'tetgen'"),
        ({"keep_boundary": True}, "option 'keep_boundary' is for mesher 'tetgen', not for 'ftetwild'"),
        ({"num_opt_iter": 0}, "option 'num_opt_iter' is 0; input should be greater than or equal to 1"),
        ({"mesher": "gmsh"}, "option 'mesher' is 'gmsh'; input should be 'ftetwild' or 'tetgen'"),
    ):
        with pytest.raises(OptionError) as caught:
            find_filter("generate_tetrahedralization")(**given)
        assert str(caught.value) == f"filters.generate_tetrahedralization: {message}"


@pytest.mark.parametrize("given", [{}, {"mesher": "tetgen", "min_dihedral": 5.0}])
def test_options_written_out_can_be_given_again(given):
    mesher = find_filter("generate_tetrahedralization")
    written = mesher(**given).options.model_dump()
    assert written.items() >= given.items()
    assert ("epsilon" in written) == ("radius_edge" not in written) == (not given)
    assert mesher(**written).options.model_dump() == written


def test_tetgen_is_not_asked_to_fill_an_open_surface():
    ball = sphere_surface(50)
    with pytest.raises(InputError, match="it is open: the edge from"):
        wct.apply_filter("generate_tetrahedralization", SurfaceMesh(ball.points, ball.triangles[1:]), mesher="tetgen")
