"""What is made from nothing has its faces as named groups of facets, in files too."""

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import wct_plugin as wct
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.triangle_surfaces import areas

BOX = {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"}
FIGURE = np.zeros((3, 2, 2), dtype=int)
FIGURE[:, 0, 0] = 1
FIGURE[1, 1, 0] = 2


def areas_of_faces(mesh: TetMesh) -> dict[str, float]:
    size = areas(mesh.points, mesh.facets.vertices)
    return {name: float(size[mesh.facets.tags == tag].sum()) for name, (tag, dimension) in mesh.names.items()}


@pytest.mark.parametrize(
    ("name", "options", "wanted"),
    [
        ("create_cube", {"size": 2.0}, dict.fromkeys(BOX, 4.0)),
        ("create_cube", {"variant": "30"}, dict.fromkeys(BOX, 1.0)),
        ("create_cube_corner", {}, {"x_min": 0.5, "y_min": 0.5, "z_min": 0.5, "face_1": 3**0.5 / 2}),
        ("create_tetrahedron", {}, {f"face_{k}": 2 * 3**0.5 for k in range(1, 5)}),
        ("create_tetrahedron_subdivision", {}, None),
        (
            "create_from_voxels",
            {"voxels": FIGURE},
            {"x_min": 2, "x_max": 2, "y_min": 3, "y_max": 3, "z_min": 4, "z_max": 4},
        ),
        ("create_lattice_tiling", {"domain": "slab"}, None),
    ],
)
def test_faces(name: str, options: dict[str, Any], wanted: dict[str, float] | None) -> None:
    mesh, _ = getattr(wct.Filter, name)(**options).steps[0].stage(None)
    assert len(mesh.facets) == len(mesh.topology.boundary)
    assert np.array_equal(
        np.unique(np.sort(mesh.facets.vertices, axis=1), axis=0),
        np.unique(np.sort(mesh.topology.boundary, axis=1), axis=0),
    )
    assert mesh.facets.tags.all()
    found = areas_of_faces(mesh)
    if wanted is None:
        assert set(found) == (BOX if "lattice" in name else {f"face_{k}" for k in range(1, 5)})
    else:
        assert found == pytest.approx(wanted, rel=1e-4)


def test_facets_of_voxels_face_outward() -> None:
    mesh, _ = wct.Filter.create_from_voxels(voxels=FIGURE).steps[0].stage(None)
    outward = {frozenset(row): tuple(np.roll(row, -np.argmin(row))) for row in mesh.topology.boundary.tolist()}
    for row in mesh.facets.vertices.tolist():
        assert outward[frozenset(row)] == tuple(np.roll(row, -np.argmin(row)))


def test_create_writes_them(tmp_path: Path) -> None:
    from wct_plugin.cli.main import run

    assert run(["create", "cube", str(tmp_path / "a.msh"), "--variant", "84"]) == 0
    found = meshio.gmsh.read(tmp_path / "a.msh")
    assert set(found.field_data) == BOX
    assert len(np.unique(np.concatenate(found.cell_data["gmsh:physical"]))) == 7
