"""Which axis-parallel boxes overlap: two trees of boxes, walked down together, level by level, in NumPy."""

import numpy as np

from wct_plugin.types import Floats, Ints


def overlapping(low: Floats, high: Floats, other_low: Floats, other_high: Floats) -> Ints:
    """Pairs (k, 2) of a box of the first list (n, 3) and one of the second (m, 3) that have a point in common.

    Boxes are closed, so those that touch are among them. Rows ascend.
    """
    if not len(low) or not len(other_low):
        return np.empty((0, 2), dtype=np.int64)
    first = _Tree(low, high)
    second = first if low is other_low and high is other_high else _Tree(other_low, other_high)
    pairs = np.zeros((1, 2), dtype=np.int64)
    for level in range(max(first.levels, second.levels)):
        for side, tree in enumerate((first, second)):
            if 0 < level < tree.levels:  # a tree that has ended stays at its leaves
                pairs = np.repeat(pairs, 2, axis=0)
                pairs[:, side] *= 2
                pairs[1::2, side] += 1
        a_low, a_high = first.boxes(level, pairs[:, 0])
        b_low, b_high = second.boxes(level, pairs[:, 1])
        pairs = pairs[((a_low <= b_high) & (b_low <= a_high)).all(axis=1)]
    found = np.column_stack([first.order[pairs[:, 0]], second.order[pairs[:, 1]]])
    return found[np.lexsort(found.T[::-1])]


class _Tree:
    """A full binary tree over boxes in the order of a space-filling curve; filled up with empty ones."""

    def __init__(self, low: Floats, high: Floats) -> None:
        self.order = np.argsort(_along_curve(low / 2.0 + high / 2.0), kind="stable")
        leaves = 1 << (len(low) - 1).bit_length()
        bottom = np.full((2, leaves, 3), np.inf)
        bottom[1] = -np.inf
        bottom[0, : len(low)], bottom[1, : len(low)] = low[self.order], high[self.order]
        self._levels = [bottom]
        while self._levels[-1].shape[1] > 1:
            children = self._levels[-1]
            self._levels.append(
                np.stack(
                    [np.minimum(children[0, ::2], children[0, 1::2]), np.maximum(children[1, ::2], children[1, 1::2])]
                )
            )
        self._levels.reverse()  # the root first

    @property
    def levels(self) -> int:
        return len(self._levels)

    def boxes(self, level: int, nodes: Ints) -> tuple[Floats, Floats]:
        low, high = self._levels[min(level, self.levels - 1)]
        return low[nodes], high[nodes]


def _along_curve(centers: Floats) -> Ints:
    """Morton numbers of points (n, 3): the bits of the three coordinates interleaved, so that near points get near."""
    centers = centers / 2.0  # so that no extent overflows
    extent = np.ptp(centers, axis=0)
    cells = ((centers - centers.min(axis=0)) / np.where(extent > 0.0, extent, 1.0) * (2**21 - 1)).astype(np.int64)
    out = np.zeros(len(centers), dtype=np.int64)
    for bit in range(21):
        for axis in range(3):
            out |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return out
