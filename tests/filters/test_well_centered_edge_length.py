"""The option edge_length of filters.meshing_well_centered, measured on the edges that come out."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import kuhn_cube, kuhn_grid
from support.domains import check_domain

from wct_plugin import apply_filter
from wct_plugin.core import _core
from wct_plugin.errors import OptionError
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.meshing import edge_length


def run(mesh, **options):
    return apply_filter("meshing_well_centered", mesh, **options)


def mean_edge(mesh, where=lambda x: x == x):
    ends = mesh.points[mesh.topology.edges]
    chosen = where(ends.mean(axis=1)[:, 0])
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)[chosen].mean()


def test_edges_become_as_long_as_asked():
    mesh = kuhn_cube(4)
    coarse, fine = (run(mesh, goal="3wc", edge_length=length)[0] for length in (0.3, 0.15))
    assert mean_edge(coarse) == pytest.approx(0.3, rel=0.15)
    assert mean_edge(fine) == pytest.approx(0.15, rel=0.15)
    check_domain(mesh, fine)


def test_edge_length_by_point_as_array_or_as_point_data():
    mesh = kuhn_cube(4)
    lengths = np.where(mesh.points[:, 0] < 0.5, 0.1, 0.3)
    better, _ = run(mesh, goal="3wc", edge_length=lengths)
    assert mean_edge(better, lambda x: x < 0.25) == pytest.approx(0.1, rel=0.2)
    assert mean_edge(better, lambda x: x > 0.75) > 0.18
    named, _ = run(replace(mesh, point_data={"h": lengths}), goal="3wc", edge_length="h")
    assert np.array_equal(named.points, better.points)


def two_regions():
    """A column of 1 x 1 x 4, of which the lowest quarter is oxide."""
    grid = kuhn_grid((2, 2, 8))
    mesh = TetMesh(grid.points / 2.0, grid.tets, 1 + (grid.points[grid.tets].mean(axis=1)[:, 2] > 2.0))
    return replace(
        mesh, names={"oxide": (1, 3), "silicon": (2, 3)}, tet_sets={"upper": np.flatnonzero(mesh.regions > 1)}
    )


def mean_edge_in(mesh, tag, where):
    """Of the distinct edges of a region's tets, those whose middles are ``where`` along z."""
    pairs = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    edges = np.unique(np.sort(mesh.tets[mesh.regions == tag][:, pairs].reshape(-1, 2), axis=1), axis=0)
    ends = mesh.points[edges]
    chosen = where(ends.mean(axis=1)[:, 2])
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)[chosen].mean()


@pytest.mark.parametrize("wanted", [{"oxide": 0.2, "*": 0.35}, "oxide=0.2,silicon=0.35", {"1": 0.2, "upper": 0.35}])
def test_edge_length_by_region(wanted):
    mesh = two_regions()
    better, _ = run(mesh, goal="3wc", edge_length=wanted)
    assert mean_edge_in(better, 1, lambda z: z < 1.0) == pytest.approx(0.2, rel=0.15)
    assert mean_edge_in(better, 2, lambda z: z < 1.15) == pytest.approx(0.2, rel=0.15)  # of both, the smaller
    assert mean_edge_in(better, 2, lambda z: z > 2.0) == pytest.approx(0.35, rel=0.15)
    check_domain(mesh, better)


def test_edge_length_on_a_group_of_facets():
    mesh = kuhn_cube(4)
    facets = mesh.topology.boundary
    top = facets[(mesh.points[facets][:, :, 2] == 1.0).all(axis=1)]
    mesh = replace(mesh, facets=Cells(top, np.full(len(top), 7)), names={"contact": (7, 2)})
    better, _ = run(mesh, goal="3wc", edge_length="contact=0.08,*=0.3")
    ends = better.points[better.topology.edges]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    assert length[(ends[:, :, 2] == 1.0).all(axis=1)].mean() == pytest.approx(0.08, rel=0.15)
    assert length[(ends[:, :, 2] < 0.4).all(axis=1)].mean() > 0.18


def test_what_no_group_names_has_the_meshs_own_lengths():
    """Kuhn's tets of cells of 1/2: as many per volume as a lattice of cells of (12 / 6)^(1/3) / 2 has."""
    mesh = two_regions()
    lengths = edge_length.at_points(edge_length.parse("oxide=0.08"), mesh)
    z = mesh.points[:, 2]
    assert (lengths[z <= 1.0] == 0.08).all()
    assert lengths[z > 1.0] == pytest.approx(1.05 * 2 ** (1 / 3) / 2)


def test_a_point_of_several_groups_takes_the_smallest_length_and_facets_go_before_the_rest():
    mesh = two_regions()
    facets = mesh.topology.boundary
    side = facets[(mesh.points[facets][:, :, 0] == 0.0).all(axis=1)]
    mesh = replace(mesh, facets=Cells(side, np.full(len(side), 5)), names={**mesh.names, "side": (5, 2)})
    lengths = edge_length.at_points({"oxide": 0.3, "side": 0.4, "*": 0.2}, mesh)
    x, z = mesh.points[:, 0], mesh.points[:, 2]
    assert (lengths[z < 1.0] == 0.3).all()
    assert (lengths[(z == 1.0) & (x > 0)] == 0.2).all()
    assert (lengths[(z > 1.0) & (x == 0)] == 0.4).all()
    assert (lengths[(z > 1.0) & (x > 0)] == 0.2).all()


def test_a_kept_boundary_is_given_the_edge_length_too(monkeypatch):
    mesh = kuhn_cube(2)
    searched = []

    def search(start, *_):
        searched.append(start.size[start.stratum > 0])
        raise KeyboardInterrupt

    monkeypatch.setattr(_core, "search_well_centered", search)
    lengths = np.full(len(mesh.points), 0.15)
    for boundary in ("keep", "fixed"):
        with pytest.raises(KeyboardInterrupt):
            run(mesh, boundary=boundary, edge_length=lengths)
    assert all(size == pytest.approx(0.15, rel=0.1) for size in searched)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ({"oxyde": 1.0}, r"names 'oxyde', which is no region or group of facets of the mesh \(there: '0'"),
        ("a=1,b", "must be NAME=VALUE,NAME=VALUE; 'b' is no NAME=VALUE"),
        ("a=1,a=2", "says twice what 'a' is"),
        ({"a": 0}, "says 0 of 'a'; a number greater than 0 and finite is needed"),
        ("a=long", "says 'long' of 'a'; a number greater than 0"),
        ({}, "names no region or group"),
        (-1.0, "option 'edge_length' is -1.0; input should be greater than 0 and finite"),
        ("nan", "option 'edge_length' is 'nan'; input should be greater than 0 and finite"),
        ([0.1, 0.2, -3], r"option 'edge_length' is \[0.1, 0.2, -3\]; holds -3 at index 2; all must be positive"),
        (np.append(np.ones(5000), np.inf), "holds inf at index 5000; all must be positive and finite"),
        (np.ones(5), r"option 'edge_length' has shape \(5,\); the mesh needs \(27,\), one per point"),
        ([[0.1]], "must be a number, an array of one per point, the name of point data, or a number per region"),
        (True, "must be a number, an array of one per point, the name of point data, or a number per region"),
        ("height", "is 'height'; it must be a number or one of the mesh's point data: 'h', 'v', 's'$"),
        ("h", "point data 'h' holds 0 at index 4; all must be positive and finite"),
        ("v", r"point data 'v' has shape \(27, 3\); the mesh needs \(27,\), one per point"),
        ("s", "point data 's' has type <U1; numbers are needed"),
    ],
)
def test_edge_lengths_of_no_use_are_refused(value, message):
    mesh = kuhn_cube(2)
    data = {"h": np.arange(27.0)[::-1] - 22.0, "v": mesh.points, "s": np.full(27, "x")}
    data["h"][:4] = 1.0
    with pytest.raises(OptionError, match=message) as caught:
        run(replace(mesh, point_data=data), edge_length=value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 250
