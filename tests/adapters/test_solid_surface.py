"""What is checked of a surface before it is filled, on cubes."""

import itertools

import numpy as np
import pytest
from support.builders import sphere_surface

from wct_plugin.adapters import solid_surface
from wct_plugin.errors import InputError
from wct_plugin.mesh import SurfaceMesh

CORNERS = np.array(list(itertools.product((0.0, 1.0), repeat=3)))
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
FACES = np.array([face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))])


def test_weld_takes_each_place_once_and_keeps_the_triangles() -> None:
    soup = SurfaceMesh(CORNERS[FACES].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    points, triangles = solid_surface.weld(soup)
    assert len(points) == 8
    assert (points[triangles] == CORNERS[FACES]).all()
    signed = SurfaceMesh([[0.0, 0, 0], [-0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 3], [1, 3, 4]])
    assert len(solid_surface.weld(signed)[0]) == 4


def test_weld_names_what_is_wrong() -> None:
    with pytest.raises(InputError, match=r"^a: triangle 12 has two corners at \(0, 0, 1\); its three corners"):
        solid_surface.weld(SurfaceMesh(CORNERS, np.vstack([FACES, [[0, 1, 1]]]), source="a"))
    with pytest.raises(
        InputError, match=r"^triangle 12 repeats triangle 3, at \(1, 0\.333333, 0\.666667\) \(and 1 more"
    ):
        solid_surface.weld(SurfaceMesh(CORNERS, np.vstack([FACES, FACES[3:5, [2, 1, 0]]])))


def test_the_open_edge() -> None:
    assert solid_surface.open_edge(CORNERS, FACES) is None
    assert solid_surface.open_edge(CORNERS, FACES[1:]) == (
        "the edge from (0, 0, 0) to (0, 0, 1) is a side of triangle 4 only (and 2 more)"
    )


def test_flat_pieces_of_a_cube_are_its_faces_and_end_at_tags() -> None:
    assert solid_surface.flat_pieces(CORNERS, FACES, np.zeros(12)).tolist() == np.repeat(np.arange(6), 2).tolist()
    assert len(np.unique(solid_surface.flat_pieces(CORNERS, FACES, np.array([0, 1] + [0] * 10)))) == 7
    bent = CORNERS.copy()
    bent[0, 0] = -1e-300  # a corner of one face of each direction, moved along x: the two faces along x stay flat
    assert len(np.unique(solid_surface.flat_pieces(bent, FACES, np.zeros(12)))) == 7


def test_a_sphere_has_no_flat_pieces() -> None:
    ball = sphere_surface(200)
    assert len(np.unique(solid_surface.flat_pieces(ball.points, ball.triangles, ball.tags))) == len(ball.triangles)


def test_shells_and_cavities() -> None:
    def place(size: float) -> np.ndarray:
        return 0.5 + size * (CORNERS - 0.5)

    middle, between, near = np.full(3, 0.5), np.array([0.5, 0.5, 0.85]), np.array([0.5, 0.5, 0.63])
    points = np.vstack([place(1.0), place(0.6), place(0.2)])
    hollow = np.vstack([FACES, FACES[:, ::-1] + 8, FACES + 16])
    walls = solid_surface.shells(points, hollow)
    assert sorted(wall.volume for wall in walls) == pytest.approx([-0.216, 0.008, 1.0])
    assert [solid_surface.in_cavity(point, walls) for point in (middle, near, between, middle + 3)] == [
        False,
        True,
        False,
        False,
    ]
    assert not any(
        solid_surface.in_cavity(near, solid_surface.shells(points, faces))
        for faces in (FACES, np.vstack([FACES, FACES + 8]))
    )


def test_what_is_no_shell() -> None:
    turned = np.vstack([FACES[:1, ::-1], FACES[1:]])
    wall = np.vstack([FACES, [[0, 1, 7]], [[0, 7, 6]]])
    assert [len(solid_surface.shells(CORNERS, faces)) for faces in (FACES, FACES[1:], turned, wall)] == [1, 0, 0, 0]
