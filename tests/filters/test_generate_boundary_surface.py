"""The boundary has the quality of the tets behind it, in MeshLab's own array."""

from dataclasses import replace

import numpy as np
import pymeshlab
import pytest
from support.builders import jittered_cube, regular_tet, two_region_cube

import wct_plugin as wct
from wct_plugin.errors import OptionError, WctWarning
from wct_plugin.measure import quality
from wct_plugin.mesh import Cells, SurfaceMesh
from wct_plugin.mesh.topology import FACETS


def behind(mesh, surface) -> np.ndarray:
    """(k, 2) the tets that have each triangle's three points as corners, -1 for a missing second; by brute force."""
    corners = [frozenset(map(tuple, mesh.points[tet])) for tet in mesh.tets]
    found = [
        [k for k, tet in enumerate(corners) if frozenset(map(tuple, surface.points[triangle])) <= tet]
        for triangle in surface.triangles
    ]
    return np.array([(*tets, -1)[:2] for tets in found])


def volume(surface) -> float:
    return float(np.linalg.det(surface.points[surface.triangles]).sum() / 6)


@pytest.mark.parametrize(
    ("options", "measure"),
    [
        ({}, lambda m: quality.heights_over_radius(m.points, m.tets).min(axis=1)),
        ({"quality": "max_face_angle"}, lambda m: quality.measure(m).max_face_angle),
        ({"quality": "max_dihedral_angle"}, lambda m: quality.measure(m).max_dihedral_angle),
    ],
)
def test_each_triangle_has_the_quality_of_its_tet(options, measure):
    mesh = jittered_cube(4, 1)
    surface, metrics = wct.apply_filter("generate_boundary_surface", mesh, **options)
    tets = behind(mesh, surface)
    assert (tets[:, 1] == -1).all()
    values = measure(mesh)[tets[:, 0]]
    assert len(np.unique(values)) > 50
    assert surface.cell_data["quality"] == pytest.approx(values)
    assert volume(surface) == pytest.approx(1.0)  # closed and outward
    worst = values.max() if options else values.min()
    assert metrics == {
        "points": len(surface.points),
        "triangles": len(surface.triangles),
        "worst_quality": pytest.approx(worst),
    }
    assert not mesh.cell_data


def test_the_regular_tet_is_a_third():
    surface, metrics = wct.apply_filter("generate_boundary_surface", regular_tet())
    assert surface.cell_data["quality"] == pytest.approx(1 / 3)
    assert metrics["worst_quality"] == pytest.approx(1 / 3)


def test_interfaces_face_out_of_their_worse_tet():
    mesh = two_region_cube(4)
    points = mesh.points + np.random.default_rng(0).uniform(-0.02, 0.02, mesh.points.shape)
    mesh = replace(mesh, points=points)
    outer, _ = wct.apply_filter("generate_boundary_surface", mesh)
    surface, _ = wct.apply_filter("generate_boundary_surface", mesh, interfaces=True)
    border = len(outer.triangles)
    assert len(surface.triangles) == border + 2 * 4 * 4
    assert np.array_equal(surface.cell_data["quality"][:border], outer.cell_data["quality"])
    heights = quality.heights_over_radius(mesh.points, mesh.tets).min(axis=1)
    between = SurfaceMesh(surface.points, surface.triangles[border:])
    tets = behind(mesh, between)
    assert (mesh.regions[tets[:, 0]] != mesh.regions[tets[:, 1]]).all()
    worse = tets[np.arange(len(tets)), heights[tets].argmin(axis=1)]
    assert (worse != tets[:, 0]).any()
    assert (worse != tets[:, 1]).any()
    assert surface.cell_data["quality"][border:] == pytest.approx(heights[worse])
    corners = between.points[between.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = mesh.points[mesh.tets[worse]].mean(axis=1) - corners[:, 0]
    assert (np.einsum("ij,ij->i", normal, inward) < 0).all()


def test_meshlab_reads_the_quality_of_every_face(tmp_path):
    surface, metrics = wct.apply_filter("generate_boundary_surface", jittered_cube(4, 1))
    wct.write(tmp_path / "skin.ply", surface)
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(tmp_path / "skin.ply"))
    read = meshes.current_mesh()
    values = surface.cell_data["quality"]
    assert np.array_equal(read.face_matrix(), surface.triangles)
    assert np.array_equal(read.face_scalar_array(), values)
    statistics = meshes.get_scalar_statistics_per_face()
    assert statistics["min"] == pytest.approx(metrics["worst_quality"])
    assert statistics["avg"] == pytest.approx(values.mean())
    low, high, bins = -1.0, 1.0, 20
    histogram = meshes.get_scalar_histogram_per_face(histmin=low, histmax=high, binnum=bins)
    edges = np.linspace(low, high, bins + 1)
    assert np.array_equal(histogram["hist_count"][1:-1], np.histogram(values, edges)[0])
    again = wct.read(tmp_path / "skin.ply")
    assert np.array_equal(again.cell_data["quality"], values)


def test_through_the_filter_meshlab():
    """The same histogram without a file between."""
    surface, metrics = wct.apply_filter("generate_boundary_surface", jittered_cube(4, 1))
    same, measured = wct.apply_filter("meshlab", surface, filter="get_scalar_statistics_per_face")
    assert measured["measures"]["min"] == pytest.approx(metrics["worst_quality"])
    assert np.array_equal(same.cell_data["quality"], surface.cell_data["quality"])


def test_tags_and_data_are_carried_and_the_rest_is_named():
    plain = jittered_cube(2, 0)
    skin = plain.topology.boundary
    tet, facet, _, _ = plain.topology.interior_pairs[0]
    facets = np.vstack([skin[::-1, [2, 0, 1]], plain.tets[tet, FACETS[facet]]])
    mesh = replace(
        plain,
        facets=Cells(
            facets,
            np.arange(len(facets)) + 1,
            {"flux": np.arange(len(facets)) * 0.5, "heat": np.arange(len(facets)) + 0.25},
            {"inlet": np.array([0])},
        ),
        edges=Cells(skin[:1, :2], np.array([4])),
        nodes=Cells(skin[:2, :1]),
        point_data={"u": plain.points @ np.array([1.0, 10, 100])},
        cell_data={"heat": np.zeros(len(plain.tets)), "id": np.arange(len(plain.tets))},
        point_sets={"fixed": np.array([0])},
    )
    with pytest.warns(WctWarning) as told:
        surface, _ = wct.apply_filter("generate_boundary_surface", mesh)
    assert [str(each.message) for each in told] == [
        "the boundary's surface cannot carry 1 tagged facets inside, 1 tagged edges, 2 tagged vertices, triangle set "
        "'inlet', point set 'fixed'"
    ]
    assert surface.points @ np.array([1.0, 10, 100]) == pytest.approx(surface.point_data["u"])
    tag = {tuple(sorted(map(tuple, mesh.points[row]))): k for k, row in enumerate(facets.tolist())}
    same = np.array([tag[tuple(sorted(map(tuple, surface.points[row])))] for row in surface.triangles])
    assert np.array_equal(surface.tags, same + 1)
    assert np.array_equal(surface.cell_data["flux"], same * 0.5)
    assert np.array_equal(surface.cell_data["heat"], same + 0.25)  # the facet's, not the tet's
    assert np.array_equal(surface.cell_data["id"], behind(mesh, surface)[:, 0])


def test_facets_without_a_tag():
    plain = jittered_cube(2, 0)
    some = plain.topology.boundary[::3]
    mesh = replace(
        plain, facets=Cells(some, np.full(len(some), 5), {"flux": np.full(len(some), 2.0), "id": np.arange(len(some))})
    )
    with pytest.warns(WctWarning, match=r"cannot carry triangle data 'id'$"):
        surface, _ = wct.apply_filter("generate_boundary_surface", mesh)
    tagged = np.arange(len(plain.topology.boundary)) % 3 == 0
    assert np.array_equal(surface.tags, np.where(tagged, 5, 0))
    assert np.array_equal(surface.cell_data["flux"], np.where(tagged, 2.0, np.nan), equal_nan=True)


def test_an_unknown_measure():
    with pytest.raises(
        OptionError, match="option 'quality' is 'h'; input should be 'min_h_over_R', 'max_face_angle' or"
    ):
        wct.apply_filter("generate_boundary_surface", regular_tet(), quality="h")
