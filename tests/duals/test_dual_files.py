"""Duals as files, read by others: polyhedra by VTK, OpenFOAM's by VTK and by hand, matrices by NumPy and SciPy."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from scipy.io import mmread
from scipy.sparse import coo_array, diags_array
from support.builders import bcc, kuhn_cube, two_region_cube
from support.polyhedra import area_vector, measured

import wct_plugin as wct
from wct_plugin.errors import InputError, OptionError, OutputError, WctWarning
from wct_plugin.measure.duals import compute_duals, hodge_star
from wct_plugin.measure.exterior import exterior_derivative
from wct_plugin.mesh import Cells, TetMesh


def cube(**extra):
    mesh, _ = wct.apply_filter("create_cube", variant="84")
    return replace(mesh, **extra)


def grouped():
    """The unit cube with named, numbered and overlapping groups, and a rest."""
    mesh = cube()
    boundary = mesh.topology.boundary
    x, y, z = mesh.points[boundary].mean(axis=1).T
    chosen = {"inlet": x < 1e-9, "out let": x > 1 - 1e-9, 7: y < 1e-9, "half": (z < 1e-9) | (x < 1e-9)}
    tags = np.select([chosen["inlet"], chosen["out let"], chosen[7]], [1, 2, 7], 0)
    facets = Cells(boundary, tags, sets={"half": np.flatnonzero(chosen["half"])})
    names = {"inlet": (1, 2), "out let": (2, 2), "steel": (4, 3)}
    return replace(mesh, regions=np.full(len(mesh.tets), 4), facets=facets, names=names)


# --- polyhedra -------------------------------------------------------------------------------------------------------


def cells_of(grid):
    """Volume and openness of every cell, from the faces that VTK has."""
    found = []
    for k in range(grid.n_cells):
        faces = grid.get_cell(k).faces
        rings = [np.array([grid.points[i] for i in face.point_ids]) for face in faces]
        apex = rings[0][0]
        volume = sum(
            np.linalg.det(np.stack([r[0] - apex + 0 * r[1:-1], r[1:-1] - apex, r[2:] - apex], 1)).sum() for r in rings
        )
        found.append((volume / 6.0, np.linalg.norm(sum(area_vector(ring) for ring in rings))))
    return np.array(found).T


@pytest.mark.filterwarnings("ignore:.*60 tagged facets$:wct_plugin.errors.WctWarning")
def test_vtk_reads_the_polyhedra(tmp_path):
    mesh = cube(
        point_data={"u": np.linspace(0, 1, 35), "v": np.ones((35, 3), np.float32), "yes": np.arange(35) % 2 == 0}
    )
    said = wct.write_dual(tmp_path / "cells.vtu", mesh)
    assert said == "35 cells, 148 faces between them, 180 on the boundary, volume 1"
    grid = pv.read(tmp_path / "cells.vtu")
    assert grid.n_cells == 35
    assert set(grid.celltypes.tolist()) == {42}
    volumes, open_by = cells_of(grid)
    duals = compute_duals(mesh).volumes
    assert volumes == pytest.approx(duals, rel=1e-12)
    assert open_by.max() < 1e-14
    assert grid["volume"] == pytest.approx(duals, rel=1e-15)
    assert volumes.sum() == pytest.approx(1.0, rel=1e-12)
    # As VTK itself measures them; a cube's cells are convex.
    assert np.asarray(grid.compute_cell_sizes()["Volume"]) == pytest.approx(duals, rel=1e-9)
    assert grid["vertex"].tolist() == list(range(35))
    assert grid["u"].tolist() == mesh.point_data["u"].tolist()
    assert grid["v"].dtype == np.float32
    assert grid["yes"].tolist() == mesh.point_data["yes"].astype(int).tolist()
    for k in (3, 20):
        inside = grid.extract_cells([k]).extract_surface(algorithm=None)
        assert inside.n_open_edges == 0


def test_two_materials_have_cells_of_their_own(tmp_path):
    mesh, _ = wct.apply_filter("meshing_well_centered", two_region_cube(2), goal="cwc", seed=1)
    wct.write_dual(tmp_path / "cells.vtu", wct.to_meshio(mesh))
    grid = pv.read(tmp_path / "cells.vtu")
    assert grid.n_cells == len(mesh.points) + len(np.unique(mesh.topology.interfaces))
    for tag in (1, 2):
        assert grid["volume"][grid["region"] == tag].sum() == pytest.approx(0.5, rel=1e-12)
        assert cells_of(grid)[0][grid["region"] == tag].sum() == pytest.approx(0.5, rel=1e-12)
    assert np.bincount(grid["vertex"], grid["volume"]) == pytest.approx(compute_duals(mesh).volumes, rel=1e-12)


def test_point_data_that_vtk_has_no_type_for_are_named(tmp_path):
    with pytest.warns(WctWarning, match=r"cells.vtu: not in it: point data 'words'"):
        wct.write_dual(tmp_path / "cells.vtu", cube(point_data={"words": np.array(["a"] * 35)}))


def test_what_cells_have_no_place_for_is_named(tmp_path):
    mesh = cube(cell_data={"heat": np.ones(84)}, tet_sets={"core": np.arange(5)}, point_sets={"fixed": np.arange(3)})
    mesh = replace(
        mesh, names={"steel": (0, 3)}, edges=Cells(mesh.topology.edges[:4]), nodes=Cells(np.array([[0], [1]]))
    )
    of_tets = "cell data 'heat', set 'core' of tets, set 'fixed' of points, 4 tagged edges, 2 tagged vertices"
    with pytest.warns(WctWarning, match=rf"cells.vtu: not in it: {of_tets}, 60 tagged facets, name 'steel'$"):
        wct.write_dual(tmp_path / "cells.vtu", mesh)
    with pytest.warns(WctWarning, match=rf"case: not in it: .*, point data 'u', {of_tets}$"):
        wct.write_dual(tmp_path / "case", replace(mesh, point_data={"u": np.ones(35)}))


@pytest.mark.filterwarnings("ignore:.*(stay as they are|not positive):wct_plugin.errors.WctWarning")
def test_cells_beside_the_tets_are_named(tmp_path):
    with pytest.warns(WctWarning, match=r"dec.npz: not in it: 52 wedge cells$"):
        wct.write_dual(tmp_path / "dec.npz", Path(__file__).parents[1] / "data/prismlayer.msh")


# --- OpenFOAM --------------------------------------------------------------------------------------------------------


class Case:
    """A polyMesh by hand, and not by the code that wrote it."""

    def __init__(self, case):
        folder = case / "constant/polyMesh"
        text = {name: (folder / name).read_text() for name in ("points", "faces", "owner", "neighbour", "boundary")}
        self.zones = (folder / "cellZones").read_text()
        for name, content in text.items():
            assert re.search(rf"format ascii;.*object {name};", content, re.DOTALL)
        body = {name: content.partition("}")[2] for name, content in text.items()}
        numbers = {name: np.array(re.findall(r"[-+.\deE]+", body[name])) for name in ("points", "owner", "neighbour")}
        self.points = numbers["points"][1:].astype(float).reshape(-1, 3)
        self.owner, self.neighbour = (numbers[name][1:].astype(int) for name in ("owner", "neighbour"))
        self.rings = [np.array(ring.split(), int) for ring in re.findall(r"\d+\(([^()]+)\)", body["faces"])]
        counts = {name: int(body[name].split()[0]) for name in ("points", "faces", "owner", "neighbour")}
        assert list(counts.values()) == [len(one) for one in (self.points, self.rings, self.owner, self.neighbour)]
        patch = r"(\S+)\s*\{\s*type patch;\s*nFaces (\d+);\s*startFace (\d+);\s*\}"
        self.patches = {name: (int(n), int(start)) for name, n, start in re.findall(patch, text["boundary"])}

    def area(self, name):
        count, start = self.patches[name]
        return sum(area_vector(self.points[ring]) for ring in self.rings[start : start + count])


def test_openfoam(tmp_path):
    mesh = grouped()
    lost = "8 facets of group 'half' that are in another patch, the name 'out let', there 'out_let'"
    with pytest.warns(WctWarning, match=rf"case: not in it: {lost}, the name '7', there 'patch_7'"):
        wct.write_dual(tmp_path / "case", mesh)
    case = Case(tmp_path / "case")
    volumes, open_by = measured(case.points, case.rings, case.owner, case.neighbour)
    assert volumes == pytest.approx(compute_duals(mesh).volumes, rel=1e-12)
    assert open_by.max() < 1e-14
    inner = len(case.neighbour)
    assert (case.owner[:inner] < case.neighbour).all()
    keys = list(zip(case.owner[:inner].tolist(), case.neighbour.tolist(), strict=True))
    assert keys == sorted(set(keys))
    assert list(case.patches) == ["inlet", "out_let", "half", "patch_7", "defaultFaces"]
    begin = inner
    for count, start in case.patches.values():
        assert start == begin
        begin += count
    assert begin == len(case.rings)
    for name, outward in (("inlet", [-1, 0, 0]), ("out_let", [1, 0, 0]), ("half", [0, 0, -1]), ("patch_7", [0, -1, 0])):
        assert case.area(name) == pytest.approx(outward, abs=1e-12)
    assert sum(case.area(name) for name in case.patches) == pytest.approx([0, 0, 0], abs=1e-12)
    assert re.search(r"\n1\n\(\nsteel\n\{\ntype cellZone;\ncellLabels List<label>\n35\n\(\n0\n1\n", case.zones)


def test_vtk_reads_openfoams(tmp_path):
    mesh = cube()
    wct.write_dual(tmp_path / "case", mesh)
    (tmp_path / "case/case.foam").touch()
    blocks = pv.OpenFOAMReader(str(tmp_path / "case/case.foam")).read()
    grid = blocks["internalMesh"]
    assert grid.n_cells == 35
    volumes = np.asarray(grid.compute_cell_sizes()["Volume"])
    assert volumes == pytest.approx(compute_duals(mesh).volumes, rel=1e-6)  # VTK has single precision there
    faces = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"]  # the groups that a created cube has
    assert sorted(blocks["boundary"].keys()) == sorted(faces)
    assert [blocks["boundary"][face].area for face in faces] == pytest.approx(np.ones(6), rel=1e-6)


def test_zones_of_two_materials(tmp_path):
    mesh = bcc(3)
    regions = (mesh.points[mesh.tets].mean(axis=1)[:, 0] > 1.4).astype(np.int64)
    mesh = replace(mesh, regions=regions, names={"air": (1, 3)})
    wct.write_dual(tmp_path / "case", mesh)
    case = Case(tmp_path / "case")
    assert re.findall(r"^(\w+)\n\{", case.zones.partition("}")[2], re.MULTILINE) == ["region_0", "air"]
    volumes, _ = measured(case.points, case.rings, case.owner, case.neighbour)
    lists = [np.array(one.split(), int) for one in re.findall(r"\n\(\n([\d\n]+)\)\n;", case.zones)]
    assert sorted(np.concatenate(lists).tolist()) == list(range(len(volumes)))
    each = wct.report(mesh)
    assert sum(volumes[one].sum() for one in lists) == pytest.approx(each.volume, rel=1e-12)


def test_facets_inside_are_named(tmp_path):
    mesh = cube()
    inside = mesh.topology.facets[:2]
    facets = Cells(np.concatenate([mesh.topology.boundary[:3], inside]), np.full(5, 3))
    with pytest.warns(WctWarning, match="2 facets of group '3' that are not on the boundary"):
        wct.write_dual(tmp_path / "case", replace(mesh, facets=facets, names={}))
    assert Case(tmp_path / "case").patches["patch_3"][0] == 9


def test_a_case_that_is_there_keeps_all_else(tmp_path):
    case = tmp_path / "case"
    (case / "system").mkdir(parents=True)
    (case / "system/controlDict").write_text("mine")
    wct.write_dual(case, bcc(2))
    first = (case / "constant/polyMesh/points").read_text()
    wct.write_dual(case, cube())  # its own files are replaced
    assert (case / "constant/polyMesh/points").read_text() != first
    assert (case / "system/controlDict").read_text() == "mine"
    (case / "constant/polyMesh/faceZones").write_text("old")
    before = {path: path.read_bytes() for path in case.rglob("*") if path.is_file()}
    with pytest.raises(OutputError, match="polyMesh: has 'faceZones', which would not fit the new mesh; remove"):
        wct.write_dual(case, bcc(2))
    assert {path: path.read_bytes() for path in case.rglob("*") if path.is_file()} == before


# --- matrices --------------------------------------------------------------------------------------------------------


def test_npz(tmp_path):
    mesh = cube()
    assert wct.write_dual(tmp_path / "dec.npz", mesh) == "star0 of 35, star1 of 148, star2 of 198, star3 of 84"
    with np.load(tmp_path / "dec.npz") as file:
        found = dict(file)
    for k in range(4):
        assert np.array_equal(found[f"star{k}"], hodge_star(mesh, k))
    sizes = [len(found[f"star{k}"]) for k in range(4)]
    matrices = [
        coo_array(
            (found[f"d{k}_value"], (found[f"d{k}_row"], found[f"d{k}_col"])), shape=(sizes[k + 1], sizes[k])
        ).tocsr()
        for k in range(3)
    ]
    for k in range(3):
        assert (matrices[k] != exterior_derivative(mesh, k)).nnz == 0
    assert (matrices[1] @ matrices[0]).count_nonzero() == 0
    assert (matrices[2] @ matrices[1]).count_nonzero() == 0
    assert np.array_equal(found["tets"], mesh.tets)
    assert np.array_equal(found["edges"], mesh.topology.edges)
    laplacian = matrices[0].T @ diags_array(found["star1"]) @ matrices[0]
    for axis in np.eye(3):
        along = mesh.points @ axis
        assert along @ laplacian @ along == pytest.approx(1.0, rel=1e-12)  # what linear functions have in a unit cube


def test_matrix_market(tmp_path):
    mesh = cube()
    wct.write_dual(tmp_path / "new/dec", mesh, format="matrix-market")
    folder = tmp_path / "new/dec"
    assert sorted(path.name for path in folder.iterdir()) == sorted(
        f"{name}.mtx" for name in ("d0", "d1", "d2", "star0", "star1", "star2", "star3")
    )
    for k in range(4):
        assert np.array_equal(mmread(folder / f"star{k}.mtx").diagonal(), hodge_star(mesh, k))
    for k in range(3):
        assert (mmread(folder / f"d{k}.mtx").tocsr() != exterior_derivative(mesh, k)).nnz == 0


def test_stars_of_any_mesh_are_written_and_what_is_not_positive_is_said(tmp_path):
    said = "44 of 98 entries of star1 are not positive, 48 of 120 entries of star2 are not positive; goal cwc"
    with pytest.warns(WctWarning, match=f"dec.npz: {said}"):
        wct.write_dual(tmp_path / "dec.npz", kuhn_cube(2))
    with np.load(tmp_path / "dec.npz") as file:
        assert (~(file["star1"] > 0)).sum() == 44


# --- refusals --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["cells.vtu", "case"])
def test_tangled_cells_leave_nothing(name, tmp_path):
    with pytest.raises(InputError, match="its dual cells are tangled"):
        wct.write_dual(tmp_path / name, kuhn_cube(2))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "form", "error", "message"),
    [
        (
            "a.stl",
            None,
            OutputError,
            r"unknown suffix '\.stl'; allowed are \.vtu \.npz, and none for a folder, of OpenFOAM",
        ),
        ("a", "vtu", OptionError, "format is 'vtu', and '.*a' does not end in .vtu"),
        ("a.npz", "vtu", OptionError, "format is 'vtu', and"),
        ("a.vtu", "openfoam", OptionError, "format is 'openfoam', a folder, and '.*' ends in .vtu"),
        ("a", "foam", OptionError, "format is 'foam'; allowed are vtu, npz, openfoam, matrix-market"),
        ("no/a.vtu", None, OutputError, "there is no directory"),
        ("file", None, OutputError, "file is a file; a folder is needed"),
    ],
)
def test_names_that_are_refused(name, form, error, message, tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(error, match=message):
        wct.write_dual(str(tmp_path / name), cube(), format=form)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_surface_has_no_dual(tmp_path):
    with pytest.raises(InputError, match="the dual holds tets, here is a surface"):
        wct.write_dual(tmp_path / "a.vtu", cube().boundary_surface())


def test_a_full_disk_leaves_nothing(small_disk: Path):
    with pytest.raises(OutputError, match="cannot be written"):
        wct.write_dual(small_disk / "case", TetMesh(bcc(4).points, bcc(4).tets))
    assert list(small_disk.iterdir()) == []


# --- pipelines and the command line ----------------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore:.*60 tagged facets$:wct_plugin.errors.WctWarning")
def test_in_a_pipeline(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mesh = cube()
    chain = wct.Reader(mesh) | wct.Writer.dual(filename="cells.vtu") | wct.Writer.dual(filename=tmp_path / "case")
    result = (chain | wct.Writer.dual(filename="dec", format="matrix-market") | wct.Writer("mesh.vtu")).execute()
    assert np.array_equal(result.mesh.tets, mesh.tets)  # it is handed on
    assert pv.read("cells.vtu").n_cells == 35
    assert {path.name for path in tmp_path.iterdir()} == {"cells.vtu", "case", "dec", "mesh.vtu"}
    text = chain.steps[1].stage.type()
    assert text == "writers.dual"
    again = wct.Pipeline.from_json('["mesh.vtu", {"type": "writers.dual", "filename": "again.npz"}]')
    assert again.to_json() == ["mesh.vtu", {"type": "writers.dual", "filename": "again.npz"}]
    again.execute()
    assert (tmp_path / "again.npz").exists()


@pytest.mark.parametrize(
    ("writer", "message"),
    [
        ({"filename": "a.stl"}, r"stage 2 of 2 \(writers.dual\): a.stl: unknown suffix"),
        ({"filename": "a", "format": "foam"}, "option 'format' is 'foam'; input should be 'vtu'"),
        ({"filename": "none/a.npz"}, "there is no directory none"),
    ],
)
def test_a_pipeline_is_refused_before_it_runs(writer, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wct.write("mesh.vtu", cube())
    with pytest.raises(wct.WctError, match=message):
        wct.Pipeline.from_json(["mesh.vtu", {"type": "writers.dual", **writer}]).check()
