"""What mmg calls required stays to the bit: facets, edges and vertices in sets of these names."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from support.builders import jittered_cube, kuhn_cube

import wct_plugin as wct
from wct_plugin.errors import WctWarning
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.meshing import required_cells

CUBE = jittered_cube(4)


def shaken_inside(mesh: TetMesh) -> TetMesh:
    """Points inside moved by up to .2 of an edge: the tets are not Delaunay any more."""
    inside = ((mesh.points > 0) & (mesh.points < 1)).all(axis=1)
    shift = np.random.default_rng(1).uniform(-0.05, 0.05, mesh.points.shape)
    return TetMesh(mesh.points + np.where(inside[:, None], shift, 0.0), mesh.tets)


NOT_DELAUNAY = shaken_inside(kuhn_cube(4))


def volume(mesh: TetMesh) -> float:
    return float(np.linalg.det(mesh.points[mesh.tets[:, 1:]] - mesh.points[mesh.tets[:, :1]]).sum() / 6)


def cells_of(mesh: TetMesh, cells: np.ndarray) -> set[tuple[tuple[float, ...], ...]]:
    return {tuple(sorted(map(tuple, one))) for one in mesh.points[cells].tolist()}


def with_facets(mesh: TetMesh) -> TetMesh:
    """Facets of a quarter of the top are required; all facets are listed."""
    boundary = mesh.topology.boundary
    at = mesh.points[boundary]
    rows = np.flatnonzero((at[:, :, 2] == 1).all(axis=1) & (at.mean(axis=1)[:, :2] < 0.5).all(axis=1))
    return replace(mesh, facets=Cells(boundary, None, {}, {"RequiredTriangles": rows}))


def with_edges(mesh: TetMesh) -> TetMesh:
    """A line of edges across the bottom is required."""
    edges = mesh.topology.edges
    at = mesh.points[edges]
    line = (at[:, :, 2] == 0).all(axis=1) & (np.abs(at[:, :, 0] - 0.5) < 0.2).all(axis=1)
    line &= (np.ptp(at[:, :, 0], axis=1) < 0.15) & (np.ptp(at[:, :, 1], axis=1) > 0.1)
    rows = edges[line]
    return replace(mesh, edges=Cells(rows, None, {}, {"RequiredEdges": np.arange(len(rows))}))


def with_vertices(mesh: TetMesh) -> TetMesh:
    """Two points inside and one on a side are required."""
    inside = np.flatnonzero(((mesh.points > 0.1) & (mesh.points < 0.9)).all(axis=1))[:2]
    side = np.flatnonzero(
        (mesh.points[:, 0] == 0) & (mesh.points[:, 1:] > 0.1).all(axis=1) & (mesh.points[:, 1:] < 0.9).all(axis=1)
    )
    rows = np.append(inside, side[0])[:, None]
    return replace(mesh, nodes=Cells(rows, None, {}, {"RequiredVertices": np.arange(3)}))


CASES = {
    "RequiredTriangles": (with_facets, "facets"),
    "RequiredEdges": (with_edges, "edges"),
    "RequiredVertices": (with_vertices, "nodes"),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("goal", ["3wc", "delaunay"])
def test_what_is_required_comes_back_to_the_bit(name: str, goal: str) -> None:
    build, where = CASES[name]
    mesh = build(CUBE if goal == "3wc" else NOT_DELAUNAY)
    with warnings.catch_warnings():
        warnings.simplefilter("error", WctWarning)
        options = {"force": True} if goal == "3wc" else {}
        out, found = wct.apply_filter("meshing_well_centered", mesh, goal=goal, **options)
    before, after = getattr(mesh, where), getattr(out, where)
    rows = before.sets[name]
    assert len(rows) > 2
    assert cells_of(out, after.vertices[after.sets[name]]) == cells_of(mesh, before.vertices[rows])
    if where == "edges":
        assert cells_of(mesh, before.vertices[rows]) <= cells_of(out, out.topology.edges)
    if where == "nodes":
        assert {tuple(point) for point in mesh.points[before.vertices[:, 0]]} <= {tuple(point) for point in out.points}
    assert len(out.tets) != len(mesh.tets) or not np.array_equal(out.tets, mesh.tets)
    assert goal == "3wc" or found["bad"] == 0 or where == "facets"  # right-angled facets that stay leave it no choice
    assert volume(out) == pytest.approx(volume(mesh), rel=1e-12)


def test_other_words_for_the_set_free_its_facets() -> None:
    mesh = with_facets(CUBE)
    assert required_cells.boundary_of("move", mesh) == {"RequiredTriangles": "fixed", "*": "move"}
    assert required_cells.boundary_of("keep", mesh) == {"RequiredTriangles": "fixed", "*": "keep"}
    assert required_cells.boundary_of("fixed", mesh) == "fixed"
    own = {"RequiredTriangles": "move", "*": "move"}
    assert required_cells.boundary_of(own, mesh) == own
    assert required_cells.boundary_of("move", CUBE) == "move"
    out, _ = wct.apply_filter("meshing_well_centered", mesh, goal="3wc", force=True, boundary=own)
    facets = out.facets.vertices[out.facets.sets["RequiredTriangles"]]
    assert cells_of(out, facets) != cells_of(mesh, mesh.facets.vertices[mesh.facets.sets["RequiredTriangles"]])


def test_edges_that_are_gone_are_counted() -> None:
    mesh = with_edges(CUBE)
    other = jittered_cube(3)
    count = len(mesh.edges)
    with pytest.warns(
        WctWarning, match=f"{count} of {count} edges of the set 'RequiredEdges' are not edges of the new mesh"
    ):
        required_cells.check_edges(mesh, other)


def test_where_only_vertices_move_those_of_required_facets_and_edges_stay() -> None:
    for name, (build, where) in CASES.items():
        mesh = build(CUBE)
        out, _ = wct.apply_filter("apply_coord_well_centering", mesh, goal="3wc")
        cells = getattr(mesh, where)
        used = np.unique(cells.vertices[cells.sets[name]])
        assert np.array_equal(out.points[used], mesh.points[used])
        assert not np.array_equal(out.points, mesh.points)
