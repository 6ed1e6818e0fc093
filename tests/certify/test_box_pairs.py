"""Overlapping boxes against brute force."""

import numpy as np
import pytest

from wct_plugin.certify.box_pairs import overlapping


@pytest.mark.parametrize(("count", "other"), [(1, 1), (1, 7), (9, 1), (60, 200), (300, 300)])
@pytest.mark.parametrize("size", [0.0, 0.02, 0.3])
def test_all_pairs_and_no_others(count, other, size):
    rng = np.random.default_rng(count)
    corners = [np.round(rng.uniform(size=(k, 3)), 1 if size == 0.0 else 9) for k in (count, other)]
    sides = [rng.uniform(size=corner.shape) ** 4 * size for corner in corners]  # many small ones, a few large ones
    (low, high), (other_low, other_high) = ((c, c + s) for c, s in zip(corners, sides, strict=True))
    common = (low[:, None] <= other_high) & (other_low <= high[:, None])
    assert np.array_equal(overlapping(low, high, other_low, other_high), np.argwhere(common.all(axis=2)))


def test_boxes_that_touch_overlap_and_empty_lists_do_not():
    low, high = np.zeros((1, 3)), np.ones((1, 3))
    assert overlapping(low, high, high, high + 1).tolist() == [[0, 0]]
    assert overlapping(low, high, np.nextafter(high, 2), high + 1).tolist() == []
    assert overlapping(low[:0], high[:0], low, high).shape == (0, 2)
