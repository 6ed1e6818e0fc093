"""What must be kept is measured, and what was not is named: shapes made by hand that lose one thing each."""

from itertools import combinations

import numpy as np
import pytest
from support.builders import kuhn_cube, two_region_cube

from wct_plugin.core import _core
from wct_plugin.measure.conserved import measure_groups, measure_sharp, sharp_length
from wct_plugin.measure.fidelity import measure_fidelity
from wct_plugin.measure.losses import find_losses
from wct_plugin.measure.region_topology import changes, measure_region_topology
from wct_plugin.mesh import Cells, TetMesh

KEPT = {"creases": 0, "length": 0.0}


def losses(old, new, *, released=KEPT, sides=None, allow_released=False, tolerance=1e-3, names=None):
    return find_losses(
        measure_fidelity(old, new, None),
        measure_groups(old, new, {}),
        measure_sharp([(old.points, old.topology.boundary)], (new.points, new.topology.boundary), 40.0),
        (measure_region_topology(old), measure_region_topology(new)),
        released,
        sides,
        allowed=tolerance,
        allow_released=allow_released,
        names=names or {},
    )


def without(mesh, where):
    """The mesh without the tets whose centroids are there."""
    return TetMesh(mesh.points, mesh.tets[~where(mesh.points[mesh.tets].mean(axis=1))])


def test_the_same_mesh_loses_nothing():
    mesh = two_region_cube(3)
    assert losses(mesh, mesh) == []


def test_a_wire_that_left_its_place():
    old = kuhn_cube(4)
    wire = np.array([[int(np.flatnonzero((old.points == [x, 0.5, 0.5]).all(axis=1))[0]) for x in (0.25, 0.5)]])
    moved = old.points.copy()
    moved[wire, 1] += 0.01
    one, other = (TetMesh(points, old.tets, edges=Cells(wire, np.array([4]))) for points in (old.points, moved))
    (loss,) = losses(one, other)
    assert loss["kind"] == "deviation"
    assert loss["name"] == "tagged edges inside"
    assert loss["after"] == pytest.approx(0.01 / np.sqrt(3.0))
    assert (
        loss["text"] == "tagged edges inside are 5.77e-03 of the diagonal from the old ones; the tolerance is 1.00e-03"
    )
    assert losses(one, other, tolerance=6e-3) == []


def test_pairs_of_periodic_sides_that_match_no_more():
    mesh = kuhn_cube(2)
    assert losses(mesh, mesh, sides={"before": 3, "after": 3}) == []
    [lost] = losses(mesh, mesh, sides={"before": 3, "after": 1})
    assert (lost["kind"], lost["before"], lost["after"], lost["allowed"]) == ("periodic", 3.0, 1.0, 3.0)
    assert lost["text"] == "3 pairs of periodic sides matched, vertex for vertex; 1 do now"


def test_a_volume_that_changes_by_more_than_half_a_percent():
    mesh = kuhn_cube(3)
    for factor, lost in ((1.004, False), (1.006, True), (0.996, False), (0.994, True)):
        flat = TetMesh(mesh.points * [1.0, 1.0, factor], mesh.tets)
        found = [loss for loss in losses(mesh, flat, tolerance=0.1) if loss["kind"] == "volume"]
        assert bool(found) == lost
        if lost:
            assert found[0]["after"] == pytest.approx(factor)
            assert f"{100 * (factor - 1):+.2f} %" in found[0]["text"]


def test_a_contact_that_shrinks_and_one_that_is_gone():
    cube = kuhn_cube(4)
    facets = cube.topology.boundary
    top = np.flatnonzero((cube.points[facets][:, :, 2] == 1.0).all(axis=1))
    left = np.flatnonzero((cube.points[facets][:, :, 0] == 0.0).all(axis=1))
    tags = np.r_[np.full(len(top), 7), np.full(len(left), 8)]
    old = TetMesh(cube.points, cube.tets, facets=Cells(facets[np.r_[top, left]], tags), names={"anode": (7, 2)})
    assert losses(old, old) == []
    fewer = Cells(old.facets.vertices[1 : len(top)], tags[1 : len(top)])
    found = losses(old, TetMesh(cube.points, cube.tets, facets=fewer, names=old.names))
    assert [(loss["kind"], loss["name"]) for loss in found] == [("group", "anode"), ("group", "8")]
    assert found[0]["after"] / found[0]["before"] == pytest.approx(31 / 32)
    assert found[1]["after"] == 0.0
    assert "is lost" in found[1]["text"]


def test_creases_given_up():
    mesh = kuhn_cube(2)
    found = losses(mesh, mesh, released={"creases": 3, "length": 0.1})
    assert "3 creases were given up" in found[0]["text"]
    assert losses(mesh, mesh, released={"creases": 3, "length": 0.1}, allow_released=True) == []


def test_the_sharp_edges_of_a_cube_are_twelve_long():
    cube = kuhn_cube(3)
    sharp, whole = sharp_length(cube.points, cube.topology.boundary, 40.0)
    assert sharp == pytest.approx(12.0)
    assert whole == pytest.approx(12.0 + 6 * (2 * 2 + 3 * np.sqrt(2.0)))  # four inner lines and the diagonals, per face
    rough = cube.points.copy()
    rough[(cube.points == [1 / 3, 1 / 3, 1.0]).all(axis=1), 2] += 0.4
    found = losses(cube, TetMesh(rough, cube.tets), tolerance=1.0)
    assert "sharp edges" in [loss["kind"] for loss in found]


def test_a_cavity_a_handle_and_a_lost_piece_are_other_spaces():
    cube = kuhn_cube(5)
    middle = np.abs(np.array([0.5, 0.5, 0.5]))
    hollow = without(cube, lambda at: (np.abs(at - middle) < 0.1).all(axis=1))
    ring = without(cube, lambda at: (np.abs(at - middle) < 0.1)[:, :2].all(axis=1))
    halves = without(cube, lambda at: np.abs(at - middle)[:, 0] < 0.1)
    whole = measure_region_topology(cube)
    assert whole["0"] == {"components": 1, "euler_characteristic": 1, "joined_edges": 0, "pinched_vertices": 0}
    assert measure_region_topology(hollow)["0"]["euler_characteristic"] == 2
    assert measure_region_topology(ring)["0"]["euler_characteristic"] == 0
    assert measure_region_topology(halves)["0"]["components"] == 2
    for other in (cube, hollow, ring, halves):  # what the core starts again with is counted in another way
        (core,) = _core.euler_characteristics(other.tets, np.zeros(len(other.tets), dtype=np.int64))
        assert core == measure_region_topology(other)["0"]["euler_characteristic"]
    for other in (hollow, ring, halves):
        assert any(loss["kind"] == "topology" for loss in losses(cube, other, tolerance=1.0))


@pytest.mark.parametrize("kept", [0.3, 0.9, 0.99])
def test_the_euler_characteristic_of_any_region_is_what_counting_its_cells_gives(kept):
    rng = np.random.default_rng(7)
    cube, manifolds = kuhn_cube(4), 0
    for _ in range(30):
        regions = np.where(rng.random(len(cube.tets)) < kept, 1, 2)
        for tag, found in measure_region_topology(TetMesh(cube.points, cube.tets, regions=regions)).items():
            tets = np.sort(cube.tets[regions == int(tag)], axis=1)
            cells = [{c for tet in tets.tolist() for c in combinations(tet, k)} for k in (1, 2, 3, 4)]
            assert found["euler_characteristic"] == sum((-1) ** k * len(same) for k, same in enumerate(cells))
            manifolds += not (found["joined_edges"] or found["pinched_vertices"])
    assert kept < 0.99 or manifolds > 3


def test_joints_at_an_edge_and_at_a_vertex():
    cube = kuhn_cube(4)
    low = lambda at: at < 0.5  # noqa: E731
    along = without(cube, lambda at: low(at)[:, 0] != low(at)[:, 1])  # two prisms that share an edge of four steps
    at_point = without(cube, lambda at: ~(low(at).all(axis=1) | (~low(at)).all(axis=1)))  # two octants
    assert measure_region_topology(along)["0"]["joined_edges"] == 4
    assert measure_region_topology(at_point)["0"]["pinched_vertices"] == 1
    plain = measure_region_topology(without(cube, lambda at: low(at)[:, 0]))
    assert ("0", "joined_edges", 0, 4) in changes(plain, measure_region_topology(along))
    finer = kuhn_cube(8)
    same = without(finer, lambda at: low(at)[:, 0] != low(at)[:, 1])
    assert changes(measure_region_topology(along), measure_region_topology(same)) == []
