"""``trimesh.Trimesh`` and ``pymeshlab.MeshSet``: surfaces there and back, with colours, quality and attributes."""

import numpy as np
import pymeshlab
import pytest
import trimesh
from support.builders import sphere_surface
from support.comparing import assert_same

import wct_plugin as wct
from wct_plugin.errors import InputError, WctWarning
from wct_plugin.mesh import SurfaceMesh


def coloured(on_points: bool) -> SurfaceMesh:
    ball = sphere_surface(30)
    count = len(ball.points if on_points else ball.triangles)
    random = np.random.default_rng(2)
    colours = {name: random.integers(0, 256, count).astype(np.uint8) for name in ("red", "green", "blue", "alpha")}
    data = {**colours, "quality": random.normal(size=count)}
    return SurfaceMesh(ball.points, ball.triangles, None, **{"point_data" if on_points else "cell_data": data})


@pytest.mark.parametrize("on_points", [True, False])
def test_trimesh_there_and_back(on_points):
    mesh = coloured(on_points)
    made = wct.to_trimesh(mesh)
    assert made.visual.kind == ("vertex" if on_points else "face")
    assert made.volume == pytest.approx(np.linalg.det(mesh.points[mesh.triangles]).sum() / 6, rel=1e-12)
    assert_same(wct.as_mesh(made), mesh)


def test_trimesh_keeps_tags_and_attributes(surface):
    made = wct.to_trimesh(surface)
    assert made.face_attributes["gmsh:physical"].tolist() == surface.tags.tolist()
    assert_same(wct.as_mesh(made), surface)


def test_trimesh_with_colours_on_both(surface):
    both = SurfaceMesh(
        surface.points,
        surface.triangles,
        None,
        coloured_like(len(surface.points)),
        coloured_like(len(surface.triangles)),
    )
    assert_same(wct.as_mesh(wct.to_trimesh(both)), both)


def coloured_like(count):
    return {name: np.arange(count).astype(np.uint8) for name in ("red", "green", "blue", "alpha")}


def test_what_of_a_trimesh_is_not_taken_is_named():
    box = trimesh.creation.box()
    box.face_attributes["words"] = np.array(["a"] * 5)  # one too few
    box.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)))
    with pytest.warns(WctWarning, match=r"trimesh.Trimesh: not read: face attribute 'words', texture"):
        assert len(wct.as_mesh(box).triangles) == 12


@pytest.mark.parametrize("on_points", [True, False])
def test_pymeshlab_there_and_back(on_points):
    mesh = coloured(on_points)
    made = wct.to_pymeshlab(mesh)
    assert isinstance(made, pymeshlab.MeshSet)
    assert made.mesh_number() == 1
    assert made.get_geometric_measures()["mesh_volume"] == pytest.approx(
        np.linalg.det(mesh.points[mesh.triangles]).sum() / 6, rel=1e-6
    )
    assert_same(wct.as_mesh(made), mesh)


def test_pymeshlab_the_current_mesh_where_its_matrix_puts_it():
    made = wct.to_pymeshlab(sphere_surface(30))
    made.create_cube()
    made.compute_matrix_from_translation(axisx=10.0, freeze=False)
    cube = wct.as_mesh(made)
    assert len(cube.triangles) == 12
    assert cube.points[:, 0].min() > 5.0


def test_pymeshlab_names_what_it_cannot_carry(surface):
    with pytest.warns(
        WctWarning, match="pymeshlab.MeshSet cannot carry, so dropped: tags, .*'flag', triangle data 'id'"
    ):
        wct.to_pymeshlab(surface)


def test_pymeshlab_without_a_surface():
    with pytest.raises(InputError, match=r"pymeshlab.MeshSet: has no mesh"):
        wct.as_mesh(pymeshlab.MeshSet())
    cloud = pymeshlab.MeshSet()
    cloud.add_mesh(pymeshlab.Mesh(np.eye(3)))
    with pytest.raises(InputError, match="its current mesh has 3 points and no triangle"):
        wct.as_mesh(cloud)


def test_a_filter_runs_on_either():
    ball = sphere_surface(60)
    for given in (wct.to_trimesh(ball), wct.to_pymeshlab(ball)):
        mesh, _ = wct.apply_filter("generate_tetrahedralization", given, mesher="tetgen")
        assert mesh.diagonal == pytest.approx(ball.diagonal, rel=1e-12)
