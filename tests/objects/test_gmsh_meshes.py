"""The current model of gmsh, as it is in memory: groups, names, cells in several groups, periodic sides; and back."""

import gmsh
import numpy as np
import pytest
from support.builders import two_region_cube
from support.comparing import assert_same

import wct_plugin as wct
from wct_plugin.errors import InputError, ObjectError, WctWarning
from wct_plugin.measure import quality
from wct_plugin.mesh import TetMesh


@pytest.fixture(autouse=True)
def session():
    """Gmsh, initialized and quiet."""
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    yield
    if gmsh.isInitialized():
        gmsh.finalize()


def bar(groups=True):
    """Two unit cubes that share a face; the left one is in two groups."""
    gmsh.model.add("bar")
    cubes = [(3, gmsh.model.occ.addBox(x, 0, 0, 1, 1, 1)) for x in (0, 1)]
    gmsh.model.occ.fragment(cubes[:1], cubes[1:])
    gmsh.model.occ.synchronize()
    if groups:
        left, right = (tag for _, tag in gmsh.model.getEntities(3))
        gmsh.model.addPhysicalGroup(3, [left], 5, name="steel")
        gmsh.model.addPhysicalGroup(3, [right], 6, name="copper")
        gmsh.model.addPhysicalGroup(3, [left, right], 9, name="all metal")
        ends = gmsh.model.getEntitiesInBoundingBox(-0.1, -0.1, -0.1, 0.1, 1.1, 1.1, 2)
        gmsh.model.addPhysicalGroup(2, [tag for _, tag in ends], 5, name="hot")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    gmsh.model.mesh.generate(3)


def volumes(mesh: TetMesh) -> dict[int, float]:
    each = quality.volumes(mesh.points, mesh.tets)
    return {int(tag): float(each[mesh.regions == tag].sum()) for tag in np.unique(mesh.regions)}


def of_gmsh() -> dict[str, float]:
    """Volume or area of every group, from gmsh's own elements."""
    found = {}
    for dimension, group in gmsh.model.getPhysicalGroups():
        total = 0.0
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, group):
            _, tags, _ = gmsh.model.mesh.getElements(dimension, entity)
            total += sum(gmsh.model.mesh.getElementQualities(of, "volume").sum() for of in tags if len(of))
        found[gmsh.model.getPhysicalName(dimension, group) or str(group)] = total
    return found


@pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")
def test_mid_nodes_come_again():
    bar()
    gmsh.model.mesh.setOrder(2)
    before = of_gmsh()
    wct.to_gmsh(wct.as_mesh(gmsh), "again")
    assert gmsh.model.mesh.getElementTypes(3).tolist() == [11]  # tets of ten nodes
    assert of_gmsh() == pytest.approx(before, rel=1e-12)
    assert (
        np.isclose(gmsh.model.mesh.getElementQualities(gmsh.model.mesh.getElements(3)[1][0], "minDetJac"), 0).sum() == 0
    )


def test_groups_names_and_sets():
    bar()
    mesh = wct.from_gmsh()
    assert volumes(mesh) == {5: pytest.approx(1.0, rel=1e-12), 6: pytest.approx(1.0, rel=1e-12)}
    assert dict(mesh.names) == {"steel": (5, 3), "copper": (6, 3), "all metal": (9, 3), "hot": (5, 2)}
    assert len(mesh.tet_sets["all metal"]) == len(mesh.tets)
    assert (mesh.points[mesh.facets.vertices][..., 0] == 0).all()
    assert set(mesh.facets.tags.tolist()) == {5}
    assert (len(mesh.edges), len(mesh.nodes)) == (0, 0)


def test_the_same_as_its_file(tmp_path):
    bar()
    gmsh.write(str(tmp_path / "bar.msh"))
    read, taken = wct.read(tmp_path / "bar.msh"), wct.as_mesh(gmsh)
    assert volumes(read) == pytest.approx(volumes(taken), rel=1e-12)
    assert dict(read.names) == dict(taken.names)
    assert {name: len(ids) for name, ids in read.tet_sets.items()} == {n: len(i) for n, i in taken.tet_sets.items()}
    assert np.array_equal(np.sort(read.facets.tags), np.sort(taken.facets.tags))


def test_without_groups_entities_are_the_regions():
    bar(groups=False)
    mesh = wct.from_gmsh()
    assert sorted(volumes(mesh).values()) == pytest.approx([1.0, 1.0], rel=1e-12)
    assert mesh.tag_name == "gmsh:geometrical"
    assert len(mesh.facets) > 0


def test_tets_of_a_model_with_groups_of_surfaces_only():
    """gmsh's own files would have no tet."""
    bar(groups=False)
    gmsh.model.addPhysicalGroup(2, [1], 3)
    mesh = wct.from_gmsh()
    assert sum(volumes(mesh).values()) == pytest.approx(2.0, rel=1e-12)
    assert set(mesh.facets.tags.tolist()) == {3}


def test_there_and_back():
    bar()
    mesh = wct.from_gmsh()
    before = of_gmsh()
    name = wct.to_gmsh(mesh, "again")
    assert name == "again" == gmsh.model.getCurrent()
    assert of_gmsh() == pytest.approx(before, rel=1e-12)
    assert before["all metal"] == pytest.approx(2.0)
    again = wct.from_gmsh()
    assert volumes(again) == pytest.approx(volumes(mesh), rel=1e-12)
    assert dict(again.names) == dict(mesh.names)
    assert set(again.tet_sets) == {"all metal"}
    assert wct.to_gmsh(mesh, "again") == "again 2"
    assert set(gmsh.model.list()) >= {"bar", "again", "again 2"}


def test_optimized_in_a_new_model():
    bar()
    name = wct.optimize(gmsh, goal="3wc", seed=1)
    assert name == gmsh.model.getCurrent()
    assert gmsh.model.list()[-2:] == ["bar", name]
    assert of_gmsh() == pytest.approx({"steel": 1.0, "copper": 1.0, "all metal": 2.0, "hot": 1.0}, rel=1e-12)
    assert wct.report(gmsh).flags["3wc"] == len(wct.from_gmsh().tets)
    gmsh.model.setCurrent("bar")
    assert len(wct.from_gmsh().tets) > 0  # what was there is as it was


def test_data_become_views(full: TetMesh):
    with pytest.warns(WctWarning, match="gmsh's model cannot carry, so dropped: .*'uv'"):
        wct.to_gmsh(full)
    assert gmsh.view.getTags().size > 0
    again = wct.from_gmsh()
    assert volumes(again) == pytest.approx(volumes(full), rel=1e-12)
    assert dict(again.names) == dict(full.names)
    assert len(again.facets) == len(full.facets)


def test_a_surface():
    gmsh.model.occ.addSphere(0, 0, 0, 1)
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    gmsh.model.mesh.generate(2)
    with pytest.warns(WctWarning, match=r"gmsh's model: not read: \d+ line cells"):
        surface = wct.from_gmsh()
    assert isinstance(surface, wct.SurfaceMesh)
    wct.to_gmsh(surface)
    assert_same(wct.as_mesh(gmsh), surface, without="tags")


def test_periodic_sides():
    box = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    left, right = (gmsh.model.getEntitiesInBoundingBox(x - 0.1, -0.1, -0.1, x + 0.1, 1.1, 1.1, 2)[0][1] for x in (0, 1))
    gmsh.model.mesh.setPeriodic(2, [right], [left], [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    gmsh.model.addPhysicalGroup(3, [box])
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    gmsh.model.mesh.generate(3)
    assert wct.from_gmsh().periodic


def test_nodes_numbered_with_gaps():
    mesh = two_region_cube(2)
    wct.to_gmsh(mesh)
    tags, _, _ = gmsh.model.mesh.getNodes()
    gmsh.model.mesh.renumberNodes(tags, tags * 7 + 3)
    assert volumes(wct.from_gmsh()) == pytest.approx({1: 0.5, 2: 0.5}, rel=1e-12)


def test_what_has_no_mesh_is_told_so():
    gmsh.model.add("empty")
    with pytest.raises(InputError, match=r"gmsh's model 'empty' has no mesh; gmsh.model.mesh.generate\(3\)"):
        wct.from_gmsh()
    gmsh.finalize()
    for call in (wct.from_gmsh, lambda: wct.as_mesh(gmsh), lambda: wct.to_gmsh(two_region_cube(2))):
        with pytest.raises(ObjectError, match=r"gmsh has no current model; gmsh.initialize"):
            call()


def test_other_cells_are_refused_by_name():
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    for _, curve in gmsh.model.getEntities(1):
        gmsh.model.mesh.setTransfiniteCurve(curve, 3)
    for dimension, entity in [*gmsh.model.getEntities(2), *gmsh.model.getEntities(3)]:
        (gmsh.model.mesh.setTransfiniteSurface if dimension == 2 else gmsh.model.mesh.setTransfiniteVolume)(entity)
        gmsh.model.mesh.setRecombine(dimension, entity)
    gmsh.model.mesh.generate(3)
    with pytest.raises(InputError, match=r"gmsh's model: .*(quad|hexahedron)"):
        wct.from_gmsh()
