"""Whatever holds a mesh goes in, by its type's name alone, and comes back; what does not is told what does."""

import subprocess
import sys
import warnings

import gmsh
import meshio
import numpy as np
import pymeshlab
import pytest
import pytetwild
import pyvista as pv
import skfem
import tetgen
import trimesh
import vtk
from support.builders import bcc, kuhn_cube, sphere_surface, two_region_cube
from support.comparing import assert_same

import wct_plugin as wct
from wct_plugin.errors import InputError, ObjectError, OptionError, WctError, WctWarning
from wct_plugin.measure import quality
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.objects.conversions import LIBRARIES, TARGETS, converted


@pytest.fixture
def model():
    """Gmsh, initialized and quiet."""
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    yield gmsh
    gmsh.finalize()


CUBE = kuhn_cube(2)
BALL = sphere_surface(60)


@pytest.mark.parametrize(
    "obj",
    [
        (CUBE.points, CUBE.tets),
        [CUBE.points, CUBE.tets],
        (CUBE.points.tolist(), CUBE.tets.tolist()),
        (CUBE.points, CUBE.tets, None),
        (CUBE.points, CUBE.tets, np.zeros((len(CUBE.tets), 1))),
        (CUBE.points, CUBE.tets, np.empty((0, 0))),
        meshio.Mesh(CUBE.points, [("tetra", CUBE.tets)]),
        wct.to_pyvista(CUBE),
        skfem.MeshTet(CUBE.points.T, CUBE.tets.T.astype(np.int32)),
    ],
    ids=lambda obj: type(obj).__name__,
)
def test_tets_of_all_kinds(obj):
    mesh = wct.as_mesh(obj)
    assert_same(mesh, CUBE)
    assert wct.apply_filter("get_quality", obj)[1] == wct.apply_filter("get_quality", CUBE)[1]
    assert wct.Filter.get_quality().apply(obj).mesh.points.tolist() == CUBE.points.tolist()
    assert len((wct.Reader(obj) | wct.Filter.get_quality()).execute().mesh.tets) == len(CUBE.tets)
    assert wct.report(obj).to_dict() == wct.report(CUBE).to_dict()


@pytest.mark.parametrize(
    "obj",
    [
        (BALL.points, BALL.triangles),
        (BALL.points, BALL.triangles, np.zeros(len(BALL.triangles), dtype=int)),
        meshio.Mesh(BALL.points, [("triangle", BALL.triangles)]),
        pv.PolyData.from_regular_faces(BALL.points, BALL.triangles),
        trimesh.Trimesh(BALL.points, BALL.triangles, process=False),
        pymeshlab.Mesh(BALL.points, BALL.triangles.astype(np.int32)),
    ],
    ids=lambda obj: type(obj).__name__,
)
def test_surfaces_of_all_kinds(obj):
    assert_same(wct.as_mesh(obj), BALL)


def test_vtk_grids_and_subclasses_go_in():
    grid = vtk.vtkUnstructuredGrid()
    grid.DeepCopy(wct.to_pyvista(CUBE))
    assert_same(wct.as_mesh(grid), CUBE)
    surface = vtk.vtkPolyData()
    surface.DeepCopy(wct.to_pyvista(BALL))
    assert_same(wct.as_mesh(surface), BALL)

    class Mine(meshio.Mesh):
        pass

    assert_same(wct.as_mesh(Mine(CUBE.points, [("tetra", CUBE.tets)])), CUBE)


def test_a_file_and_a_mesh_of_ours_go_in(tmp_path):
    wct.write(tmp_path / "cube.vtu", CUBE)
    assert_same(wct.as_mesh(tmp_path / "cube.vtu"), CUBE)
    assert wct.report(str(tmp_path / "cube.vtu")).tets == len(CUBE.tets)
    assert wct.as_mesh(CUBE) is CUBE


class Unknown:
    """Of nobody."""


UNKNOWN = [Unknown(), {"points": CUBE.points}, CUBE.points, (CUBE.points,), ("a.vtu", "b.vtu"), 3, trimesh.Scene(), sys]


@pytest.mark.parametrize("obj", UNKNOWN, ids=lambda obj: type(obj).__name__)
def test_unknown_objects_are_told_what_goes(obj):
    for call in (wct.as_mesh, wct.report, wct.optimize, lambda one: wct.apply_filter("get_quality", one)):
        with pytest.raises(ObjectError) as raised:
            call(obj)
        line = str(raised.value)
        assert "\n" not in line
        for one in LIBRARIES:
            assert one.called in line
    assert isinstance(raised.value, WctError)
    assert isinstance(raised.value, TypeError)
    with pytest.raises(WctError):
        wct.Reader(obj)
    with pytest.raises(WctError):
        wct.Filter.get_quality().apply(obj)


def test_what_it_is_told_names_the_object():
    cases = [
        (None, "None"),
        (3, "an int"),
        ({}, "a dict"),
        (("a", "b"), "a tuple of 2"),
        (sys, "the module sys"),
        (skfem.MeshTet, r"the class skfem\.MeshTet1"),
    ]
    for obj, name in cases:
        with pytest.raises(ObjectError, match=rf"^cannot make a mesh of {name}; allowed are the name of a mesh file; "):
            wct.as_mesh(obj)


def test_what_makes_a_mesh_of_it_is_named_and_does():
    """Each conversion that a message names, carried out."""
    left = wct.to_pyvista(CUBE).extract_cells(range(24))
    right = wct.to_pyvista(CUBE).extract_cells(range(24, 48))
    blocks = pv.MultiBlock([left, right])
    ball = trimesh.creation.icosphere(1)
    cases = [
        (skfem.MeshHex(), r"skfem\.MeshHex1; its to_meshtet\(\)", lambda one: one.to_meshtet()),
        (blocks, r"pyvista\.MultiBlock; its combine\(merge_points=True\)", lambda one: one.combine(merge_points=True)),
        (trimesh.Scene(ball), r"trimesh\.Scene; its to_mesh\(\)", lambda one: one.to_mesh()),
        (CUBE.points, r"numpy\.ndarray; points alone .* \(points, tets\)", lambda points: (points, CUBE.tets)),
        (vtk.vtkMultiBlockDataSet(), r"pyvista\.wrap\(it\)\.combine", lambda _: blocks.combine(merge_points=True)),
    ]
    for obj, line, conversion in cases:
        with pytest.raises(ObjectError, match=line):
            wct.as_mesh(obj)
        assert len(wct.as_mesh(conversion(obj)).points) > 0
    whole = wct.as_mesh(blocks.combine(merge_points=True))
    assert quality.volumes(whole.points, whole.tets).sum() == pytest.approx(1.0, rel=1e-12)
    assert len(whole.topology.boundary) == len(CUBE.topology.boundary)


def test_another_library_s_mesh_is_not_written():
    with pytest.raises(ObjectError, match=r"part\.vtu: is given a Mesh; wct_plugin\.as_mesh"):
        wct.write("part.vtu", meshio.Mesh(CUBE.points, [("tetra", CUBE.tets)]))


@pytest.mark.parametrize(
    ("obj", "message"),
    [
        ((CUBE.points, CUBE.tets[:, :2]), r"the cells have shape \(48, 2\); allowed is \(m, 4\)"),
        ((CUBE.points, None), r"the cells have shape None"),
        ((CUBE.points, [[0, 1, 2, 3], [1]]), "one of the arrays is none"),
        ((CUBE.points[:, :2], CUBE.tets), r"points have shape \(27, 2\)"),
        ((CUBE.points, CUBE.tets, np.full(48, 0.5)), "the region of cell 0 is 0.5; allowed are whole numbers"),
        ((CUBE.points, CUBE.tets, np.zeros(7, dtype=int)), r"tet tags have shape \(7,\); allowed is \(48,\)"),
        (meshio.Mesh(CUBE.points, [("line", [[0, 1]])]), r"meshio.Mesh: has neither tets nor triangles"),
        (pv.PolyData(), "PolyData: has no cells"),
        (pv.UnstructuredGrid(), "UnstructuredGrid: has no cells"),
        ("", "the name of the mesh file is empty"),
        (skfem.MeshTet().with_subdomains({}), None),
    ],
)
def test_what_makes_no_mesh(obj, message):
    if message is None:
        assert len(wct.as_mesh(obj).tets) == 5
        return
    with pytest.raises(InputError, match=message):
        wct.as_mesh(obj)


def test_regions_are_asked_for_by_name():
    for wrong, name in ((3, "an int"), (np.zeros(48, dtype=int), r"a numpy\.ndarray"), ([1, 2], "a list of 2")):
        for source in ((CUBE.points, CUBE.tets), "part.vtu"):
            with pytest.raises(OptionError, match=rf"^regions is {name}; allowed are the name of an array"):
                wct.as_mesh(source, regions=wrong)


def test_regions_may_be_truth_values():
    assert wct.as_mesh((CUBE.points, CUBE.tets, np.arange(48) < 20)).regions.tolist() == [1] * 20 + [0] * 28


def test_a_report_refuses_a_number_of_tets_that_is_none():
    for wrong in (-1, "many"):
        with pytest.raises(OptionError, match="option 'worst' is"):
            wct.report(CUBE, worst=wrong)


def test_field_data_is_named():
    """It is of the whole dataset, and no mesh of ours has a place for it."""
    grid = wct.to_pyvista(two_region_cube(2))
    grid.field_data["TimeValue"] = [3.5]
    with pytest.warns(WctWarning, match=r"^UnstructuredGrid: not read: field data 'TimeValue'$"):
        wct.as_mesh(grid)
    mesh = meshio.Mesh(CUBE.points, {"tetra": CUBE.tets}, field_data={"a": np.array([1, 3]), "b": np.arange(3)})
    with pytest.warns(WctWarning, match=r"^meshio.Mesh: not read: field data 'b'$"):
        assert dict(wct.as_mesh(mesh).names) == {"a": (1, 3)}


def test_no_library_is_imported_to_choose(tmp_path):
    code = (
        "import sys, numpy as np, wct_plugin as wct\n"
        "points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])\n"
        "wct.as_mesh((points, [[0, 1, 2, 3]]))\n"
        "try:\n    wct.as_mesh(object())\nexcept wct.ObjectError:\n    pass\n"
        "found = ('meshio', 'pyvista', 'vtk', 'skfem', 'gmsh', 'pymeshlab', 'trimesh', 'pydantic', 'scipy')\n"
        "print([name for name in found if name in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


@pytest.mark.parametrize("kind", ["arrays", "meshio", "pyvista", "skfem", "gmsh"])
def test_optimize_gives_back_what_came(kind, model):
    """Two materials: their volumes stay, whatever holds them."""
    whole = two_region_cube(2)
    given = converted(whole, kind)
    given = model if kind == "gmsh" else given
    made = wct.optimize(given, goal="3wc", seed=1)
    if kind == "gmsh":
        assert made == model.model.getCurrent()
        made = model
    assert type(made) is type(given)
    better = wct.as_mesh(made)
    volumes = quality.volumes(better.points, better.tets)
    regions = np.unique(better.regions)
    assert len(regions) == 2
    for tag in regions:
        assert volumes[better.regions == tag].sum() == pytest.approx(0.5, rel=1e-12)
    assert wct.report(made).flags["3wc"] == len(better.tets)


def test_optimize_gives_as_many_arrays_as_came():
    mesh = bcc(2)
    assert len(wct.optimize((mesh.points, mesh.tets))) == 2
    points, tets, regions = wct.optimize((mesh.points, mesh.tets, np.arange(len(mesh.tets)) % 2))
    assert np.array_equal(tets, mesh.tets)  # meets the goal already, so it is as it was
    assert points.flags.writeable
    assert regions.tolist() == (np.arange(len(mesh.tets)) % 2).tolist()


def test_optimize_gives_what_is_asked_for_and_writes(tmp_path):
    mesh = bcc(2)
    made = wct.optimize(mesh, tmp_path / "out.vtu", to="meshio")
    assert isinstance(made, meshio.Mesh)
    assert_same(wct.read(tmp_path / "out.vtu"), mesh)
    again = wct.optimize(tmp_path / "out.vtu", str(tmp_path / "out.msh"))
    assert isinstance(again, TetMesh)
    assert_same(wct.read(tmp_path / "out.msh"), mesh)
    with pytest.raises(OptionError, match=f"to is 'vtk'; allowed are {', '.join(TARGETS)}"):
        wct.optimize(mesh, to="vtk")
    with pytest.raises(OptionError, match=r"^filters.meshing_well_centered: unknown option 'gaol'"):
        wct.optimize(mesh, gaol="3wc")
    with pytest.raises(InputError, match="no such file"):
        wct.optimize(tmp_path / "none.vtu")


def test_optimize_fills_a_surface_and_gives_tets_in_the_same_library():
    # A rounder ball: with 12 by 12 its own edges bend by 30 degrees, close to the crease angle of 40.
    grid = wct.optimize(pv.Sphere(theta_resolution=20, phi_resolution=20), goal="3wc", tolerance=2e-2)
    assert isinstance(grid, pv.UnstructuredGrid)
    assert wct.report(grid).flags["3wc"] == grid.n_cells > 100


def test_a_surface_of_a_library_without_tets_becomes_a_mesh_of_ours():
    ball = trimesh.creation.icosphere(2)
    made = wct.optimize(ball, goal="3wc", tolerance=2e-2)
    assert isinstance(made, TetMesh)
    assert quality.measure(made).well_centered_3.all()
    # It may be the reference, too, as any surface.
    mesh, _ = wct.apply_filter("meshing_well_centered", made, reference=ball, goal="3wc")
    assert isinstance(mesh.reference, SurfaceMesh)


def test_optimize_warns_where_the_goal_is_missed():
    """One tet with nothing to change: a boundary that stays."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.1, 0.1, 0.2]])
    with pytest.warns(WctWarning, match=r"missed: filters.meshing_well_centered: \d+ of \d+ tets miss the goal cwc"):
        points, tets = wct.optimize((points, [[0, 1, 2, 3]]), boundary="fixed")
    assert tets.shape[1] == 4


def test_a_surface_has_no_report():
    with pytest.raises(OptionError, match="report needs a tet mesh, here is a surface"):
        wct.report(BALL)


def test_what_a_library_cannot_hold_is_refused():
    for call in (wct.to_trimesh, wct.to_pymeshlab):
        with pytest.raises(ObjectError, match=r"holds surfaces, here is a tet mesh; filters.generate_boundary_surface"):
            call(CUBE)
    with pytest.raises(ObjectError, match=r"holds tets, here is a surface; filters.generate_tetrahedralization fills"):
        wct.to_skfem(BALL)


def test_arrays_can_be_handed_to_meshers(tmp_path, monkeypatch):
    """pytetwild takes none that is read-only."""
    monkeypatch.chdir(tmp_path)  # it leaves a file
    ball = sphere_surface(40)
    points, triangles, _ = wct.to_arrays(ball)
    made = wct.as_mesh(pytetwild.tetrahedralize(points, triangles, edge_length_fac=0.5, quiet=True))
    assert isinstance(made, TetMesh)
    with pytest.raises(TypeError):
        pytetwild.tetrahedralize(ball.points, ball.triangles, quiet=True)
    for arrays in ((points, triangles), (ball.points, ball.triangles)):
        filled = wct.as_mesh(tetgen.TetGen(*arrays).tetrahedralize(order=1)[:3])
        assert isinstance(filled, TetMesh)
        assert len(filled.points) >= 40


def test_the_public_names_are_those_of_the_targets():
    assert {name for name in wct.__all__ if name.startswith("to_")} == {f"to_{name}" for name in TARGETS}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name in TARGETS:
            if name not in ("gmsh", "pymeshlab", "trimesh"):
                assert_same(wct.as_mesh(converted(CUBE, name)), CUBE)
