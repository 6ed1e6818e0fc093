"""The paper's single tetrahedra, digit by digit, and its subdivisions of the regular one."""

import numpy as np
import pytest
from paper import EIGHT, FORTY_NINE
from support.printed import PAPER_TETS, beaten, columns

import wct_plugin as wct
from wct_plugin.errors import OptionError
from wct_plugin.measure import quality
from wct_plugin.mesh.topology import EDGES


def edge_lengths(mesh: wct.TetMesh) -> np.ndarray:
    ends = mesh.points[mesh.tets[:, EDGES]]
    return np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2)


@pytest.mark.parametrize("name", PAPER_TETS)
def test_single_tetrahedra_are_the_papers(name):
    corners, printed, letters = PAPER_TETS[name]
    mesh, metrics = wct.apply_filter("create_tetrahedron", name=name)
    assert np.array_equal(mesh.points[mesh.tets[0]], corners)
    assert not mesh.repairs
    assert columns(mesh) == printed
    assert metrics["well_centered_3"] == (letters[0] == "Y")
    assert metrics["completely_well_centered"] == letters.startswith("YY")


def test_regular_tetrahedron_and_size():
    mesh, metrics = wct.apply_filter("create_tetrahedron", size=2.5)
    assert edge_lengths(mesh) == pytest.approx(2.5, rel=1e-14)
    assert not mesh.repairs
    assert metrics["h_over_R"] == pytest.approx([1 / 3, 1 / 3])
    mesh, _ = wct.apply_filter("create_tetrahedron", name="sommerville", size=1)
    assert edge_lengths(mesh).max() == pytest.approx(1, rel=1e-14)


@pytest.mark.parametrize("variant", EIGHT)
def test_subdivisions_of_eight_are_the_papers(variant):
    mesh, metrics = wct.apply_filter("create_tetrahedron_subdivision", variant=variant)
    _, printed = EIGHT[variant]
    assert columns(mesh, places=4) == printed.split()
    assert metrics["completely_well_centered"]


def test_our_eight_has_more_room_than_both_of_the_papers():
    _, ours = wct.apply_filter("create_tetrahedron_subdivision")
    assert ours["tets"] == 8
    assert ours["completely_well_centered"]
    assert ours["h_over_R"][0] > 0.0598


def test_our_49_beats_the_papers_in_every_column():
    mesh, ours = wct.apply_filter("create_tetrahedron_subdivision", variant=49)
    assert ours["tets"] == 49
    assert ours["completely_well_centered"]
    better = beaten(FORTY_NINE, mesh)
    assert better[:6] + better[7:] == [True] * 7  # the smallest R/l is as printed
    assert columns(mesh)[:2] == ["0.016", "0.843"]


def test_faces_of_the_49_match_each_other():
    """Each face has a three-fold axis, so that its vertices lie at the same distances from its three corners."""
    mesh, _ = wct.apply_filter("create_tetrahedron_subdivision", variant="49")
    corners = np.array([[3.0, 3, 3], [3, -3, -3], [-3, 3, -3], [-3, -3, 3]])
    patterns = []
    for face in range(4):
        on_face = mesh.points[np.abs(mesh.points @ corners[face] + 9) < 1e-12]
        others = np.delete(corners, face, axis=0)
        distances = np.linalg.norm(on_face[:, None] - others, axis=2)
        patterns.append(sorted(tuple(np.round(row, 9)) for row in np.sort(distances, axis=1)))
        for cycled in (np.roll(distances, 1, axis=1), np.roll(distances, 2, axis=1)):
            assert sorted(map(tuple, np.round(cycled, 9))) == sorted(map(tuple, np.round(distances, 9)))
    assert patterns[0] == patterns[1] == patterns[2] == patterns[3]
    assert len(patterns[0]) == 10  # three corners, two points on each edge, the centre


@pytest.mark.parametrize("variant", ["8a", "8b", "8", "49"])
def test_subdivisions_fill_the_tetrahedron(variant):
    mesh, _ = wct.apply_filter("create_tetrahedron_subdivision", variant=variant, size=2.0)
    assert not mesh.repairs
    assert quality.volumes(mesh.points, mesh.tets).sum() == pytest.approx(8 / (6 * 2**0.5), rel=1e-14)
    heights = mesh.points[mesh.topology.boundary] @ -mesh.points[:4].T  # largest on the face opposite a corner
    inradius_times_corner = heights.max()
    on_faces = np.isclose(heights, inradius_times_corner, rtol=1e-12, atol=0).all(axis=1)
    assert on_faces.any(axis=1).all()


def test_unknown_and_impossible_options_are_refused():
    with pytest.raises(OptionError, match="option 'variant' is '9'"):
        wct.apply_filter("create_tetrahedron_subdivision", variant=9)
    with pytest.raises(OptionError, match="option 'name' is 'flat'; input should be 'regular'"):
        wct.apply_filter("create_tetrahedron", name="flat")
    with pytest.raises(OptionError, match="option 'size' is 0; input should be greater than 0"):
        wct.apply_filter("create_tetrahedron", size=0)
