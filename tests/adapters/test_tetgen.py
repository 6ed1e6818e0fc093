"""TetGen itself, program and Python package: what it fills and keeps, must not be asked, and how it is stopped."""

import itertools
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.builders import rotation, sphere_surface, two_region_cube
from support.processes import wait_until, working_in

from wct_plugin.adapters import tetgen_programs
from wct_plugin.adapters.tetgen import _Job, _write, tetrahedralize
from wct_plugin.errors import InputError, NeighbourError, OptionError
from wct_plugin.mesh import SurfaceMesh, TetMesh

CORNERS = np.array(list(itertools.product((0.0, 1.0), repeat=3)))
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
FACES = np.array([face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))])
INWARD = FACES[:, ::-1]


@pytest.fixture(autouse=True)
def scratch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where TetGen works; nothing may stay behind, neither files nor processes."""
    folder = tmp_path / "scratch"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.fixture(autouse=True, params=["program", "package"])
def program(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> tetgen_programs.Program:
    """Debian's TetGen, and the one that is found where that is not on the PATH."""
    if request.param == "package":
        which = shutil.which
        monkeypatch.setattr(tetgen_programs.shutil, "which", lambda name: None if name == "tetgen" else which(name))
    return tetgen_programs.find()


#: For what does not depend on which it is.
ONE_PROGRAM = pytest.mark.parametrize("program", ["program"], indirect=True)


def assert_clean(folder: Path) -> None:
    wait_until(lambda: not working_in(folder), 2)
    assert list(folder.iterdir()) == []


def cubes(*placed: tuple[float, np.ndarray]) -> SurfaceMesh:
    """Concentric cubes of these sizes, each with its own list of faces."""
    points = np.vstack([0.5 + size * (CORNERS - 0.5) for size, _ in placed])
    return SurfaceMesh(points, np.vstack([faces + 8 * k for k, (_, faces) in enumerate(placed)]), source="box.stl")


CUBE = cubes((1.0, FACES))


def volumes(mesh: TetMesh) -> dict[int, float]:
    """Volume by region."""
    size = np.linalg.det(mesh.points[mesh.tets[:, 1:]] - mesh.points[mesh.tets[:, :1]]) / 6
    assert size.min() > 0
    return {int(region): float(size[mesh.regions == region].sum()) for region in np.unique(mesh.regions)}


def areas(points: np.ndarray, triangles: np.ndarray, tags: np.ndarray) -> dict[int, float]:
    """Area by tag."""
    corners = points[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    return {int(tag): float(area[tags == tag].sum()) for tag in np.unique(tags)}


def rows(triangles: np.ndarray) -> set[tuple[int, ...]]:
    return {tuple(sorted(row)) for row in triangles.tolist()}


def refusal(surface: SurfaceMesh, **options: Any) -> str:
    with pytest.raises(InputError) as caught:
        tetrahedralize(surface, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


# --- what it fills --------------------------------------------------------------------------------------------------


def test_a_cube(capfd: pytest.CaptureFixture[str], tmp_path: Path, scratch: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    mesh = tetrahedralize(CUBE, edge_length=0.2)
    assert volumes(mesh) == pytest.approx({0: 1.0}, rel=1e-14)
    edge = 0.2 * np.sqrt(3)
    size = np.linalg.det(mesh.points[mesh.tets[:, 1:]] - mesh.points[mesh.tets[:, :1]]) / 6
    assert size.max() <= edge**3 / np.sqrt(72) * (1 + 1e-9)
    assert (mesh.reference, mesh.source) == (CUBE, "box.stl")
    assert not mesh.repairs
    assert not len(mesh.facets)
    assert len(mesh.topology.half_facets[1]) == len(mesh.topology.boundary)  # raises where three tets share a facet
    assert capfd.readouterr() == ("", "")
    assert os.listdir(tmp_path) == ["scratch"]
    assert_clean(scratch)


def test_a_curved_surface_is_kept_to_the_last_digit() -> None:
    """TetGen alone takes facets that bend by less than 0.1 degrees for flat ones, and leaves both."""
    ball = sphere_surface(300)
    surface = SurfaceMesh(ball.points @ rotation(1) * np.pi + 1e3, ball.triangles)
    mesh = tetrahedralize(surface, edge_length=0.06)
    given, made = {tuple(point) for point in surface.points.tolist()}, {tuple(point) for point in mesh.points.tolist()}
    assert given < made
    corners = surface.points[surface.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    skin = mesh.points[mesh.topology.boundary_points]
    assert len(skin) > len(given)
    heights = np.abs(np.einsum("ijk,jk->ij", skin[:, None] - corners[:, 0], normals))
    assert heights.min(axis=1).max() < 1e-12 * 1e3
    (wanted,) = areas(surface.points, surface.triangles, surface.tags).values()
    assert areas(mesh.points, mesh.topology.boundary, np.zeros(len(mesh.topology.boundary)))[0] == pytest.approx(wanted)


def test_keep_boundary() -> None:
    ball = sphere_surface(150)
    mesh = tetrahedralize(ball, edge_length=0.1, keep_boundary=True)
    skin = mesh.boundary_surface()
    assert {tuple(sorted(map(tuple, corners))) for corners in skin.points[skin.triangles].tolist()} == {
        tuple(sorted(map(tuple, corners))) for corners in ball.points[ball.triangles].tolist()
    }
    assert not mesh.topology.boundary_points.all()


def test_quality_options() -> None:
    def ratios(**options: float) -> np.ndarray:
        mesh = tetrahedralize(SurfaceMesh(CORNERS * [1, 1, 0.2], FACES), edge_length=1, **options)
        corners = mesh.points[mesh.tets]
        sides = corners[:, 1:] - corners[:, :1]
        centers = np.linalg.solve(2 * sides, np.einsum("ijk,ijk->ij", sides, sides)[..., None])[..., 0]
        pairs = [corners[:, a] - corners[:, b] for a, b in itertools.combinations(range(4), 2)]
        ratio: np.ndarray = np.linalg.norm(centers, axis=1) / np.linalg.norm(pairs, axis=2).min(axis=0)
        return ratio

    assert ratios(radius_edge=1.2).max() <= 1.2 * (1 + 1e-9)
    assert ratios(radius_edge=4.0, min_dihedral=0.0).max() > 2


@ONE_PROGRAM
@pytest.mark.parametrize("scale", [1e-30, 1e-6, 1e30])
def test_any_unit(scale: float) -> None:
    mesh = tetrahedralize(SurfaceMesh(CORNERS * scale, FACES), edge_length=0.3)
    assert volumes(mesh)[0] == pytest.approx(scale**3)


def test_points_that_coincide_or_that_no_triangle_uses() -> None:
    soup = SurfaceMesh(np.vstack([[9.0, 9, 9], CORNERS[FACES].reshape(-1, 3)]), np.arange(1, 37).reshape(-1, 3))
    mesh = tetrahedralize(soup, edge_length=0.3)
    assert volumes(mesh) == pytest.approx({0: 1.0})
    assert not mesh.repairs


# --- regions and tags -----------------------------------------------------------------------------------------------


def test_any_tag_comes_back() -> None:
    tags = np.array([-3, -3, 0, 0, 5, 5, 10**9, 10**9, 7, 7, -(2**40), 2])
    mesh = tetrahedralize(SurfaceMesh(CORNERS, FACES, tags), edge_length=0.2)
    assert areas(mesh.points, mesh.facets.vertices, mesh.facets.tags) == pytest.approx(areas(CORNERS, FACES, tags))
    assert rows(mesh.facets.vertices) == rows(mesh.topology.boundary)
    bottom = mesh.points[mesh.facets.vertices[mesh.facets.tags == -3]]
    assert len(bottom) > 2
    assert (bottom[..., 0] == 0).all()


def two_rooms(tags: tuple[int, int]) -> SurfaceMesh:
    """The unit cube with a wall at z = 1/2; tags of the outside and of the wall."""
    solid = two_region_cube(2)
    outside, wall = solid.topology.boundary, solid.topology.interfaces
    return SurfaceMesh(
        solid.points, np.vstack([outside, wall]), np.repeat(tags, [len(outside), len(wall)]), source="rooms.stl"
    )


def test_a_wall_makes_two_regions_and_is_no_part_of_the_reference() -> None:
    surface = two_rooms((4, -9))
    mesh = tetrahedralize(surface, edge_length=0.15)
    assert volumes(mesh) == pytest.approx({1: 0.5, 2: 0.5})
    assert rows(mesh.facets.vertices[mesh.facets.tags == -9]) == rows(mesh.topology.interfaces)
    assert rows(mesh.facets.vertices[mesh.facets.tags == 4]) == rows(mesh.topology.boundary)
    below = mesh.points[mesh.tets].mean(axis=1)[:, 2] < 0.5
    assert len(np.unique(mesh.regions[below])) == 1
    assert mesh.reference is not None
    assert (mesh.reference.tags == 4).all()
    assert mesh.reference.source == "rooms.stl"
    assert len(mesh.reference.triangles) == (surface.tags == 4).sum()
    assert not len(tetrahedralize(two_rooms((0, 0)), edge_length=0.3).facets)


def test_a_sheet_inside_is_kept_without_a_tag() -> None:
    sheet = np.array([[0.3, 0.3, 0.5], [0.6, 0.3, 0.5], [0.3, 0.6, 0.5]])
    surface = SurfaceMesh(np.vstack([CORNERS, sheet]), np.vstack([FACES, [[8, 9, 10]]]))
    mesh = tetrahedralize(surface, edge_length=0.3)
    assert set(volumes(mesh)) == {0}
    assert areas(mesh.points, mesh.facets.vertices, mesh.facets.tags) == pytest.approx({0: 0.045})
    assert not rows(mesh.facets.vertices) & rows(mesh.topology.boundary)


def test_inner_surfaces_that_face_outward_are_inclusions_and_inward_hollows() -> None:
    assert volumes(tetrahedralize(cubes((1.0, FACES), (0.4, FACES)), edge_length=0.2)) == pytest.approx(
        {1: 0.936, 2: 0.064}
    )
    hollow = tetrahedralize(cubes((1.0, FACES), (0.4, INWARD)), edge_length=0.2)
    assert volumes(hollow) == pytest.approx({0: 0.936})
    assert not hollow.repairs
    assert hollow.reference is not None
    assert len(hollow.reference.triangles) == 24
    inside_out = tetrahedralize(cubes((1.0, INWARD)), edge_length=0.3)
    assert volumes(inside_out) == pytest.approx({0: 1.0})


def test_cospherical_points_on_which_tetgen_trips() -> None:
    """In the given order TetGen fails on an assertion of its own; in others it does not."""
    mesh = tetrahedralize(cubes((1.0, FACES), (0.4, INWARD), (0.2, FACES)), edge_length=0.2)
    assert volumes(mesh) == pytest.approx({1: 0.936, 2: 0.008})


def prism(sides: int, turn: np.ndarray) -> SurfaceMesh:
    """A prism on a regular polygon of radius 1, height 1, turned so that its caps are flat but for rounding."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(sides)])
    cap = [(0, k + 1, k) for k in range(1, sides - 1)]
    wall = [((k + 1) % sides, k, sides + k) for k in range(sides)]
    wall = [*wall, *(((k + 1) % sides, sides + k, sides + (k + 1) % sides) for k in range(sides))]
    faces = [*cap, *((sides + a, sides + c, sides + b) for a, b, c in cap), *((b, a, c) for a, b, c in wall)]
    return SurfaceMesh(np.vstack([ring, ring + np.array([0, 0, 1])]) @ turn, np.array(faces))


@pytest.mark.filterwarnings("ignore:TetGen could not split the surface's triangles")
@ONE_PROGRAM
@pytest.mark.parametrize("seed", range(8))
def test_turned_prisms(seed: int) -> None:
    """Cospherical rings on nearly flat caps: TetGen gives up on several of them in any one order."""
    mesh = tetrahedralize(prism(24, rotation(seed)), edge_length=0.2)
    assert volumes(mesh) == pytest.approx({0: 12 * np.sin(np.pi / 12)})


def test_the_same_bits_every_time() -> None:
    one, two = (tetrahedralize(sphere_surface(80), edge_length=0.15) for _ in range(2))
    assert one.points.tobytes() == two.points.tobytes()
    assert one.tets.tobytes() == two.tets.tobytes()


# --- what it must not be asked --------------------------------------------------------------------------------------


def test_open_surfaces(scratch: Path) -> None:
    edge = r"it is open: the edge from (0, 0, 0) to (0, 0, 1) is a side of triangle 4 only (and 2 more)"
    assert refusal(SurfaceMesh(CORNERS, FACES[1:], source="a.stl")) == (f"a.stl: the surface encloses nothing, {edge}")
    half = SurfaceMesh(np.vstack([CORNERS + 3, CORNERS]), np.vstack([FACES, FACES[1:] + 8]))
    assert refusal(half, edge_length=0.3) == (
        "47.8 % of the surface's area bounds nothing; it is open: "
        "the edge from (0, 0, 0) to (0, 0, 1) is a side of triangle 16 only (and 2 more)"
    )
    assert_clean(scratch)


def test_a_surface_that_intersects_itself(scratch: Path, program: tetgen_programs.Program) -> None:
    crossing = SurfaceMesh(np.vstack([CORNERS, CORNERS + 0.5]), np.vstack([FACES, FACES + 8]), source="two.stl")
    message = refusal(crossing)
    assert re.match(
        r"two\.stl: the surface intersects itself: (at )?triangle \d+, \(\S+, \S+, \S+\) (and|\(and) ", message
    )
    assert "mesher 'ftetwild' does not" in message
    touching = SurfaceMesh(np.vstack([CORNERS, CORNERS / 2 + [0.25, 0.25, 1]]), np.vstack([FACES, FACES + 8]))
    assert "intersects itself" in refusal(touching)
    on_an_edge = SurfaceMesh(np.vstack([CORNERS, [[0, 0, 0.5]]]), np.vstack([FACES, [[0, 1, 8]]]))
    where = "triangle 0, (0, 0.333333, 0.666667) " + (
        "(and 2 more triangles)" if program.limits_itself else "and triangle 12, (0, 0, 0.5)"
    )
    assert where in refusal(on_an_edge)
    assert_clean(scratch)


def test_triangles_that_repeat_or_collapse_and_points_too_close() -> None:
    assert "triangle 12 repeats triangle 3" in refusal(SurfaceMesh(CORNERS, np.vstack([FACES, FACES[3:4, ::-1]])))
    assert "two corners at (0, 0, 1)" in refusal(SurfaceMesh(CORNERS, np.vstack([FACES, [[0, 1, 1]]])))
    thin = refusal(SurfaceMesh(CORNERS * [1, 1, 3e-9], FACES))
    assert "are 3.0e-09 apart, too close for TetGen" in thin or "its points lie in a plane as far as TetGen" in thin


def test_planar_surfaces_and_bad_indices() -> None:
    flat = SurfaceMesh(CORNERS * [1, 1, 0], FACES[4:6], source="flat.stl")
    assert refusal(flat) == (
        "flat.stl: the surface is planar, 0.0e+00 of its diagonal thick; TetGen needs one that encloses a volume"
    )
    with pytest.raises(InputError, match=r"triangle 0 is \(0, 1, 99\); indices must lie in 0\.\.7"):
        tetrahedralize(SurfaceMesh(CORNERS, [[0, 1, 99]]))


@ONE_PROGRAM
@pytest.mark.parametrize(
    ("option", "value", "allowed"),
    [
        ("edge_length", 0, "above 0, at most 1"),
        ("edge_length", float("nan"), "above 0, at most 1"),
        ("radius_edge", 0.9, "at least 1"),
        ("radius_edge", float("inf"), "at least 1"),
        ("min_dihedral", 61, "0 to 60"),
        ("min_dihedral", float("nan"), "0 to 60"),
        ("timeout", 0, "a number of seconds above 0, or None"),
        ("memory_limit", -1, "a number of megabytes above 0, or None"),
    ],
)
def test_options_out_of_range(option: str, value: float, allowed: str) -> None:
    with pytest.raises(OptionError) as caught:
        tetrahedralize(CUBE, **{option: value})
    assert str(caught.value) == f"{option} is {value}; allowed is {allowed}"


# --- failures of TetGen itself --------------------------------------------------------------------------------------


def test_a_hang_is_ended_by_the_timeout(scratch: Path) -> None:
    start = time.monotonic()
    with pytest.raises(
        NeighbourError, match=r"^TetGen was stopped after [01](\.\d+)? s, its timeout; a larger edge_len"
    ):
        tetrahedralize(sphere_surface(100), radius_edge=1.0, min_dihedral=60, timeout=1)  # no such mesh: it never ends
    assert time.monotonic() - start < 10
    assert_clean(scratch)


def test_out_of_memory(scratch: Path) -> None:
    with pytest.raises(NeighbourError, match=r"^TetGen ran out of memory in '.*': memory_limit is 50 MB; a larger "):
        tetrahedralize(sphere_surface(100), edge_length=1e-3, memory_limit=50)
    with pytest.raises(NeighbourError, match=r"^TetGen ran out of memory in .*: memory_limit is 1 MB; "):
        tetrahedralize(CUBE, memory_limit=1)
    assert_clean(scratch)


@ONE_PROGRAM
def test_tetgen_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The package does where there is no program, and both are named where there is neither."""
    assert re.fullmatch(r"1\.[56]\S* \(/\S+/tetgen\)", tetgen_programs.find().version)
    monkeypatch.setenv("PATH", str(tmp_path))
    package = tetgen_programs.find()
    assert package.version == f"1.6 (Python package tetgen {metadata.version('tetgen')})"
    assert package.start[0] == sys.executable
    monkeypatch.setattr(tetgen_programs, "find_spec", lambda _: None)
    with pytest.raises(NeighbourError, match=r"^there is no TetGen: .* apt install tetgen\).* \(pip install tetgen\)$"):
        tetrahedralize(CUBE)


def test_a_full_disk(small_disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(small_disk))
    with pytest.raises(NeighbourError, match=r"^TetGen"):
        tetrahedralize(sphere_surface(100), edge_length=0.05)
    assert list(small_disk.iterdir()) == []
    with pytest.raises(NeighbourError, match=r"^TetGen cannot be given the surface: No space left on device$"):
        tetrahedralize(sphere_surface(2000))


@ONE_PROGRAM
def test_what_it_says_of_files_that_we_never_write(tmp_path: Path, program: tetgen_programs.Program) -> None:
    _write(
        tmp_path / "surface.poly", np.vstack([CORNERS, [[0, 0, 0.5]]]), np.vstack([FACES, [[0, 1, 8]]]), np.arange(13)
    )
    touching = (tmp_path / "surface.poly").read_text()
    for text, said in (
        ("3 3 0 0\n0 a b c\n", r"^TetGen: Point 0 has no x coordinate$"),
        ("2 3 0 0\n0 0 0 0\n1 1 1 1\n", r"^TetGen: "),
        (touching, r"^TetGen: Found two facets intersect each other\. 1st: \[0, 1, 3\] #1 2nd: \[0, 1, 8\] #13$"),
        (None, r"^TetGen: Cannot access file surface\.poly"),
    ):
        (tmp_path / "surface.poly").unlink(missing_ok=True)
        if text:
            (tmp_path / "surface.poly").write_text(text)
        with pytest.raises(NeighbourError, match=said) as caught:
            _Job(program, tmp_path, None, None).run("-pz")
        assert "\n" not in str(caught.value)


def test_ctrl_c_ends_it(scratch: Path) -> None:
    code = (
        "import tempfile, sys; tempfile.tempdir = sys.argv[1]; from support.builders import sphere_surface; "
        "from wct_plugin.adapters.tetgen import tetrahedralize; "
        "tetrahedralize(sphere_surface(100), edge_length=2e-3)"
    )
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])}
    with subprocess.Popen([sys.executable, "-c", code, scratch], env=environment, stderr=subprocess.PIPE) as python:
        wait_until(lambda: any("tetgen" in command and " -pz" in command for command in working_in(scratch)))
        python.send_signal(signal.SIGINT)
        assert b"KeyboardInterrupt" in python.communicate(timeout=20)[1]
    assert_clean(scratch)
