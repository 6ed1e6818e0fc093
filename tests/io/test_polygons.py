"""Quads and polygons of surfaces become triangles: the same area, on the same corners, and a line that says so."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from numpy.typing import NDArray

from wct_plugin.errors import WctWarning
from wct_plugin.io import read
from wct_plugin.io.polygons import split
from wct_plugin.mesh import SurfaceMesh

CUBE = np.array([[x, y, z] for z in (0.0, 1) for y in (0, 1) for x in (0, 1)])
SIDES = np.array([[2, 3, 1, 0], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]])


def areas(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    a, b, c = np.moveaxis(points[triangles], -2, 0)
    return np.cross(b - a, c - a) / 2


def volume(surface: SurfaceMesh) -> float:
    return float(np.linalg.det(surface.points[surface.triangles]).sum() / 6)


def quad_cube(path: Path) -> None:
    corners = "".join(f"{x} {y} {z}\n" for x, y, z in CUBE)
    faces = [" ".join(map(str, side)) for side in SIDES.tolist()]
    match path.suffix:
        case ".obj":
            points = "".join(f"v {line}\n" for line in corners.splitlines())
            path.write_text(points + "".join(f"f {' '.join(str(c + 1) for c in side)}\n" for side in SIDES.tolist()))
        case ".off":
            path.write_text(f"OFF\n8 6 0\n{corners}" + "".join(f"4 {face}\n" for face in faces))
        case ".ply":
            axes = "".join(f"property double {axis}\n" for axis in "xyz")
            head = f"ply\nformat ascii 1.0\nelement vertex 8\n{axes}element face 6\n"
            head += "property list uchar int vertex_indices\nproperty int id\nend_header\n"
            path.write_text(head + corners + "".join(f"4 {face} {k}\n" for k, face in enumerate(faces)))
        case _:
            data = {"id": [np.arange(6)]}
            meshio.write(path, meshio.Mesh(CUBE, [("quad", SIDES)], cell_data=data), **_options(path.suffix))


def _options(suffix: str) -> dict[str, str]:
    return {"file_format": "gmsh22"} if suffix == ".msh" else {}


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply", ".vtu", ".vtk", ".msh", ".mesh", ".xdmf", ".med"])
def test_a_cube_of_quads(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"cube{suffix}"
    quad_cube(path)
    with pytest.warns(WctWarning, match=rf"cube\{suffix}: 6 quads split into triangles$"):
        surface = read(path)
    assert isinstance(surface, SurfaceMesh)
    assert len(surface.triangles) == 12
    assert volume(surface) == pytest.approx(1, rel=1e-14)
    if suffix in (".ply", ".vtu", ".vtk", ".xdmf", ".med"):
        assert np.ravel(surface.cell_data["id"]).tolist() == np.repeat(np.arange(6), 2).tolist()


def test_quads_triangles_and_polygons_of_one_file_are_counted(tmp_path: Path) -> None:
    ring = "".join(f"v {np.cos(a)} {np.sin(a)} {z}\n" for z in (0, 1) for a in np.arange(5) * 2 * np.pi / 5)
    sides = "".join(f"f {k + 1} {(k + 1) % 5 + 1} {(k + 1) % 5 + 6} {k + 6}\n" for k in range(4))
    sides += "f 5 1 6\nf 5 6 10\n"
    (tmp_path / "prism.obj").write_text(ring + sides + "f 5 4 3 2 1\nf 6 7 8 9 10\n")
    with pytest.warns(WctWarning, match=r"4 quads and 2 polygons split into triangles$"):
        surface = read(tmp_path / "prism.obj")
    assert isinstance(surface, SurfaceMesh)
    assert len(surface.triangles) == 16
    assert volume(surface) == pytest.approx(5 / 2 * np.sin(2 * np.pi / 5), rel=1e-14)


def test_the_shorter_diagonal_and_the_one_inside() -> None:
    kite = np.array([[0.0, 0, 0], [2, 1, 0], [0, 2, 0], [-2, 1, 0]])
    assert sorted(map(sorted, split(kite, np.array([[0, 1, 2, 3]]))[0].tolist())) == [[0, 1, 2], [0, 2, 3]]
    dart = np.array([[0.0, 0, 0], [1, 0.1, 0], [0, 2, 0], [0.9, 0.12, 0]])  # from 1 to 3 is short, and outside
    for turn in range(4):
        face = np.roll([0, 1, 2, 3], turn)[None]
        triangles = split(dart, face)[0]
        assert (areas(dart, triangles) @ [0, 0, 1] > 0).all()
        assert {1, 3} <= set(triangles[0].tolist()) & set(triangles[1].tolist())


@pytest.mark.parametrize("count", [4, 5, 7, 12, 30])
def test_polygons_that_are_not_convex(count: int) -> None:
    """All triangles are turned as the polygon and have its area together, wherever it lies in space."""
    random = np.random.default_rng(count)
    for _ in range(20):
        angles = 2 * np.pi * (np.arange(count) + 0.8 * random.random(count)) / count
        radii = 0.1 + random.random(count)
        flat = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
        area = np.sum(flat[:, 0] * np.roll(flat[:, 1], -1) - flat[:, 1] * np.roll(flat[:, 0], -1)) / 2
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        turn[:, 2] *= np.sign(np.linalg.det(turn))
        points = flat @ turn[:, :2].T
        parts = areas(points, split(points, np.arange(count)[None])[0]) @ turn[:, 2]
        assert (parts > 0).all()
        assert parts.sum() == pytest.approx(area, rel=1e-12)


def test_a_comb_has_no_ear_across_its_teeth() -> None:
    teeth = [(x + step, (step % 2) * 3.0) for x in range(0, 8, 2) for step in range(2)]
    outline = np.array([*[(x, y + 1) for x, y in teeth][::-1], (-1.0, -1), (9.0, -1)])
    points = np.column_stack([outline, np.zeros(len(outline))])
    x, y = outline.T
    area = np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2
    parts = areas(points, split(points, np.arange(len(points))[None])[0])[:, 2]
    assert (parts * np.sign(area) > 0).all()
    assert parts.sum() == pytest.approx(area, rel=1e-12)
