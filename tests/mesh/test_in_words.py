"""``repr`` in one short line: a notebook shows the last value of a cell, and a mesh has many numbers."""

import pytest
from support.full_mesh import full_mesh, full_surface, plain_mesh

import wct_plugin as wct
from wct_plugin.mesh.in_words import in_words


def things():
    mesh = full_mesh(plain_mesh())
    chain = wct.Reader(mesh) | wct.Filter.get_quality(worst=3, tag="measured")
    result = chain.execute()
    stage = result["measured"]
    return [
        *(mesh, full_surface(plain_mesh()), mesh.facets, mesh.edges, mesh.nodes, mesh.others, mesh.second_order),
        *(chain, *chain.steps, *(step.stage for step in chain.steps), result, stage, stage.flow, wct.report(mesh)),
        *(wct.Filter, wct.Reader, wct.Writer),
    ]


@pytest.mark.parametrize("number", range(len(things())))
def test_it_is_short_and_has_no_arrays(number):
    shown = repr(things()[number])
    assert len(shown) < 500
    assert "\n" not in shown
    assert "array(" not in shown
    assert " object at 0x" not in shown


def test_a_mesh_says_what_is_in_it():
    cube, _ = wct.apply_filter("create_cube", variant="84")
    assert repr(cube) == (
        f"<TetMesh: {len(cube.points)} points, 84 tets, 1 region, {len(cube.facets)} tagged facets;"
        " names: x_min, x_max, y_min, y_max and 2 more>"
    )
    surface = cube.boundary_surface()
    assert repr(surface) == f"<SurfaceMesh: {len(surface.points)} points, {len(surface.triangles)} triangles>"
    assert repr(cube.facets) == f"<Cells: {len(cube.facets)} triangles>"
    assert repr(cube.edges) == "<Cells: empty>"


def test_a_stage_says_its_options():
    assert repr(wct.Filter.get_quality(worst=3).steps[0].stage) == "<filters.get_quality worst=3>"


def test_of_many_names_the_first_are_shown():
    assert (
        in_words(1, "a.msh", {"points": 1, "tets": 0}, {"sets": "abcdef"})
        == "<int a.msh: 1 point; sets: a, b, c, d and 2 more>"
    )
