"""Vertex and line cells without a tag that list the surface hold nothing; what is tagged or inside stays."""

import logging
from pathlib import Path

import meshio
import numpy as np
import pytest
from support.builders import kuhn_cube

import wct_plugin as wct
from wct_plugin.mesh import TetMesh


def read(path: Path, *extra: tuple[str, np.ndarray], **data: list[np.ndarray]) -> TetMesh:
    cube = kuhn_cube(2)
    meshio.Mesh(cube.points, [("tetra", cube.tets), *extra], cell_data=data).write(path)
    mesh = wct.read(path)
    assert isinstance(mesh, TetMesh)
    return mesh


def test_lists_of_the_boundary(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    cube = kuhn_cube(2)
    skin = np.unique(cube.topology.boundary)[:, None]
    edges = np.unique(np.sort(cube.topology.boundary[:, :2], axis=1), axis=0)
    with caplog.at_level(logging.INFO, "wct_plugin"):
        mesh = read(tmp_path / "a.vtu", ("vertex", skin), ("line", edges))
    assert (len(mesh.nodes), len(mesh.edges)) == (0, 0)
    path = tmp_path / "a.vtu"
    assert caplog.messages == [
        f"{path}: 26 untagged vertex cells only list the surface and are left out",
        f"{path}: {len(edges)} untagged line cells only list the surface and are left out",
    ]


def test_lists_of_all_there_is(tmp_path: Path) -> None:
    cube = kuhn_cube(2)
    mesh = read(tmp_path / "a.vtu", ("vertex", np.arange(27)[:, None]), ("line", cube.topology.edges))
    assert (len(mesh.nodes), len(mesh.edges)) == (0, 0)


def test_what_is_inside_or_tagged_stays(tmp_path: Path) -> None:
    inside = 13  # the only point that is not on the boundary
    cells = ("vertex", np.array([[0], [inside], [26]])), ("line", np.array([[0, 1], [inside, 26], [1, 2]]))
    mesh = read(tmp_path / "a.vtu", *cells)
    assert mesh.nodes.vertices.tolist() == [[inside]]
    assert mesh.edges.vertices.tolist() == [[inside, 26]]
    zeros = np.zeros(48, dtype=int)
    tags = {"gmsh:physical": [zeros, np.array([4, 0, 0]), np.array([0, 0, 8])]}
    mesh = read(tmp_path / "b.vtu", *cells, **tags)
    assert mesh.nodes.vertices.tolist() == [[0], [inside]]
    assert mesh.edges.vertices.tolist() == [[inside, 26], [1, 2]]
    mesh = read(tmp_path / "c.vtu", *cells, flux=[zeros * 0.5, np.ones(3), np.ones(3)])
    assert (len(mesh.nodes), len(mesh.edges)) == (3, 3)
