"""Surfaces with holes, with sheets inside the body or both, put together to bound a mesh, or not taken."""

import re
from dataclasses import replace

import numpy as np
import pytest
from support.builders import ball, kuhn_cube, kuhn_grid, rotation, sphere_surface

from wct_plugin.adapters.solid_surface import shells
from wct_plugin.errors import WctWarning
from wct_plugin.measure.deviation import distances, measure_deviation
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.strata import surface_strata
from wct_plugin.meshing import reference_repair
from wct_plugin.meshing.reference import own_boundary
from wct_plugin.meshing.reference_fit import clean
from wct_plugin.meshing.reference_repair import composite

CLOSED = r"^the reference has holes, which were closed: up to (\S+) of the diagonal from the mesh's own facets$"
BOX = kuhn_cube(4).boundary_surface()


def made(surface, mesh, tolerance=1e-9):
    return composite(clean(surface), mesh, own_boundary(mesh, 40.0), tolerance)


def together(*surfaces):
    start = np.cumsum([0, *(len(one.points) for one in surfaces)])
    triangles = [one.triangles + first for one, first in zip(surfaces, start[:-1], strict=True)]
    return SurfaceMesh(np.concatenate([one.points for one in surfaces]), np.concatenate(triangles))


def without(surface, gone):
    """The triangles whose centroids are not ``gone``."""
    keep = ~gone(surface.points[surface.triangles].mean(axis=1))
    return SurfaceMesh(surface.points, surface.triangles[keep], surface.tags[keep])


def window(centers):
    return (centers[:, 2] > 1 - 1e-9) & (np.abs(centers[:, :2] - 0.5).max(axis=1) < 0.25)


def crease_length(surface):
    ends = surface.points[surface_strata(surface, 40.0).segments]
    return np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).sum()


def assert_bounds(surface, mesh, off=1e-9):
    """By the solid angle under which the surface is seen from inside each tet, by volume and by distance."""
    pieces = shells(surface.points, surface.triangles)
    assert sum(len(piece.corners) for piece in pieces) == len(surface.triangles)  # all closed and of one side
    boundary = mesh.boundary_surface()
    assert measure_deviation(surface, boundary).max <= off
    inside = mesh.points[mesh.tets].mean(axis=1)
    assert all(sum(piece.encloses(point) for piece in pieces) == 1 for point in inside[::7])
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    around = np.random.default_rng(0).uniform(low, high, (200, 3))
    clear = around[distances(around, boundary) > 2 * off]
    corners = mesh.points[mesh.tets]
    for point in clear:
        weights = np.linalg.solve(
            np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2), (point - corners[:, 0])[..., None]
        )[..., 0]
        within = ((weights >= -1e-12).all(axis=1) & (weights.sum(axis=1) <= 1 + 1e-12)).any()
        assert sum(piece.encloses(point) for piece in pieces) == within


def face(centers):
    """Which side of the unit cube."""
    return np.select([np.abs(centers[:, k] - at) < 1e-9 for k in range(3) for at in (0.0, 1.0)], [1, 2, 3, 4, 5, 6])


def test_a_window_is_closed_without_a_seam_and_tagged_as_what_is_round_it():
    turn = rotation(1)
    mesh, tagged = kuhn_cube(5), replace(BOX, tags=face(BOX.points[BOX.triangles].mean(axis=1)))
    mesh, opened = (replace(one, points=one.points @ turn.T) for one in (mesh, without(tagged, window)))
    with pytest.warns(WctWarning, match=CLOSED) as said:
        surface = made(opened, mesh)
    assert float(re.match(CLOSED, str(said[0].message))[1]) < 1e-9
    assert_bounds(surface, mesh)
    rows = {tuple(row) for row in surface.points.tolist()}
    assert rows >= {tuple(row) for row in opened.points[np.unique(opened.triangles)].tolist()}
    assert np.array_equal(surface.tags, face(surface.points[surface.triangles].mean(axis=1) @ turn))
    assert crease_length(surface) == pytest.approx(12.0, rel=1e-9)
    assert surface_strata(surface, 40.0).patch.max() == 5


def corner_boxes(n):
    """Boxes [0, 2]^3, in cells of 2 / n, and [1, 3]^3 as one surface, and the mesh of what is in either."""
    one, other = kuhn_grid((n, n, n)).boundary_surface(), kuhn_grid((2, 2, 2)).boundary_surface()
    mesh = kuhn_grid((3, 3, 3), lambda centers: (centers < 2).all(axis=1) | (centers > 1).all(axis=1))
    return together(replace(one, points=one.points * 2 / n), replace(other, points=other.points + 1.0)), mesh


def test_crossing_boxes_become_one():
    """All edges of either box, less those inside the other, and the hexagon where they cross."""
    both, mesh = (replace(one, points=one.points @ rotation(2).T) for one in corner_boxes(2))
    surface = made(both, mesh)
    assert_bounds(surface, mesh)
    assert crease_length(surface) == pytest.approx(2 * (24 - 3) + 6, rel=1e-9)
    assert surface_strata(surface, 40.0).patch.max() == 11


def test_a_hole_in_one_of_two_crossing_boxes():
    both, mesh = corner_boxes(3)
    opened = without(both, lambda centers: np.abs(centers - [1.0, 1.0, 0.0]).max(axis=1) < 0.3)
    assert len(opened.triangles) == len(both.triangles) - 2
    with pytest.warns(WctWarning, match=CLOSED):
        assert_bounds(made(opened, mesh), mesh)


def test_the_fill_of_a_round_body_bends_on_smoothly():
    mesh, whole = ball(6), sphere_surface(2000)
    opened = without(whole, lambda centers: centers[:, 2] > 0.97)
    with pytest.warns(WctWarning, match=CLOSED) as said:
        surface = made(opened, mesh, 0.04)
    assert crease_length(surface) == 0.0
    assert measure_deviation(surface, whole).max < 0.03  # the cap is so high
    new = surface.points[distances(surface.points, opened) > 1e-6]
    farthest = distances(new, mesh.boundary_surface()).max()
    assert float(re.match(CLOSED, str(said[0].message))[1]) * opened.diagonal >= 0.99 * farthest > 0.005
    assert made(opened, mesh, 0.005) is None


def crumpled(n):
    """The unit cube with pits in the middle of its lid, where every second tet is missing."""
    cube = kuhn_cube(n)
    at_lid = (cube.points[cube.tets][:, :, 2] == 1.0).sum(axis=1) == 3
    cell = np.floor(cube.points[cube.tets].mean(axis=1) * n).astype(int)
    middle = window(np.column_stack([(cell[:, :2] + 0.5) / n, np.ones(len(cell))]))
    upper = cube.points[cube.tets].mean(axis=1) * n - cell
    pit = at_lid & middle & (cell[:, :2].sum(axis=1) % 2 == 0) & (upper[:, 0] > upper[:, 1])
    return TetMesh(cube.points, cube.tets[~pit]), int(pit.sum())


def test_a_crumpled_fill_is_made_smooth_and_a_shape_kept():
    """Pits that the mesher left in a hole are none of the shape's; one bump all over a hole may be."""
    mesh, pits = crumpled(8)
    assert pits >= 5
    opened = without(BOX, window)
    with pytest.warns(WctWarning, match=CLOSED) as said:
        surface = made(opened, mesh)
    assert_bounds(surface, kuhn_cube(8))
    assert crease_length(surface) == pytest.approx(12.0, rel=1e-9)
    deepest = distances(mesh.boundary_surface().points, BOX).max()
    assert float(re.match(CLOSED, str(said[0].message))[1]) * BOX.diagonal == pytest.approx(deepest, rel=1e-2)
    flat = kuhn_cube(8)
    raised = replace(flat, points=flat.points + np.outer(window(flat.points), [0.0, 0.0, 0.02]))
    assert made(opened, raised) is None


def test_holes_are_judged_together():
    """A mesher that crumples one hole has not made a shape in the next, where it happened to leave one bump."""
    mesh, _ = crumpled(8)
    upside = replace(mesh, points=[0.0, 0.0, 1.0] + mesh.points * [1.0, 1.0, -1.0], tets=mesh.tets[:, ::-1])
    bump = np.outer(window(upside.points), [0.0, 0.0, 0.02])
    opened = without(BOX, lambda centers: window(centers) | window([0.0, 0.0, 1.0] + centers * [1.0, 1.0, -1.0]))
    with pytest.warns(WctWarning, match=CLOSED):
        surface = made(opened, replace(upside, points=upside.points + bump))
    assert_bounds(surface, kuhn_cube(8))
    flat = kuhn_cube(8)
    assert made(opened, replace(flat, points=flat.points + np.outer(window(flat.points), [0.0, 0.0, 0.02]))) is None


def plate(n):
    """1 x 1 x .2, n x n cells and one layer."""
    grid = kuhn_grid((n, n, 1))
    return TetMesh(grid.points * [1 / n, 1 / n, 0.2], grid.tets)


def test_a_body_with_another_handle_is_not_taken():
    """A plate with a drilled hole that the mesh has not, so thin a plate that no wall of it is far from the mesh."""
    grid = kuhn_grid((5, 5, 1), lambda centers: (np.abs(centers[:, :2] - 2.5) > 0.5).any(axis=1))
    drilled = TetMesh(grid.points * 0.2, grid.tets)
    opened = replace(drilled.boundary_surface(), triangles=drilled.boundary_surface().triangles[1:], tags=None)
    assert made(opened, plate(2)) is None
    with pytest.warns(WctWarning, match=CLOSED):
        assert made(opened, drilled) is not None


def test_a_fill_apart_from_the_mesh_is_not_taken():
    half = without(sphere_surface(2000), lambda centers: centers[:, 2] > 0.0)
    assert made(half, ball(5)) is None


def test_pieces_apart_from_the_boundary_go(monkeypatch):
    """One inside, open and with its sides turned, and one outside; nothing is left to ask MeshLab for."""
    monkeypatch.setattr(reference_repair.meshlab, "run", lambda *_: pytest.fail("MeshLab was asked"))
    mesh = kuhn_cube(4)
    inner = SurfaceMesh(0.4 + 0.2 * BOX.points, BOX.triangles[5:, ::-1])
    surface = made(together(inner, BOX, SurfaceMesh(BOX.points + 3.0, BOX.triangles)), mesh)
    assert_bounds(surface, mesh)


def test_what_is_not_there_asks_nobody(monkeypatch):
    monkeypatch.setattr(reference_repair.meshlab, "run", lambda *_: pytest.fail("MeshLab was asked"))
    assert made(sphere_surface(100, 5.0), kuhn_cube(2)) is None


@pytest.mark.parametrize(
    ("mesh", "wanted"),
    [
        (kuhn_cube(2), 2),
        (kuhn_grid((3, 3, 1), lambda centers: (np.abs(centers[:, :2] - 1.5) > 0.5).any(axis=1)), 0),
        (kuhn_grid((3, 3, 3), lambda centers: (np.abs(centers - 1.5) > 0.5).any(axis=1)), 4),
        (kuhn_grid((2, 2, 2), lambda centers: np.ptp(centers, axis=1) == 0), 4),
        (kuhn_grid((2, 2, 1), lambda centers: np.ptp(centers[:, :2], axis=1) == 0), 4),
    ],
    ids=["ball", "ring", "shell", "two that touch at a point", "two that touch along an edge"],
)
def test_euler_characteristic_of_the_boundary(mesh, wanted):
    assert reference_repair._boundary_characteristic(mesh) == wanted
