"""Bodies that touch in an edge alone: the joint stays, and both come right."""

from itertools import pairwise

import numpy as np
import pytest
from support.gmsh_bodies import joined_cubes

import wct_plugin as wct
from wct_plugin.measure import quality
from wct_plugin.measure.region_topology import measure_region_topology


def joint_length(mesh, low, high):
    """Of the edges on the line x = y = 1 that tets on both of its sides share, and the heights it lies between."""
    corners = mesh.points[mesh.tets].mean(axis=1)
    on = np.flatnonzero((mesh.points[:, :2] == 1.0).all(axis=1))
    of_first, of_second = (np.intersect1d(on, mesh.tets[side]) for side in (corners[:, 0] < 1, corners[:, 0] > 1))
    heights = np.sort(mesh.points[np.intersect1d(of_first, of_second), 2])
    assert (heights[0], heights[-1]) == (low, high)
    keys = {tuple(sorted(edge)) for edge in mesh.topology.edges.tolist()}
    order = on[np.argsort(mesh.points[on, 2])]
    return sum(
        mesh.points[b, 2] - mesh.points[a, 2]
        for a, b in pairwise(order)
        if tuple(sorted((a, b))) in keys and low <= mesh.points[a, 2] and mesh.points[b, 2] <= high
    )


@pytest.mark.parametrize(("shift", "low", "regions"), [((1.0, 1.0, 0.0), 0.0, 2), ((1.0, 1.0, 0.3), 0.3, 1)])
def test_two_cubes_that_share_an_edge(tmp_path, shift, low, regions):
    mesh = joined_cubes(tmp_path, shift, 0.34, regions=regions)
    out, metrics = wct.apply_filter("meshing_well_centered", mesh)
    measured = quality.measure(out)
    assert measured.completely_well_centered.all()
    assert metrics["losses"] == []
    assert np.array_equal(np.unique(out.regions), np.unique(mesh.regions))
    volumes = np.bincount(out.regions, measured.volume)[np.unique(out.regions)]
    assert volumes == pytest.approx([2.0] if regions == 1 else [1.0, 1.0], rel=1e-12)
    assert joint_length(out, low, 1.0) == pytest.approx(1.0 - low, rel=1e-12)


def test_pieces_of_one_region_keep_their_tag(tmp_path):
    mesh = joined_cubes(tmp_path, (1.0, 1.0, 0.0), 0.5, regions=1)
    before = measure_region_topology(mesh)["1"]
    assert (before["components"], before["joined_edges"] > 0) == (2, True)
    out, _ = wct.apply_filter("meshing_well_centered", mesh)
    after = measure_region_topology(out)["1"]
    assert (after["components"], after["joined_edges"] > 0) == (2, True)


def test_the_report_names_the_joint(tmp_path):
    report = wct.report(joined_cubes(tmp_path, (1.0, 1.0, 0.0), 0.25, regions=1))
    assert report.joints["edges"] > 0
    assert any(note.startswith(f"the boundary meets itself in {report.joints['edges']} edges") for note in report.notes)
    assert wct.report(joined_cubes(tmp_path, (1.0, 0.0, 0.0), 0.25, regions=1)).joints == {"edges": 0, "vertices": 0}
