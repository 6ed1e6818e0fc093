"""Sheets and wires moved by hand: how far they are from where they were, both ways, in closed form."""

import numpy as np
import pytest
from support.builders import kuhn_cube

from wct_plugin.measure.fidelity import measure_fidelity
from wct_plugin.measure.inner_deviation import measure_inner_deviation
from wct_plugin.mesh import Cells, TetMesh

_NO_FACETS, _NO_EDGES = (Cells(np.empty((0, corners), dtype=np.int64)) for corners in (3, 2))


def with_inner(*, shift: float = 0.0, size: float = 1.0, facets: bool = True, edges: bool = True) -> TetMesh:
    """A cube with a square sheet across part of its middle, and a wire of two edges; both can be moved."""
    cube = kuhn_cube(4)
    points = cube.points.copy()
    middle = np.flatnonzero((points[:, 2] == 0.5) & (np.abs(points[:, :2] - 0.5) <= 0.25).all(axis=1))
    topology = cube.topology
    inner = topology.facets[: len(topology.interior_pairs)]
    sheet = inner[np.isin(inner, middle).all(axis=1)]
    line = [int(np.flatnonzero((points == [0.75, 0.75, z]).all(axis=1))[0]) for z in (0.75, 1.0)]
    wire = [int(np.flatnonzero((points == [x, 0.25, 0.25]).all(axis=1))[0]) for x in (0.25, 0.5, 0.75)]
    points[middle, 2] += shift
    points[wire, 1] += shift
    rim = np.array([line, wire[:2], wire[1:]])
    return TetMesh(
        points * size,
        cube.tets,
        facets=Cells(np.vstack([topology.boundary[:1], sheet]), np.array([9] + [7] * len(sheet)))
        if facets
        else _NO_FACETS,
        edges=Cells(rim, np.array([3, 5, 5])) if edges else _NO_EDGES,
    )


@pytest.mark.parametrize("size", [1.0, 2.0**-300, 1e60])
def test_the_distance_of_what_was_moved(size):
    old, new = with_inner(size=size), with_inner(shift=0.01, size=size)
    diagonal = size * np.sqrt(3.0)
    found = measure_inner_deviation(old, new, diagonal)
    assert set(found) == {"tagged facets inside", "tagged edges inside"}
    assert found == pytest.approx(dict.fromkeys(found, 0.01 / np.sqrt(3.0)))
    assert max(measure_inner_deviation(old, old, diagonal).values()) < 1e-15


def test_what_is_cut_short_is_seen_from_the_other_side():
    old = with_inner()
    short = TetMesh(old.points, old.tets, edges=Cells(old.edges.vertices[:2], old.edges.tags[:2]))
    for one, other in ((old, short), (short, old)):
        found = measure_inner_deviation(one, other, 1.0)
        assert found == {"tagged edges inside": pytest.approx(0.25)}


def test_nothing_is_said_of_what_is_not_there_or_on_the_surface():
    assert measure_inner_deviation(with_inner(), with_inner(facets=False, edges=False), 1.0) == {}
    cube = kuhn_cube(2)
    shell = TetMesh(
        cube.points, cube.tets, facets=Cells(cube.topology.boundary, np.ones(len(cube.topology.boundary), int))
    )
    assert measure_inner_deviation(shell, shell, 1.0) == {}


def test_fidelity_has_it():
    old, new = with_inner(), with_inner(shift=0.02)
    assert measure_fidelity(old, new, None)["inside"] == measure_inner_deviation(old, new, np.sqrt(3.0))
