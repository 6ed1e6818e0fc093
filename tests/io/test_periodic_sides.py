"""gmsh's ``$Periodic``: which sides are translates of each other, read and written back."""

from dataclasses import replace
from pathlib import Path

import gmsh
import meshio
import numpy as np
import pytest
from support.builders import kuhn_cube
from support.gmsh_session import gmsh_session

import wct_plugin as wct
from wct_plugin.errors import WctWarning
from wct_plugin.io import read, write
from wct_plugin.mesh import Cells, TetMesh

FORMS = [("2.2", False), ("2.2", True), ("4.1", False), ("4.1", True)]


def gmsh_cell(path: Path, version: str, binary: bool, turned: bool = False) -> None:
    """The unit cube by gmsh: the side x = 1 is x = 0 translated, or y = 0 is that, turned about an edge."""
    with gmsh_session():
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
        gmsh.model.occ.synchronize()
        affine = np.eye(4)
        if turned:
            affine[:2, :2] = [[0.0, 1.0], [-1.0, 0.0]]
        else:
            affine[0, 3] = 1.0
        gmsh.model.mesh.setPeriodic(2, [3 if turned else 2], [1], affine.ravel())
        gmsh.model.addPhysicalGroup(3, [1], 1)
        gmsh.model.addPhysicalGroup(2, [1], 2, "x0")
        gmsh.model.addPhysicalGroup(2, [3 if turned else 2], 3, "other")
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.4)
        gmsh.model.mesh.generate(3)
        gmsh.option.setNumber("Mesh.MshFileVersion", float(version))
        gmsh.option.setNumber("Mesh.Binary", int(binary))
        gmsh.write(str(path))


def cell(tags: tuple[int, int] = (5, 6)) -> TetMesh:
    """A periodic cube whose sides x = 0 and x = 1 are tagged."""
    mesh = kuhn_cube(3)
    facets = mesh.topology.boundary
    x = mesh.points[facets][:, :, 0]
    low, high = facets[(x == 0.0).all(axis=1)], facets[(x == 1.0).all(axis=1)]
    both = Cells(np.concatenate([low, high]), np.repeat(tags, [len(low), len(high)]))
    return replace(mesh, regions=np.ones(len(mesh.tets), dtype=np.int64), facets=both, periodic=True)


@pytest.mark.parametrize(("version", "binary"), [*FORMS, ("4.0", False)])
def test_what_gmsh_writes_is_read(tmp_path, version, binary):
    gmsh_cell(tmp_path / "a.msh", version, binary)
    assert read(tmp_path / "a.msh").periodic


def test_sides_that_are_turned_are_named(tmp_path):
    gmsh_cell(tmp_path / "a.msh", "4.1", False, turned=True)
    with pytest.warns(WctWarning, match="not read: periodic sides that are turned"):
        assert not read(tmp_path / "a.msh").periodic


@pytest.mark.parametrize("tags", [(5, 6), (5, 5)])
@pytest.mark.parametrize(("version", "binary"), FORMS)
def test_written_back_as_it_was(tmp_path, version, binary, tags):
    mesh = cell(tags)
    write(tmp_path / "a.msh", mesh, version=version, binary=binary)
    again = read(tmp_path / "a.msh")
    assert again.periodic
    assert np.array_equal(np.sort(again.facets.tags), np.sort(mesh.facets.tags))
    [[dimension, (slave, master), affine, nodes]] = meshio.read(tmp_path / "a.msh").gmsh_periodic
    assert (dimension, len(affine)) == (2, 16)
    assert slave != master
    step = again.points[nodes[:, 0]] - again.points[nodes[:, 1]]
    assert np.array_equal(step, np.tile(affine.reshape(4, 4)[:3, 3], (len(nodes), 1)))
    assert np.array_equal(np.abs(step), np.tile([1.0, 0.0, 0.0], (16, 1)))


@pytest.mark.parametrize("binary", [False, True])
def test_gmsh_reads_what_is_written(tmp_path, binary):
    write(tmp_path / "a.msh", cell(), version="4.1", binary=binary)
    with gmsh_session():
        gmsh.open(str(tmp_path / "a.msh"))
        counts = [len(gmsh.model.mesh.getPeriodicNodes(2, tag)[1]) for _, tag in gmsh.model.getEntities(2)]
    assert sorted(counts) == [0, 16]


def test_a_loss_is_named(tmp_path):
    with pytest.warns(WctWarning, match="which sides are periodic"):
        write(tmp_path / "a.vtu", cell())
    with pytest.warns(WctWarning, match="which sides are periodic"):
        write(tmp_path / "a.msh", replace(cell(), facets=cell().facets.select(np.zeros(36, dtype=bool))))


def test_optimized_where_the_file_says_so(tmp_path):
    mesh = cell()
    for periodic in (True, False):
        better, found = wct.apply_filter(
            "meshing_well_centered", replace(mesh, periodic=periodic), goal="3wc", force=True
        )
        assert better.periodic == periodic
        assert (found["periodic"]["after"] == found["periodic"]["before"]) == periodic
        assert not found["losses"]
