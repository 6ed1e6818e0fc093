"""What solvers see: couples against their circumcenters, unsigned volumes against DEVSIM, angles written out."""

from dataclasses import asdict, replace

import numpy as np
import pytest
from support.builders import ball, bcc, jittered_cube, kuhn_cube, rotation, single, two_region_cube
from support.couples import centers, couples
from support.solvers import node_volumes

from wct_plugin.io import write
from wct_plugin.measure.solver_view import view
from wct_plugin.measure.stray_circumcenters import stray_circumcenters
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.region_parts import apart


def shaken_halves(seed):
    """Region 1 below z = 1/2 and 2 above, all points shaken, but those on planes within them."""
    cube = two_region_cube(4)
    shift = np.random.default_rng(seed).uniform(-0.075, 0.075, cube.points.shape)
    shift[(cube.points == 0) | (cube.points == 1)] = 0.0
    shift[cube.points[:, 2] == 0.5, 2] = 0.0
    return replace(cube, points=cube.points + shift)


@pytest.mark.parametrize("seed", range(3))
def test_negative_couples_are_those_of_the_circumcenters(seed):
    mesh = shaken_halves(seed)
    found, wanted = view(mesh), couples(mesh)
    for tag, region in found.regions.items():
        areas = [area for (of, *_), area in wanted.items() if of == tag]
        assert region.couples == len(areas)
        assert region.negative_couples == sum(area < 0 for area in areas) > 5
    assert found.total.couples == len(wanted)
    assert found.total.negative_couples == sum(area < 0 for area in wanted.values())


def test_unsigned_volumes_are_those_of_devsim(tmp_path):
    mesh = replace(shaken_halves(3), names={"left": (1, 3), "right": (2, 3)})
    write(tmp_path / "a.msh", mesh)
    volume = np.linalg.det(mesh.points[mesh.tets[:, 1:]] - mesh.points[mesh.tets[:, :1]]) / 6
    found, devsim = view(mesh), node_volumes(tmp_path / "a.msh", ["left", "right"])
    for name, tag in (("left", 1), ("right", 2)):
        ratio = devsim[name].sum() / volume[mesh.regions == tag].sum()
        assert found.regions[tag].unsigned_over_signed == pytest.approx(ratio, rel=1e-12)
        assert ratio > 1.1
    assert found.total.unsigned_over_signed == pytest.approx(
        sum(map(np.sum, devsim.values())) / volume.sum(), rel=1e-12
    )


def test_of_well_centered_tets_nothing_is_wrong():
    total = view(bcc(3)).total
    assert (total.negative_couples, total.stray_circumcenters) == (0, 0)
    assert total.unsigned_over_signed == pytest.approx(1.0, abs=1e-14)
    assert total.shown()[1] == "1.000"


def test_non_orthogonality_of_two_tets_in_closed_form():
    """Two tets over a triangle in z = 0, tips at (0, 0, 1) and (s, 0, -1): the centroids are (-s, 0, 2) / 4 apart."""
    s = 0.7
    corners = [(1, 0, 0), (-0.5, 0.8, 0), (-0.5, -0.8, 0), (0, 0, 1), (s, 0, -1)]
    mesh = TetMesh(np.array(corners) @ rotation(4).T, np.array([[0, 1, 2, 3], [0, 2, 1, 4]]))
    total = view(mesh).total
    angle = np.degrees(np.arctan2(s, 2.0))
    assert (total.max_non_orthogonality, total.mean_non_orthogonality) == (pytest.approx(angle), pytest.approx(angle))
    halves = view(replace(mesh, regions=np.array([1, 2])))
    assert halves.total.max_non_orthogonality == pytest.approx(angle)
    assert [one.max_non_orthogonality for one in halves.regions.values()] == [0.0, 0.0]  # no facet inside


def test_the_mean_is_the_angle_of_the_mean_cosine():
    mesh = jittered_cube(3, 2)
    pairs = mesh.topology.interior_pairs
    angles = []
    for tet, facet, other, _ in pairs.tolist():
        a, b, c = mesh.points[np.delete(mesh.tets[tet], facet)]
        normal = np.cross(b - a, c - a)
        line = mesh.points[mesh.tets[other]].mean(axis=0) - mesh.points[mesh.tets[tet]].mean(axis=0)
        angles.append(np.degrees(np.arccos(abs(normal @ line) / np.linalg.norm(normal) / np.linalg.norm(line))))
    total = view(mesh).total
    assert total.max_non_orthogonality == pytest.approx(max(angles))
    assert total.mean_non_orthogonality == pytest.approx(np.degrees(np.arccos(np.cos(np.radians(angles)).mean())))


@pytest.mark.parametrize("seed", range(3))
def test_stray_circumcenters_of_a_convex_domain_are_those_outside(seed):
    """The cube, and each of its halves, is convex, and so is known without following any way."""
    mesh = shaken_halves(seed)
    middle = centers(mesh.points[mesh.tets])
    inside = ((middle > 0) & (middle < 1)).all(axis=1)
    assert np.array_equal(stray_circumcenters(mesh), ~inside)
    inside &= (middle[:, 2] > 0.5) == (mesh.regions == 2)
    assert np.array_equal(stray_circumcenters(apart(mesh)), ~inside)
    assert view(mesh).total.stray_circumcenters == (~inside).sum() >= 5


def test_a_circumcenter_on_the_boundary_is_not_outside():
    assert not stray_circumcenters(kuhn_cube(3)).any()
    corner = single([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
    assert stray_circumcenters(corner).tolist() == [True]  # (.5, .5, .5)


@pytest.mark.parametrize("scale", [1e-60, 1e60])
def test_the_unit_changes_nothing(scale):
    mesh = ball(3)
    power = 2.0 ** round(np.log2(scale))
    assert asdict(view(replace(mesh, points=mesh.points * power))) == asdict(view(mesh))


def test_of_many_regions_the_worst_are_listed():
    mesh = kuhn_cube(3)
    many = replace(mesh, regions=np.arange(len(mesh.tets)))
    found = view(many)
    assert len(found.regions) == len(mesh.tets)
    rows = found.rows(most=5)
    assert [row[0] for row in rows][-1] == "all"
    assert len(rows) == 6
    assert len(view(mesh).rows()) == 1
