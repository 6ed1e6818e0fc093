"""Any figure of voxels: whole, conforming, completely well-centered, and made of exact copies of one cube."""

import subprocess
import sys
from itertools import product

import numpy as np
import pytest
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.creation import bundled_meshes, voxel_mesh
from wct_plugin.errors import InputError, OptionError
from wct_plugin.measure import quality
from wct_plugin.mesh.topology import FACETS


def made(voxels, **options):
    return wct.apply_filter("create_from_voxels", voxels=np.asarray(voxels), **options)


def ball(n):
    squares = ((np.indices((n, n, n)) - (n - 1) / 2) ** 2).sum(axis=0)
    return squares < (n / 2) ** 2


def ring():
    voxels = np.ones((3, 3, 1), dtype=bool)
    voxels[1, 1] = False
    return voxels


def l_shape():
    voxels = np.ones((3, 3, 2), dtype=bool)
    voxels[1:, 1:] = False
    return voxels


def squares_between(values):
    """How many pairs of neighbours differ in value, the outside counted as 0, and in how many neither is 0."""
    padded = np.pad(np.asarray(values, dtype=int), 1)
    outer = inner = 0
    for axis in range(3):
        one, other = np.delete(padded, -1, axis), np.delete(padded, 0, axis)
        outer += int(((one != 0) != (other != 0)).sum())
        inner += int(((one != other) & (one != 0) & (other != 0)).sum())
    return outer, inner


def check(mesh, values, facets_per_square, euler):
    """Volume, conformity and boundary, all by count; and every tet completely well-centered."""
    values = np.asarray(values)
    outer, inner = squares_between(values)
    assert not mesh.repairs
    assert quality.volumes(mesh.points, mesh.tets).sum() == pytest.approx((values != 0).sum(), rel=1e-13)
    assert len(mesh.topology.boundary) == outer * facets_per_square  # so that facets within are shared by two
    assert len(mesh.topology.interfaces) == inner * facets_per_square
    assert quality.measure(mesh).completely_well_centered.all()
    triangles = mesh.topology.boundary
    edges = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    assert len(np.unique(triangles)) - len(edges) + len(triangles) == euler


@pytest.mark.parametrize(("voxels", "euler"), [(np.ones((1, 1, 1)), 2), (l_shape(), 2), (ring(), 0), (ball(12), 2)])
def test_figures(voxels, euler):
    mesh, metrics = made(voxels)
    assert len(mesh.tets) == 194 * np.count_nonzero(voxels)
    assert metrics["voxels"] == np.count_nonzero(voxels)
    assert metrics["completely_well_centered"]
    check(mesh, voxels, 14, euler)


@pytest.mark.parametrize("variant", ["194_paper", "194_best", "104", "87", "84"])
def test_any_cube_matches_its_mirror_image(variant):
    mesh, _ = made(l_shape(), variant=variant)
    faces = len(bundled_meshes.load(f"cube_{variant}")[1][:, FACETS].reshape(-1, 3))
    single, _ = made(np.ones((1, 1, 1)), variant=variant)
    assert len(single.topology.boundary) < faces
    solid, _ = made(np.ones((2, 2, 2)), variant=variant)
    low_sides = (single.points[single.topology.boundary] == 0).all(axis=1).sum()
    assert len(solid.topology.boundary) == 8 * low_sides  # the high ones meet inside
    assert quality.measure(mesh).completely_well_centered.all()


def test_a_cube_that_is_3_well_centered_gives_a_mesh_that_is():
    mesh, metrics = made(l_shape(), variant=30)
    assert quality.measure(mesh).well_centered_3.all()
    assert metrics["well_centered_3"]
    assert not metrics["completely_well_centered"]


def test_values_become_regions_and_their_interface():
    voxels = np.array(l_shape(), dtype=np.uint8) * 7
    voxels[:, 0] = 255
    mesh, metrics = made(voxels)
    assert metrics["regions"] == 2
    volumes = quality.volumes(mesh.points, mesh.tets)
    for value in (7, 255):
        assert volumes[mesh.regions == value].sum() == pytest.approx((voxels == value).sum())
    check(mesh, voxels, 14, 2)
    assert len(mesh.topology.interfaces) == 2 * 14
    assert (mesh.points[mesh.topology.interfaces][:, :, 1] == 1).all()


def test_every_voxel_holds_an_exact_copy_of_the_cube():
    """Up to reflection the shapes of all tets are those of one cube, to the bit: what holds for it holds for all."""
    mesh, _ = made(ball(5))
    points, tets = bundled_meshes.load("cube_194")
    snapped = voxel_mesh.snapped(points)
    assert np.abs(snapped - points).max() < 5e-7
    copies = [np.where(flips, 1 - snapped, snapped) for flips in product((0, 1), repeat=3)]
    known = {frozenset(map(tuple, copy[tet])) for copy in copies for tet in tets}
    corners = mesh.points[mesh.tets]
    voxel = np.floor(corners.mean(axis=1))
    found = {frozenset(map(tuple, tet)) for tet in corners - voxel[:, None]}
    assert found <= known
    assert len(found) == 2 * 194  # the cube has three two-fold axes, so that its eight reflections are two


def test_voxels_keep_their_place_and_spacing():
    voxels = np.zeros((4, 5, 6))
    voxels[3, 1, 2] = 1
    mesh, _ = made(voxels, spacing=0.25)
    assert np.array_equal([mesh.points.min(axis=0), mesh.points.max(axis=0)], [[0.75, 0.25, 0.5], [1.0, 0.5, 0.75]])


def test_a_spacing_of_up_to_four_percent_more_along_any_axes_is_allowed():
    rng = np.random.default_rng(1)
    directions = [*product((0, 1), repeat=3), *rng.random((40, 3))]
    for direction in directions:
        _, metrics = made(np.ones((1, 1, 1)), spacing=tuple(1.04 ** np.array(direction)))
        assert metrics["completely_well_centered"]
    mesh, _ = made(l_shape(), spacing=(0.3, 0.31, 0.3))
    assert quality.measure(mesh).completely_well_centered.all()
    assert quality.volumes(mesh.points, mesh.tets).sum() == pytest.approx(10 * 0.3 * 0.31 * 0.3)


def test_a_spacing_that_breaks_the_guarantee_is_refused_and_what_it_names_is_allowed():
    with pytest.raises(
        OptionError, match=r"voxels of 1 x 1 x 2, in which the 194 tets of variant 194 are not"
    ) as error:
        made(np.ones((1, 1, 1)), spacing=(0.5, 0.5, 1.0))
    allowed = [float(length) for length in str(error.value).rpartition("up to ")[2].split(" x ")]
    assert allowed[2] > 1.04
    made(np.ones((1, 1, 1)), spacing=tuple(allowed))
    with pytest.raises(OptionError, match="not all completely well centered"):
        made(np.ones((1, 1, 1)), spacing=(1, 1, allowed[2] + 2e-4))


@pytest.mark.parametrize(
    ("voxels", "message"),
    [
        (np.zeros((2, 3, 4)), "all of the 24 voxels are 0; at least one must not be"),
        (np.zeros((2, 0, 4)), "all of the 0 voxels are 0"),
        (np.indices((4, 4, 4)).sum(axis=0) % 2, r"voxels \(0, 0, 1\) and \(0, 1, 0\) touch only along an edge"),
        ([[[0.0, 1.0], [0.4, 1.0]]], r"voxel \(0, 1, 0\) is 0.4; allowed are whole numbers from 0"),
        ([[[0, 1], [-3, 1]]], r"voxel \(0, 1, 0\) is -3; allowed"),
        ([[[np.nan, np.inf]]], r"voxel \(0, 0, 0\) is nan \(and 1 more\)"),
        ([[[1, 2**40]]], r"voxel \(0, 0, 1\) is 1.09951e\+12; allowed are whole numbers from 0 to 2147483647"),
        (np.ones((2, 2)), r"the voxels have shape \(2, 2\); allowed are three axes"),
        (np.array([[["a"]]]), "the voxels have dtype <U1; allowed"),
    ],
)
def test_voxels_of_no_use_are_refused(voxels, message):
    with pytest.raises(InputError, match=f"^filters.create_from_voxels: {message}"):
        made(voxels)


@pytest.mark.parametrize("spacing", [0, -1.0, (1, 2), "1,1", "wide", (1, 1, np.inf), None])
def test_spacings_of_no_use_are_refused(spacing):
    with pytest.raises(OptionError, match=r"option 'spacing' is .*; must be a length > 0, or three of them"):
        made(np.ones((1, 1, 1)), spacing=spacing)


def test_neither_array_nor_name_is_refused():
    with pytest.raises(OptionError, match="option 'voxels' is 3; must be an array or the name of a file or folder"):
        wct.apply_filter("create_from_voxels", voxels=3)


def test_on_the_command_line(tmp_path, capsys):
    file, target = tmp_path / "ring.npy", tmp_path / "ring.vtu"
    np.save(file, ring())
    assert main.run(["create", "from_voxels", str(target), "--voxels", str(file), "--spacing", "2,2,2"]) == 0
    assert len(wct.read(target).tets) == 8 * 194
    capsys.readouterr()
    np.save(file, np.eye(2)[None])
    line = refused(capsys, "create", "from_voxels", tmp_path / "no.vtu", "--voxels", file)
    assert line == (
        f"filters.create_from_voxels: {file}: voxels (0, 0, 0) and (0, 1, 1) touch only along an edge; "
        "what touches must share a face"
    )
    assert "option 'voxels' is missing" in refused(capsys, "create", "from_voxels", tmp_path / "no.vtu")


_CHILD = """
import resource, numpy as np, wct_plugin as wct
peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
wct.apply_filter("create_from_voxels", voxels=np.ones((1, 1, 1)))
before = peak()
mesh, _ = wct.apply_filter("create_from_voxels", voxels=np.ones((16, 16, 16), dtype=np.uint8))
print((peak() - before) / (mesh.points.nbytes + mesh.tets.nbytes + mesh.regions.nbytes))
"""


def test_memory_stays_within_three_times_the_output():
    done = subprocess.run([sys.executable, "-c", _CHILD], capture_output=True, text=True, check=True)
    assert float(done.stdout) < 3
