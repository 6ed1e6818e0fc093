"""Exodus files as Cubit, MOOSE and VTK write them, in each kind of netCDF."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest
import pyvista as pv
from support.builders import two_region_cube
from support.volumes import region_volumes

from wct_plugin.errors import InputError, OutputError, WctWarning
from wct_plugin.io import read, write
from wct_plugin.mesh import SurfaceMesh, TetMesh

CUBE = two_region_cube(3)
POINTS = CUBE.points * [1 / 3, 1.1, np.pi]
BLOCKS = [CUBE.tets[CUBE.regions == tag] for tag in np.unique(CUBE.regions)]
TETS = np.concatenate(BLOCKS)
#: Corners of the four sides of a tet as the manual of Exodus II has them, from 1 on.
SIDES = np.array([[1, 2, 4], [2, 3, 4], [1, 4, 3], [1, 3, 2]]) - 1


#: VTK and netCDF4 each bring a netCDF library of their own, and not always can both be used in one process.
READS = """
import sys, numpy as np, pyvista as pv
reader = pv.get_reader(sys.argv[1])
reader.side_sets.enable_all()
found = reader.read()
inlet = found["Side Sets"]["inlet"]
print(sum(block.n_cells for block in found["Element Blocks"]), inlet.n_cells, np.abs(inlet.points[:, 0]).max())
"""
WRITES = """
import sys, pyvista as pv
from vtkmodules.vtkIOExodus import vtkExodusIIWriter
writer = vtkExodusIIWriter()
writer.SetInputData(pv.read(sys.argv[1]))
writer.SetFileName(sys.argv[2])
writer.SetBlockIdArrayName("ElementBlockIds")
writer.SetStoreDoubles(1)
writer.Write()
"""


def in_a_process(code: str, *arguments: Path) -> list[str]:
    """The words that a program prints."""
    command = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()


def sides_where(x: float) -> tuple[Any, Any]:
    """Numbers of cells and sides that lie where the first coordinate is this."""
    cells, sides = np.nonzero((POINTS[TETS[:, SIDES], 0] == x).all(axis=2))
    return cells + 1, sides + 1


def texts(file: Any, name: str, dimension: str, rows: list[str]) -> None:
    file.createVariable(name, "S1", (dimension, "len_string"))[:] = np.array(
        [list(row.encode().ljust(33, b"\0").decode("latin-1").encode("latin-1").decode("latin-1")) for row in rows]
    ).astype("S1")


def exodus(path: Path, kind: str, *, named: bool = True, apart: bool = True) -> None:
    """Two blocks, three side sets that overlap, a node set, and two steps of variables."""
    with netCDF4.Dataset(path, "w", format=kind) as file:
        file.api_version, file.version, file.floating_point_word_size, file.file_size = 8.03, 8.03, 8, 1
        sizes = {"len_string": 33, "len_name": 33, "num_dim": 3, "num_nodes": len(POINTS), "num_elem": len(TETS)}
        sizes |= {"num_el_blk": 2, "num_side_sets": 3, "num_node_sets": 1, "num_nod_var": 1, "num_elem_var": 1}
        for name, size in sizes.items():
            file.createDimension(name, size)
        file.createDimension("time_step", None)
        file.createVariable("time_whole", "f8", ("time_step",))[:] = [0.0, 2.5]
        if apart:
            for k, axis in enumerate("xyz"):
                file.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = POINTS[:, k]
        else:
            file.createVariable("coord", "f8", ("num_dim", "num_nodes"))[:] = POINTS.T
        file.createVariable("eb_prop1", "i4", ("num_el_blk",))[:] = [10, 20]
        file.createVariable("ss_prop1", "i4", ("num_side_sets",))[:] = [5, 6, 7]
        file.createVariable("ns_prop1", "i4", ("num_node_sets",))[:] = [3]
        if named:
            texts(file, "eb_names", "num_el_blk", ["steel", "air"])
            texts(file, "ss_names", "num_side_sets", ["inlet", "outlet", "ends"])
            texts(file, "ns_names", "num_node_sets", ["fixed"])
        texts(file, "name_nod_var", "num_nod_var", ["temperature"])
        texts(file, "name_elem_var", "num_elem_var", ["power"])
        for step in range(2):
            if not step:
                file.createVariable("vals_nod_var1", "f8", ("time_step", "num_nodes"))
            file["vals_nod_var1"][step] = POINTS[:, 0] + step
        for k, block in enumerate(BLOCKS, start=1):
            file.createDimension(f"num_el_in_blk{k}", len(block))
            file.createDimension(f"num_nod_per_el{k}", 4)
            cells = file.createVariable(f"connect{k}", "i4", (f"num_el_in_blk{k}", f"num_nod_per_el{k}"))
            cells[:] = block + 1
            cells.elem_type = "TETRA" if k == 1 else "tet4"
            if k == 1:  # the second block does not have it
                values = file.createVariable(f"vals_elem_var1eb{k}", "f8", ("time_step", f"num_el_in_blk{k}"))
                values[:] = np.stack([np.arange(len(block)), np.arange(len(block)) + 0.5])
        low, high = sides_where(0.0), sides_where(POINTS[:, 0].max())
        both = tuple(np.concatenate([a, b]) for a, b in zip(low, high, strict=True))
        for k, (cells, sides) in enumerate((low, high, both), start=1):
            file.createDimension(f"num_side_ss{k}", len(cells))
            file.createVariable(f"elem_ss{k}", "i4", (f"num_side_ss{k}",))[:] = cells
            file.createVariable(f"side_ss{k}", "i4", (f"num_side_ss{k}",))[:] = sides
        fixed = np.flatnonzero(POINTS[:, 2] == 0)
        file.createDimension("num_nod_ns1", len(fixed))
        file.createVariable("node_ns1", "i4", ("num_nod_ns1",))[:] = fixed + 1


WANTED = region_volumes(TetMesh(POINTS, TETS, np.repeat([10, 20], [len(block) for block in BLOCKS])))


@pytest.mark.parametrize("kind", ["NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF4"])
@pytest.mark.parametrize("suffix", [".e", ".exo", ".ex2"])
def test_blocks_side_sets_node_sets_and_variables(kind: str, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{suffix}"
    exodus(path, kind, apart=suffix != ".exo")
    with pytest.warns(WctWarning, match=rf"a\{suffix}: has 2 steps; the last at time 2\.5 is taken$"):
        mesh = read(path)
    assert isinstance(mesh, TetMesh)
    assert region_volumes(mesh) == pytest.approx(WANTED, rel=1e-12)
    assert np.array_equal(mesh.tets, TETS)
    assert {name: tuple(pair) for name, pair in mesh.names.items()} == {
        "steel": (10, 3), "air": (20, 3), "inlet": (5, 2), "outlet": (6, 2), "ends": (7, 2)
    }  # fmt: skip
    middle = mesh.points[mesh.facets.vertices][:, :, 0].mean(axis=1)
    assert np.array_equal(mesh.facets.tags, np.where(middle == 0, 5, 6))
    assert (len(mesh.facets), len(mesh.facets.sets["ends"])) == (36, 36)
    assert np.array_equal(mesh.point_sets["fixed"], np.flatnonzero(POINTS[:, 2] == 0))
    assert np.array_equal(mesh.point_data["temperature"], POINTS[:, 0] + 1)
    first = len(BLOCKS[0])
    assert np.array_equal(mesh.cell_data["power"][:first], np.arange(first) + 0.5)
    assert np.isnan(mesh.cell_data["power"][first:]).all()


def test_vtk_finds_the_same_in_the_file(tmp_path: Path) -> None:
    """That the file of these tests is one, and its sides what they are meant to be."""
    exodus(tmp_path / "a.e", "NETCDF3_64BIT_OFFSET")
    cells, of_inlet, farthest = in_a_process(READS, tmp_path / "a.e")
    assert (int(cells), int(of_inlet), float(farthest)) == (len(TETS), 18, 0)


def test_without_names_sets_are_called_by_number(tmp_path: Path) -> None:
    exodus(tmp_path / "a.e", "NETCDF4", named=False)
    with pytest.warns(WctWarning):
        mesh: Any = read(tmp_path / "a.e")
    assert region_volumes(mesh) == pytest.approx(WANTED, rel=1e-12)
    assert set(mesh.facets.sets) == {"side set 5", "side set 6", "side set 7"}
    assert list(mesh.point_sets) == ["node set 3"]
    assert not mesh.names


def test_as_vtk_writes_it(tmp_path: Path) -> None:
    grid = pv.UnstructuredGrid({10: TETS}, POINTS)
    grid.cell_data["ElementBlockIds"] = np.repeat([10, 20], [len(block) for block in BLOCKS]).astype("i4")
    grid.save(tmp_path / "a.vtu")
    in_a_process(WRITES, tmp_path / "a.vtu", tmp_path / "a.exo")
    mesh: Any = read(tmp_path / "a.exo")
    assert sorted(region_volumes(mesh).values()) == pytest.approx(sorted(WANTED.values()), rel=1e-12)


def test_shells_are_a_surface(tmp_path: Path) -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]])
    with netCDF4.Dataset(tmp_path / "a.e", "w", format="NETCDF3_CLASSIC") as file:
        for name, size in (("num_dim", 3), ("num_nodes", 5), ("one", 1), ("three", 3), ("four", 4)):
            file.createDimension(name, size)
        file.createVariable("coord", "f8", ("num_dim", "num_nodes"))[:] = points.T
        for k, (kind, cell) in enumerate((("SHELL4", [1, 2, 3, 4]), ("TRI3", [2, 5, 3])), start=1):
            cells = file.createVariable(f"connect{k}", "i4", ("one", "four" if k == 1 else "three"))
            cells[:] = cell
            cells.elem_type = kind
    with pytest.warns(WctWarning, match="1 quad split into triangles$"):
        surface = read(tmp_path / "a.e")
    assert isinstance(surface, SurfaceMesh)
    assert sorted(surface.tags.tolist()) == [1, 1, 2]


def test_refusals(plain: TetMesh, tmp_path: Path) -> None:
    (tmp_path / "a.e").write_bytes(b"CDF\x05" + bytes(100))
    with pytest.raises(InputError, match=r"a\.e: cannot be read as Exodus: is netCDF of the kind CDF-5; allowed are"):
        read(tmp_path / "a.e")
    exodus(tmp_path / "b.e", "NETCDF3_CLASSIC")
    with netCDF4.Dataset(tmp_path / "b.e", "a") as file:
        file["side_ss2"][:] = 5
    with pytest.raises(InputError, match="side set 6 names side 5 of tetra cells, which have 4"):
        read(tmp_path / "b.e")
    with pytest.raises(OutputError, match=r"c\.e: Exodus is read, not written; allowed are \.vtu"):
        write(tmp_path / "c.e", plain)
    data = (tmp_path / "b.e").read_bytes()
    for share in np.linspace(0.02, 0.98, 25):
        (tmp_path / "d.e").write_bytes(data[: int(share * len(data))])
        with pytest.raises(InputError, match=r"d\.e: cannot be read as Exodus: "):
            read(tmp_path / "d.e")
