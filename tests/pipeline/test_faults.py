"""A fault of a filter is told as one, and never blamed on the mesh that it was given."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import jittered_cube, two_region_cube
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.core import _core
from wct_plugin.mesh import Cells, TetMesh

CUBE = jittered_cube(2)


def with_mesh(found, **changes):
    return replace(found, mesh=replace(found.mesh, **changes))


def with_a_facet_of_no_point(found):
    """The core's result as if it had lost a corner of each facet."""
    facets = found.mesh.facets.copy()
    facets[:, 2] = -1
    return with_mesh(found, facets=facets)


def with_points_too_few(found):
    """The core's result as if a point were missing."""
    return with_mesh(found, points=found.mesh.points[:-1])


def with_a_tet_inside_out(found):
    """The core's result as if a flip had gone wrong."""
    tets = found.mesh.tets.copy()
    tets[0] = tets[0][[1, 0, 2, 3]]
    return with_mesh(found, tets=tets)


def with_a_point_left_over(found):
    """The core's result as if a point had lost its last tet."""
    sizes = {"stratum": np.int8(0), "label": -1, "size": 1.0}
    more = {name: np.append(getattr(found.mesh, name), value) for name, value in sizes.items()}
    return with_mesh(found, points=np.vstack([found.mesh.points, [[0.5, 0.5, 0.5]]]), **more)


def with_a_patch_too_many(found):
    """The core's result as if it had made a patch up."""
    return with_mesh(found, facet_patch=found.mesh.facet_patch + 10_000)


@pytest.fixture
def sheet():
    """A cube with a tagged sheet, whose facets are carried."""
    mesh = two_region_cube(2)
    return TetMesh(mesh.points, mesh.tets, facets=Cells(mesh.topology.boundary[:4], np.ones(4, dtype=np.int64)))


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (
            with_a_facet_of_no_point,
            r"^the filter made no mesh: triangle \d+ is \(.*-1.*\).*; indices must lie in 0\.\.",
        ),
        (with_points_too_few, r"^the filter made no mesh: tet \d+ is .*; indices must lie in 0\.\."),
        (with_a_tet_inside_out, "^the filter made no mesh: 1 tets are negatively oriented; none may be"),
        (with_a_point_left_over, "^the filter made no mesh: 1 points are in no tet; none may be"),
        (with_a_patch_too_many, "^IndexError: "),
    ],
)
def test_a_core_result_that_is_no_mesh_is_an_internal_error(monkeypatch, tmp_path, capsys, sheet, spoil, said):
    search = _core.search_well_centered
    monkeypatch.setattr(_core, "search_well_centered", lambda *given: spoil(search(*given)))
    with pytest.raises(wct.InternalError, match=said):
        wct.apply_filter("meshing_well_centered", sheet, goal="3wc", boundary="fixed")
    wct.write(tmp_path / "in.vtu", sheet)
    line = refused(
        capsys, "optimize", tmp_path / "in.vtu", tmp_path / "out.vtu", "--goal", "3wc", "--boundary", "fixed"
    )
    assert line.startswith("internal error in stage 2 of 3 (filters.meshing_well_centered), please report it: ")
    assert not (tmp_path / "out.vtu").exists()


def test_arrays_of_ours_that_the_core_refuses_are_an_internal_error(monkeypatch):
    move = _core.move_vertices
    turned = CUBE.tets[:, [1, 0, 2, 3]]
    monkeypatch.setattr(
        _core, "move_vertices", lambda points, tets, *rest, **given: move(points, turned, *rest, **given)
    )
    with pytest.raises(wct.InternalError, match=r"^ValueError: tet 0 is inverted or flat"):
        wct.apply_filter("apply_coord_well_centering", CUBE)


def test_a_mesh_given_with_three_tets_at_a_facet_is_an_input_error():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.2, 0.2, 2.0], [0, 0, -1.0]])
    mesh = TetMesh(points, [[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]])
    with pytest.raises(wct.InputError, match="facet"):
        wct.apply_filter("meshing_well_centered", mesh)


@pytest.mark.parametrize("raised", [ValueError, wct.WctError, wct.WctWarning])
@pytest.mark.parametrize("name", ["meshing_well_centered", "apply_coord_well_centering"])
def test_what_the_progress_callback_raises_comes_through(name, raised):
    def fail(_):
        raise raised("of the caller")

    with pytest.raises(raised, match=r"^of the caller$"):
        wct.apply_filter(name, CUBE, progress=fail)


def test_a_reference_of_flat_triangles_is_an_input_error():
    line = wct.SurfaceMesh(np.array([[0.0, 0, 0], [0.5, 0, 0], [1, 0, 0]]), np.array([[0, 1, 2]]))
    with pytest.raises(wct.InputError, match="all triangles have zero area"):
        wct.apply_filter("meshing_well_centered", CUBE, reference=line)
