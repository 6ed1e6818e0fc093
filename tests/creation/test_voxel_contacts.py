"""Where voxels touch without a common face, against the surface round them taken apart square by square."""

from collections import defaultdict
from itertools import product

import numpy as np
import pytest

from wct_plugin.creation.voxel_contacts import pinch


def surface_is_a_manifold(solid):
    """Two squares at each edge of the surface, and those round each vertex in one ring, by definition."""
    padded = np.pad(solid, 1)
    squares = []  # each as its four corners in order
    for axis in range(3):
        u, v = (np.eye(3, dtype=int)[k] for k in range(3) if k != axis)
        for at in map(np.array, product(*(range(1, size) for size in padded.shape))):
            if padded[tuple(at)] != padded[tuple(at - np.eye(3, dtype=int)[axis])]:
                squares.append([tuple(at + step) for step in (0 * u, u, u + v, v)])
    edges, round_vertex = defaultdict(list), defaultdict(list)
    for number, square in enumerate(squares):
        for k in range(4):
            edges[frozenset((square[k], square[k - 1]))].append(number)
            round_vertex[square[k]].append(number)
    if any(len(found) != 2 for found in edges.values()):
        return False
    for vertex, found in round_vertex.items():
        ring, ahead = {found[0]}, [found[0]]
        while ahead:
            one = ahead.pop()
            for edge in (
                e for e in map(frozenset, zip(squares[one], squares[one][1:] + squares[one][:1], strict=True))
            ):
                if vertex in edge:
                    ahead += [other for other in edges[edge] if other not in ring]
                    ring.update(edges[edge])
        if ring != set(found):
            return False
    return True


def test_refused_if_and_only_if_the_surface_is_no_manifold():
    rng = np.random.default_rng(5)
    verdicts = []
    for share in np.linspace(0.1, 0.95, 150):
        solid = rng.random((3, 3, 2)) < share
        if solid.any():
            verdicts.append(surface_is_a_manifold(solid))
            assert (pinch(solid) is None) == verdicts[-1]
    assert 20 < sum(verdicts) < len(verdicts) - 20


@pytest.mark.parametrize(
    ("shape", "voxels", "message"),
    [
        ((4, 4, 4), [(1, 2, 3), (2, 3, 3)], "voxels (1, 2, 3) and (2, 3, 3) touch only along an edge"),
        ((4, 4, 4), [(0, 2, 1), (1, 1, 2)], "voxels (0, 2, 1) and (1, 1, 2) touch only at a vertex"),
        ((9, 1, 9), [(7, 0, 1), (8, 0, 0)], "voxels (7, 0, 1) and (8, 0, 0) touch only along an edge"),
    ],
)
def test_the_two_voxels_are_named(shape, voxels, message):
    solid = np.zeros(shape, dtype=bool)
    solid[tuple(np.transpose(voxels))] = True
    assert pinch(solid) == f"{message}; what touches must share a face"


def test_hollows_that_touch_at_a_vertex_are_named():
    solid = np.ones((4, 4, 4), dtype=bool)
    solid[1, 1, 1] = solid[2, 2, 2] = False
    assert pinch(solid).startswith("empty voxels (1, 1, 1) and (2, 2, 2) touch only at a vertex")


def test_a_way_round_at_the_end_of_an_edge_does_not_mend_it():
    """Both voxels are joined through faces round the end of their common edge, and still nothing joins them there."""
    solid = np.ones((2, 2, 2), dtype=bool)
    solid[0, 1, 0] = solid[1, 0, 0] = False
    assert pinch(solid) == "voxels (0, 0, 0) and (1, 1, 0) touch only along an edge; what touches must share a face"
