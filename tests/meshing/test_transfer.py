"""What hangs on a mesh goes over to another mesh of the same domain."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import ball, jittered_cube, kuhn_cube

from wct_plugin.core.domain import StratifiedMesh
from wct_plugin.errors import WctWarning
from wct_plugin.mesh import Cells
from wct_plugin.mesh.strata import find_strata
from wct_plugin.meshing.transfer import carry, locate


def same_domain(old, new):
    """A mesh of the cube as if it were resampled from another: patches and curves matched by where they lie."""
    of, mine = find_strata(old), find_strata(new)

    def match(cells, labels, new_cells):
        side = {_face(old.points[cell]): label for cell, label in zip(cells, labels, strict=True)}
        return np.array([side[_face(new.points[cell])] for cell in new_cells])

    return of, StratifiedMesh(
        new.points,
        new.tets,
        new.regions,
        mine.stratum,
        mine.label,
        np.ones(len(new.points)),
        mine.triangles,
        match(of.triangles, of.patch, mine.triangles),
        mine.segments,
        match(of.segments, of.curve, mine.segments),
    )


def _face(points):
    """Which sides of the cube a cell lies on."""
    return tuple((points == 0).all(axis=0)) + tuple((points == 1).all(axis=0))


def test_locate_against_all_tets():
    mesh = jittered_cube(4, 1)
    queries = np.random.default_rng(2).random((200, 3))
    tet, weights = locate(mesh, queries)
    assert (weights >= 0).all()
    assert np.allclose(weights.sum(axis=1), 1.0, atol=1e-14)
    assert np.allclose(np.einsum("qi,qij->qj", weights, mesh.points[mesh.tets[tet]]), queries, atol=1e-12)
    corners = mesh.points[mesh.tets]
    inverse = np.linalg.inv((corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1))
    local = np.einsum("tij,qtj->qti", inverse, queries[:, None] - corners[None, :, 0])
    least = np.minimum(local.min(axis=2), 1.0 - local.sum(axis=2))
    assert np.array_equal(tet, least.argmax(axis=1))


def test_locate_outside_cuts_to_the_nearest_part():
    mesh = ball(3)
    queries = 1.05 * mesh.points[mesh.topology.boundary].mean(axis=1)
    tet, weights = locate(mesh, queries)
    nearest = np.einsum("qi,qij->qj", weights, mesh.points[mesh.tets[tet]])
    assert (weights >= 0).all()
    assert np.linalg.norm(nearest - queries, axis=1).max() < 0.3


def test_tags_sets_and_vertices_go_over():
    old, new = kuhn_cube(2), jittered_cube(4, 3)
    triangles = old.topology.boundary
    low, high = ((old.points[triangles][:, :, 2] == z).all(axis=1) for z in (0.0, 1.0))
    facets = Cells(
        np.concatenate([triangles[low], triangles[high]]),
        np.repeat([5, 7], [low.sum(), high.sum()]),
        sets={"top": low.sum() + np.arange(high.sum())},
    )
    segments = find_strata(old).segments
    rim = segments[(old.points[segments][:, :, :2] == 0).all(axis=(1, 2))]
    corner = np.flatnonzero((old.points == 1).all(axis=1))
    old = replace(
        old, facets=facets, edges=Cells(rim, np.full(len(rim), 3)), nodes=Cells(corner[:, None], [9], sets={"tip": [0]})
    )
    got = carry(old, *same_domain(old, new))
    for tag, z in ((5, 0.0), (7, 1.0)):
        cells = new.points[got.facets.vertices[got.facets.tags == tag]]
        assert (cells[:, :, 2] == z).all()
        area = np.linalg.norm(np.cross(cells[:, 1] - cells[:, 0], cells[:, 2] - cells[:, 0]), axis=1).sum() / 2
        assert area == pytest.approx(1.0, abs=1e-12)
    assert (got.facets.tags[got.facets.sets["top"]] == 7).all()
    assert len(got.facets.sets["top"]) == (got.facets.tags == 7).sum()
    ends = new.points[got.edges.vertices]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(1.0, abs=1e-12)
    assert (ends[:, :, :2] == 0).all()
    assert np.array_equal(got.points[got.nodes.vertices[0]], [[1.0, 1.0, 1.0]])
    assert np.array_equal(got.nodes.sets["tip"], [0])


def test_data_go_over_and_losses_are_named():
    old, new = jittered_cube(3, 4), jittered_cube(4, 5)
    linear = old.points @ [1.0, -2.0, 3.0] + 0.5
    half = old.points[old.tets].mean(axis=1)[:, 0] > 0.5
    old = replace(
        old,
        point_data={"u": linear, "v": old.points.copy(), "id": np.arange(len(old.points))},
        cell_data={"half": half},
        tet_sets={"right": np.flatnonzero(half)},
        point_sets={"probe": [0]},
        facets=Cells(old.topology.boundary[:1], [1], data={"flux": [1.0]}),
    )
    with pytest.warns(WctWarning, match="triangle data 'flux', point set 'probe', point data 'id'"):
        got = carry(old, *same_domain(old, new))
    assert np.allclose(got.point_data["u"], new.points @ [1.0, -2.0, 3.0] + 0.5, atol=1e-12)
    assert np.allclose(got.point_data["v"], new.points, atol=1e-12)
    tet, _ = locate(old, new.points[new.tets].mean(axis=1))
    assert np.array_equal(got.cell_data["half"], half[tet])
    assert np.array_equal(got.tet_sets["right"], np.flatnonzero(half[tet]))


def test_what_is_constant_on_regions_is_carried_exactly():
    old, new = (jittered_cube(3, 2), jittered_cube(4, 5))
    halves = [np.where(mesh.points[mesh.tets].mean(axis=1)[:, 2] < 0.5, 4, -7) for mesh in (old, new)]
    given = replace(
        old,
        regions=halves[0],
        cell_data={
            "zone": halves[0].astype("i2"),
            "k": np.where(halves[0] == 4, np.nan, 0.3),
            "other": np.arange(len(old.tets)),
        },
        tet_sets={"low": np.flatnonzero(halves[0] == 4), "all": np.arange(len(old.tets)), "none": [], "some": [0]},
        region_name="zone",
    )
    # The new regions are not where the old ones are, so that the tet at a centroid would say otherwise.
    turned = halves[1][::-1]
    strata, resampled = same_domain(old, new)
    made = carry(given, strata, replace(resampled, regions=turned))
    assert made.region_name == "zone"
    assert np.array_equal(made.cell_data["zone"], turned)
    assert made.cell_data["zone"].dtype == np.int16
    assert np.array_equal(made.cell_data["k"], np.where(turned == 4, np.nan, 0.3), equal_nan=True)
    assert np.array_equal(made.tet_sets["low"], np.flatnonzero(turned == 4))
    assert np.array_equal(made.tet_sets["all"], np.arange(len(new.tets)))
    assert not len(made.tet_sets["none"])
    assert np.array_equal(made.cell_data["other"], locate(old, new.points[new.tets].mean(axis=1))[0])
