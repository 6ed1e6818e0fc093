"""Coincident facets come back as pairs, bodies that only touch stay two, and the option says otherwise."""

import warnings

import numpy as np
import pytest
from support.builders import kuhn_grid

from wct_plugin import apply_filter
from wct_plugin.errors import OptionError, WctWarning
from wct_plugin.measure import quality
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.topology import FACETS


def run(mesh, **options):
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always", WctWarning)
        new, metrics = apply_filter("meshing_well_centered", mesh, **options)
    return new, metrics, [str(one.message) for one in heard]


def side_by_side(one, other, regions):
    """Both meshes in one, without a common vertex."""
    tags = np.repeat(regions, [len(one.tets), len(other.tets)])
    points = np.concatenate([one.points, other.points])
    return TetMesh(points, np.concatenate([one.tets, other.tets + len(one.points)]), tags)


def moved(mesh, shift):
    return TetMesh(mesh.points + shift, mesh.tets)


def boundary(mesh):
    """Boundary facets by brute force, as (k, 3) with their tets."""
    halves = np.sort(mesh.tets[:, FACETS].reshape(-1, 3), axis=1)
    _, of, count = np.unique(halves, axis=0, return_inverse=True, return_counts=True)
    return halves[count[of.reshape(-1)] == 1]


def pairs(mesh):
    """How often two boundary facets have the same three corners, to the bit, and the area of these."""
    seen = {}
    for facet in boundary(mesh):
        seen.setdefault(tuple(sorted(map(tuple, mesh.points[facet].tolist()))), []).append(facet)
    two = [np.array(corners) for corners, facets in seen.items() if len(facets) == 2]
    return len(two), sum(np.linalg.norm(np.cross(c[1] - c[0], c[2] - c[0])) / 2 for c in two)


def area(mesh):
    corners = mesh.points[boundary(mesh)]
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2


def cracked(n=4):
    """A cube whose middle has a square crack across: vertices inside it are double, those on its rim single."""
    grid = kuhn_grid((n, n, n))
    points, tets = grid.points, grid.tets.copy()
    x, y, z = points.T
    inside = np.flatnonzero((z == n // 2) & (np.abs(x - n / 2) < n / 4) & (np.abs(y - n / 2) < n / 4))
    copy = np.arange(len(points))
    copy[inside] = len(points) + np.arange(len(inside))
    above = points[tets].mean(axis=1)[:, 2] > n // 2
    tets[above] = copy[tets[above]]
    return TetMesh(np.concatenate([points, points[inside]]), tets)


def test_contact_facets_match_again():
    box = kuhn_grid((2, 2, 2))
    mesh = side_by_side(box, moved(box, [2, 0, 0]), (0, 0))
    assert pairs(mesh) == (8, 4.0)
    new, metrics, said = run(mesh)
    count, contact = pairs(new)
    assert count > 0
    assert contact == pytest.approx(4.0, rel=1e-12)
    assert area(new) == pytest.approx(48.0, rel=1e-12)
    assert metrics["bad"] == 0
    assert new.topology.components.max() == 1
    assert quality.volumes(new.points, new.tets).sum() == pytest.approx(16.0)
    assert sum("kept as 8 pairs" in line for line in said) == 1
    assert metrics["losses"] == []


def test_each_side_keeps_its_tags_sets_and_data():
    box = kuhn_grid((2, 2, 2))
    mesh = side_by_side(box, moved(box, [2, 0, 0]), (1, 2))
    facets = mesh.topology.boundary
    at = (mesh.points[facets][:, :, 0] == 2).all(axis=1)
    left = (facets < len(box.points)).all(axis=1)
    cells = np.concatenate([facets[at & left], facets[at & ~left]])
    half = int((at & left).sum())
    side = np.repeat([1.0, 2.0], len(box.points))
    mesh = TetMesh(
        mesh.points,
        mesh.tets,
        mesh.regions,
        Cells(cells, np.repeat([7, 9], half), {}, {"contact": np.arange(half)}),
        point_data={"jump": side},
    )
    new, metrics, _ = run(mesh)
    count, contact = pairs(new)
    assert count > 0
    assert contact == pytest.approx(4.0, rel=1e-12)
    assert metrics["bad"] == 0
    assert new.topology.components.max() == 1
    volume = quality.volumes(new.points, new.tets)
    assert [volume[new.regions == tag].sum() for tag in (1, 2)] == pytest.approx([8.0, 8.0])
    of = np.zeros(len(new.points), dtype=np.int64)
    of[new.tets] = new.regions[:, None]
    assert (np.bincount(of) == [0, *(len(np.unique(new.tets[new.regions == tag])) for tag in (1, 2))]).all()
    for tag, region in ((7, 1), (9, 2)):
        rows = new.facets.vertices[new.facets.tags == tag]
        assert len(rows) == count
        assert (of[rows] == region).all()
        assert (new.points[rows][:, :, 0] == 2).all()
    assert set(new.facets.sets) == {"contact"}
    assert (new.facets.tags[new.facets.sets["contact"]] == 7).all()
    assert len(new.facets.sets["contact"]) == count
    assert new.point_data["jump"] == pytest.approx(of, abs=1e-9)
    assert metrics["losses"] == []


def test_a_crack_stays_one():
    mesh = cracked()
    count, opening = pairs(mesh)
    new, metrics, said = run(mesh)
    assert pairs(new) == (count, pytest.approx(opening))
    assert area(new) == pytest.approx(6 * 16 + 2 * opening)
    assert any(f"{count} pairs" in line for line in said)
    assert not any(loss["kind"] in ("deviation", "topology", "volume") for loss in metrics["losses"])
    assert metrics["bad"] < (~quality.measure(mesh).completely_well_centered).sum()


def test_a_mesh_taken_apart_needs_a_choice():
    box = kuhn_grid((2, 2, 2))
    mesh = TetMesh(box.points[box.tets].reshape(-1, 3), np.arange(box.tets.size).reshape(-1, 4), source="parts.vtu")
    inner = (4 * len(box.tets) - len(boundary(box))) // 2
    with pytest.raises(OptionError, match=rf"parts\.vtu: .* in {inner} pairs.*merge=all.*merge=none"):
        apply_filter("meshing_well_centered", mesh)
    new, metrics, _ = run(mesh, merge="all", boundary={"*": "move"})
    assert metrics["bad"] == 0
    assert area(new) == pytest.approx(24.0)
    assert new.topology.components.max() == 0


def test_bodies_that_touch_with_other_facets_stay_two():
    box = kuhn_grid((2, 2, 2))
    finer = kuhn_grid((4, 4, 4))
    mesh = side_by_side(box, TetMesh(finer.points / 2 + [2, 0, 0], finer.tets), (0, 0))
    new, metrics, said = run(mesh)
    assert metrics["bad"] == 0
    assert metrics["losses"] == []
    assert area(new) == pytest.approx(48.0)
    assert new.topology.components.max() == 1
    assert any("18 coincident points in 9 places" in line for line in said)
