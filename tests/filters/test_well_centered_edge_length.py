"""The option edge_length of filters.meshing_well_centered, measured on the edges that come out."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import kuhn_cube
from support.domains import check_domain

from wct_plugin import apply_filter
from wct_plugin.core import _core
from wct_plugin.errors import OptionError


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


def test_a_kept_boundary_is_given_the_edge_length_too(monkeypatch):
    mesh = kuhn_cube(2)
    searched = []

    def search(**given):
        searched.append(given["size"][given["stratum"] > 0])
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
        (-1.0, "option 'edge_length' is -1.0; input should be greater than 0 and finite"),
        ("nan", "option 'edge_length' is 'nan'; input should be greater than 0 and finite"),
        ([0.1, 0.2, -3], r"option 'edge_length' is \[0.1, 0.2, -3\]; holds -3 at index 2; all must be positive"),
        (np.append(np.ones(5000), np.inf), "holds inf at index 5000; all must be positive and finite"),
        (np.ones(5), r"option 'edge_length' has shape \(5,\); the mesh needs \(27,\), one per point"),
        ([[0.1]], "must be a number, an array of one per point, or the name of point data"),
        (True, "must be a number, an array of one per point, or the name of point data"),
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
