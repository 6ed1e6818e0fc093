"""The arrays agree with the measures they are named after, and survive a file."""

import numpy as np
import pytest
from support.builders import bcc, jittered_cube

import wct_plugin as wct
from wct_plugin.measure import quality

FLAGS = ("is_3wc", "is_2wc", "is_cwc", "is_acute")


def test_arrays_and_counts():
    mesh = jittered_cube(5, 0)
    marked, metrics = wct.apply_filter("compute_scalar_by_well_centeredness", mesh)
    heights = quality.heights_over_radius(mesh.points, mesh.tets).min(axis=1)
    assert marked.cell_data["min_h_over_R"] == pytest.approx(heights)
    assert np.array_equal(marked.cell_data["is_3wc"] == 1, heights > 0)
    assert metrics == {name.removeprefix("is_"): int(marked.cell_data[name].sum()) for name in FLAGS}
    assert marked.point_data["dual_volume"].sum() == pytest.approx(1.0)
    assert not mesh.cell_data
    assert not mesh.point_data


def test_one_sided_where_the_tiling_is():
    """In Sommerville's tiling every dual edge is as long as the others: h+ + h- = 2 * .3162 R."""
    mesh = bcc(3)
    marked, _ = wct.apply_filter("compute_scalar_by_well_centeredness", mesh)
    inside = (mesh.topology.adjacency >= 0).all(axis=1)
    heights = quality.heights_over_radius(mesh.points, mesh.tets) * quality.circumradii(mesh.points, mesh.tets)[:, None]
    assert inside.any()
    assert marked.cell_data["min_dual_length"][inside] == pytest.approx(2 * heights[inside].min(axis=1))


def test_survives_a_file(tmp_path):
    marked, _ = wct.apply_filter("compute_scalar_by_well_centeredness", jittered_cube(4, 0))
    wct.write(tmp_path / "marked.vtu", marked)
    again = wct.read(tmp_path / "marked.vtu")
    for name, values in marked.cell_data.items():
        assert np.array_equal(again.cell_data[name], values)
