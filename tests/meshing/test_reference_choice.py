"""Which surface the boundary follows, and that tags find their place on it or it is not taken."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import ball, cylinder, kuhn_cube, sphere_surface, two_region_cube

from wct_plugin.adapters.meshlab import run as meshlab
from wct_plugin.errors import NeighbourError, WctWarning
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh
from wct_plugin.mesh.strata import find_strata
from wct_plugin.meshing.reference import own_boundary
from wct_plugin.meshing.reference_choice import choose

ROUND = cylinder(64, 10).boundary_surface()


def chosen(mesh, surface, crease_angle, tolerance):
    return choose(mesh, own_boundary(mesh, crease_angle), surface, crease_angle, tolerance)


def tagged(mesh, tag_of):
    """Every boundary facet tagged by its centroid."""
    triangles = mesh.topology.boundary
    return replace(mesh, facets=Cells(triangles, tag_of(mesh.points[triangles].mean(axis=1))))


def ends(centers):
    return np.select([centers[:, 2] < 1e-9, centers[:, 2] > 2.0 - 1e-9], [1, 2], 3)


def test_tags_along_creases_are_found_on_a_finer_surface():
    mesh = tagged(cylinder(16, 6), ends)
    reference, reason = chosen(mesh, ROUND, 40.0, 2e-2)
    assert reason == ""
    assert len(reference.strata.triangles) == len(ROUND.triangles)
    assert np.array_equal(np.unique(reference.sides, axis=0), [[0, -1]])
    centers = reference.points[reference.strata.triangles].mean(axis=1)
    carried = reference.carried[reference.strata.patch]
    own = find_strata(mesh)
    triangles = np.sort(own.triangles, axis=1).tolist()
    tag_of = dict(zip(map(tuple, np.sort(mesh.facets.vertices, axis=1).tolist()), mesh.facets.tags, strict=True))
    tag_of_patch = {patch: tag_of[tuple(row)] for row, patch in zip(triangles, own.patch.tolist(), strict=True)}
    assert np.array_equal([tag_of_patch[patch] for patch in carried.tolist()], ends(centers))


def test_a_border_across_a_smooth_patch_cuts_the_surface_where_its_edges_run_there():
    mesh = tagged(cylinder(32, 10), lambda centers: (centers[:, 2] > 1.0).astype(int))
    surface = mesh.boundary_surface()
    reference, reason = chosen(mesh, surface, 40.0, 1e-3)
    assert reason == ""
    at = reference.points[np.unique(reference.strata.segments)]
    assert set(np.unique(at[:, 2]).tolist()) == {0.0, 1.0, 2.0}
    upper = reference.points[reference.strata.triangles].mean(axis=1)[:, 2] > 1.0
    labels = [set(reference.carried[reference.strata.patch[side]].tolist()) for side in (upper, ~upper)]
    assert labels[0].isdisjoint(labels[1])


def test_a_border_that_the_surface_has_no_edges_for_is_not_taken():
    mesh = tagged(ball(5), lambda centers: (centers[:, 2] > 0.0).astype(int))
    reference, reason = chosen(mesh, sphere_surface(2000), 40.0, 1e-3)
    assert reason == "tags of the mesh change where the surface has no edges to follow"
    assert len(reference.strata.triangles) == len(mesh.topology.boundary)
    assert np.array_equal(reference.carried, np.arange(len(reference.sides)))


def test_one_tag_all_over_cuts_nothing():
    mesh = tagged(ball(5), lambda centers: np.full(len(centers), 7))
    reference, reason = chosen(mesh, sphere_surface(2000), 40.0, 1e-3)
    assert reason == ""
    assert len(reference.points) == 2000
    assert (reference.strata.patch == 0).all()


def test_a_missing_tag_is_not_taken():
    """A patch of the mesh that the surface has nothing near, though no border of the surface is out of place."""
    mesh = tagged(cylinder(32, 10), lambda centers: (centers[:, 2] > 1.0).astype(int))
    half = TetMesh(mesh.points * [1, 1, 0.5], mesh.tets).boundary_surface()
    assert chosen(mesh, half, 40.0, 1e-3)[1] != ""


def fails(*_):
    raise NeighbourError("MeshLab crashed")


def test_a_surface_with_a_hole_is_made_whole_or_the_reason_said(monkeypatch):
    """Closed, its border in a smooth patch still cuts it; where MeshLab fails, the mesh's own facets are followed."""
    mesh = tagged(cylinder(32, 10), lambda centers: (centers[:, 2] > 1.0).astype(int))
    whole = mesh.boundary_surface()
    opened = SurfaceMesh(whole.points, whole.triangles[1:])
    with pytest.warns(WctWarning, match="the reference has holes, which were closed"):
        reference, reason = chosen(mesh, opened, 40.0, 1e-3)
    assert reason == ""
    at = reference.points[np.unique(reference.strata.segments)]
    assert set(np.unique(at[:, 2]).tolist()) == {0.0, 1.0, 2.0}
    monkeypatch.setattr(meshlab, "run", fails)
    reference, reason = chosen(mesh, opened, 40.0, 1e-3)
    assert reason.endswith("in places, and MeshLab crashed")
    assert len(reference.strata.triangles) == len(whole.triangles)


@pytest.mark.parametrize(
    ("mesh", "reason"),
    [
        (two_region_cube(2), "the mesh has several regions"),
        (replace(kuhn_cube(2), nodes=Cells(np.array([[0]]))), "the mesh has tagged edges or vertices"),
        (replace(kuhn_cube(2), edges=Cells(kuhn_cube(2).topology.edges[:3])), "the mesh has tagged edges or vertices"),
        (
            replace(kuhn_cube(2), facets=Cells(two_region_cube(2).topology.interfaces)),
            "the mesh has tagged facets inside",
        ),
        (kuhn_cube(2), ""),
    ],
    ids=["regions", "nodes", "edges", "inner facets", "plain"],
)
def test_reasons(mesh, reason):
    surface = kuhn_cube(3).boundary_surface()
    reference, found = chosen(mesh, surface, 40.0, None)
    assert found == reason
    assert len(reference.points) == (len(mesh.points) if reason else len(surface.points))
