"""MED files as Salome, code_aster and gmsh write them."""

from pathlib import Path
from typing import Any

import gmsh
import h5py
import meshio
import numpy as np
import pytest
from support.builders import two_region_cube
from support.gmsh_session import add_two_boxes, gmsh_session
from support.volumes import tet_volumes

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import read
from wct_plugin.mesh import SurfaceMesh, TetMesh

CUBE = two_region_cube(3)
ENDS = CUBE.topology.boundary[(CUBE.points[CUBE.topology.boundary, 0] == 0).all(axis=1)]
WHOLE = "MED_NO_PROFILE_INTERNAL"


def name80(name: str, encoding: str) -> Any:
    return np.frombuffer(name.encode(encoding).ljust(80, b"\0"), dtype=np.int8)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A cube with a group of volumes, one of faces and one of nodes, by meshio; what it cannot write is added."""
    families = [-CUBE.regions - 1, np.full(len(ENDS), -9)]
    given = meshio.Mesh(
        CUBE.points,
        [("tetra", CUBE.tets), ("triangle", ENDS)],
        point_data={"point_tags": (CUBE.points[:, 2] == 0).astype(int) * 4},
        cell_data={"cell_tags": families},
    )
    meshio.med.write(tmp_path / "a.med", given)
    return tmp_path / "a.med"


def add_family(path: Path, where: str, number: int, names: list[str], encoding: str = "utf-8") -> None:
    with h5py.File(path, "a") as file:
        family = file.require_group(f"FAS/mesh/{where}").create_group(f"FAM_{number}_{'_'.join(names)}")
        family.attrs["NUM"] = number
        if names:
            family.create_group("GRO").attrs["NBR"] = len(names)
            family["GRO"]["NOM"] = np.stack([name80(name, encoding) for name in names])


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_groups_of_volumes_faces_and_nodes_in_any_language(encoding: str, path: Path) -> None:
    first, second = np.unique(CUBE.regions).tolist()
    add_family(path, "ELEME", -first - 1, ["Körper", "tout"], encoding)
    add_family(path, "ELEME", -second - 1, ["tout"], encoding)
    add_family(path, "ELEME", -9, ["entrée"], encoding)
    add_family(path, "ELEME", -100, [])  # as gmsh has it for entities in no group
    add_family(path, "NOEUD", 4, ["appui fixé"], encoding)
    mesh = read(path)
    assert isinstance(mesh, TetMesh)
    sets = dict(mesh.tet_sets)
    assert np.array_equal(sets["Körper"], np.flatnonzero(CUBE.regions == first))
    assert np.array_equal(sets["tout"], np.arange(len(CUBE.tets)))
    assert np.array_equal(mesh.facets.sets["entrée"], np.arange(len(ENDS)))
    assert np.array_equal(mesh.point_sets["appui fixé"], np.flatnonzero(CUBE.points[:, 2] == 0))


def add_field(path: Path, name: str, support: str, parts: dict[str, tuple[Any, Any]], time: float = 0.0) -> None:
    """By profile (None is all): rows and values, one row per entity."""
    with h5py.File(path, "a") as file:
        field = file.require_group(f"CHA/{name}")
        field.attrs["MAI"] = np.bytes_("mesh")
        step = field.create_group(f"{len(field) + 1:020d}{1:020d}/{support}")
        step.parent.attrs["PDT"] = time
        for profile, (rows, values) in parts.items():
            group = step.create_group(profile)
            group.attrs["NBR"], group.attrs["NGA"] = len(values), 1
            group["CO"] = np.asarray(values).reshape(len(values), -1).flatten(order="F")
            if rows is not None:
                file.require_group(f"PROFILS/{profile}")["PFL"] = np.asarray(rows) + 1


def test_fields_on_profiles(path: Path) -> None:
    """A profile lists the entities that have values; the others get NaN."""
    corners, some = np.arange(0, len(CUBE.points), 3), np.array([5, 2, 9])
    add_field(path, "u", "NOE", {"some points": (corners, CUBE.points[corners])})
    add_field(path, "heat", "MAI.TE4", {"some": (some, np.sqrt(some))})
    add_field(path, "whole", "MAI.TE4", {WHOLE: (None, CUBE.tets.astype(float))})
    add_field(path, "count", "MAI.TE4", {WHOLE: (None, np.arange(len(CUBE.tets)))})
    for step in range(2):
        add_field(path, "flux", "MAI.TR3", {WHOLE: (None, np.full(len(ENDS), step + 0.5))}, time=step / 4)
    mesh: Any = read(path)
    assert np.array_equal(mesh.point_data["u"][corners], CUBE.points[corners])
    assert np.isnan(np.delete(mesh.point_data["u"], corners, axis=0)).all()
    assert np.array_equal(mesh.cell_data["heat"][some], np.sqrt(some))
    assert np.isnan(mesh.cell_data["heat"]).sum() == len(CUBE.tets) - 3
    assert np.array_equal(mesh.cell_data["whole"], CUBE.tets)
    assert np.array_equal(mesh.cell_data["count"], np.arange(len(CUBE.tets)))
    assert mesh.facets.data["flux[0] - 0"].tolist() == [0.5] * len(ENDS)
    assert mesh.facets.data["flux[1] - 0.25"].tolist() == [1.5] * len(ENDS)


def test_as_gmsh_writes_it(tmp_path: Path) -> None:
    with gmsh_session():
        add_two_boxes(2)
        for tag, name in ((1, "acier"), (2, "béton")):
            gmsh.model.addPhysicalGroup(3, [tag], tag, name)
        gmsh.model.addPhysicalGroup(2, [1], 7, "entrée")
        gmsh.model.mesh.setSize(gmsh.model.getEntities(0), 0.7)
        gmsh.model.mesh.generate(3)
        gmsh.write(str(tmp_path / "a.med"))
    mesh: Any = read(tmp_path / "a.med")
    size = tet_volumes(mesh)
    assert sorted(size[mesh.regions == tag].sum() for tag in np.unique(mesh.regions)) == pytest.approx(
        [1, 2], rel=1e-12
    )
    assert set(mesh.tet_sets) | set(mesh.names) >= {"acier", "béton"}
    assert "entrée" in mesh.facets.sets or "entrée" in mesh.names


def test_polygons_and_steps_of_the_mesh(tmp_path: Path) -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [-1, 0.5, 0]])
    meshio.med.write(tmp_path / "a.med", meshio.Mesh(points, [("triangle", [[0, 1, 2]])]))
    with h5py.File(tmp_path / "a.med", "a") as file:
        mesh = file["ENS_MAA/mesh"]
        (key,) = mesh
        mesh.copy(mesh[key], "00000000000000000001-0000000000000000001")
        cells = mesh["00000000000000000001-0000000000000000001/MAI"]
        del cells["TR3"]
        cells.create_group("POG")["INN"] = [1, 6]
        cells["POG"]["NOD"] = [1, 2, 3, 4, 5]
    with pytest.warns(WctWarning) as caught:
        surface = read(tmp_path / "a.med")
    said = [str(warning.message).partition(".med: ")[2] for warning in caught]
    assert said == ["has 2 steps of the mesh 'mesh'; the last is taken", "1 polygon split into triangles"]
    assert isinstance(surface, SurfaceMesh)
    assert len(surface.triangles) == 3


def test_refusals(path: Path) -> None:
    with h5py.File(path, "a") as file:
        file.copy(file["ENS_MAA/mesh"], "ENS_MAA/other")
    with pytest.raises(InputError, match=r"a\.med: cannot be read as MED: has 2 meshes: mesh, other; allowed is one"):
        read(path)
    with h5py.File(path, "a") as file:
        del file["ENS_MAA/other"]
        (step,) = file["ENS_MAA/mesh"].values()
        step.move("MAI/TE4", "MAI/XY4")
    with pytest.raises(InputError, match=r"has cells of MED's kind 'XY4'; allowed are PO1, SE2"):
        read(path)
