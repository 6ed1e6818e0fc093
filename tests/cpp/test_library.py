"""The C++ library without Python: built and installed by CMake, found by find_package, called by programs of its own.

What it makes is judged by the package's NumPy: strata, quality, volumes.
"""

import subprocess
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.builders import ball, cylinder, jittered_cube, kuhn_cube, l_shape, shaken_cube, two_region_cube
from support.core_build import ROOT, build, built_core, run, run_cmake

from wct_plugin.measure.quality import measure
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import find_strata


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the library is installed."""
    folder = tmp_path_factory.mktemp("installed")
    run_cmake("--install", built_core(), "--prefix", folder)
    return folder


def test_what_is_installed(installed):
    files = {path.relative_to(installed).as_posix() for path in installed.rglob("*") if path.is_file()}
    package = {f"cmake/wct/wct{name}.cmake" for name in ("Config", "ConfigVersion", "Targets", "Targets-release")}
    below = {name.split("/", 1)[1] for name in files if name.startswith("lib")}
    assert {name for name in files if not name.startswith("lib")} == {"include/wct/well_center.h"}
    assert {name.removeprefix("x86_64-linux-gnu/") for name in below} == {"libwct.a", *package}


def test_it_has_the_version_of_the_package(installed):
    (file,) = installed.rglob("wctConfigVersion.cmake")
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert f'set(PACKAGE_VERSION "{version}")' in file.read_text()


def test_the_header_needs_nothing_of_ours(installed):
    text = (installed / "include/wct/well_center.h").read_text()
    assert [line for line in text.splitlines() if line.startswith("#include") and "<" not in line] == []


def test_the_example(installed, tmp_path):
    example = build(ROOT / "examples/cpp", tmp_path / "example", f"-DCMAKE_PREFIX_PATH={installed}")
    before, after = run(example / "well_center").splitlines()
    assert before == "before: 333 of 384 tets do not contain their circumcenter"
    assert after.startswith("after:  0 of ")


@dataclass(frozen=True)
class Made:
    """What the program has written."""

    folder: Path
    said: dict[str, float]

    def array(self, name: str, columns: int = 0, kind: Any = np.int32) -> Any:
        values = np.fromfile(self.folder / name, dtype=kind)
        return values.reshape(-1, columns) if columns else values

    @property
    def mesh(self) -> TetMesh:
        return TetMesh(self.array("new_points", 3, float), self.array("new_tets", 4), self.array("new_regions"))

    @property
    def bits(self) -> tuple[bytes, ...]:
        names = ("new_points", "new_tets", "new_regions", "facets", "patch", "creases", "curve", "corners")
        return tuple((self.folder / name).read_bytes() for name in names)


Call = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="module")
def program(installed: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("program")
    source = ROOT / "tests/support/library_program"
    return build(source, folder, f"-DCMAKE_PREFIX_PATH={installed}") / "library_program"


@pytest.fixture
def call(program: Path, tmp_path_factory: pytest.TempPathFactory) -> Call:
    def called(job: str, points: Any, tets: Any, regions: Any = (), **options: Any) -> Any:
        folder = tmp_path_factory.mktemp("arrays")
        np.asarray(points, dtype=float).tofile(folder / "points")
        np.asarray(tets, dtype=np.int32).tofile(folder / "tets")
        np.asarray(regions, dtype=np.int32).tofile(folder / "regions")
        words = [f"{name}={value}" for name, value in options.items()]
        done = subprocess.run([program, job, folder, *words], capture_output=True, text=True)
        return done, folder

    return called


@pytest.fixture
def make(call: Call) -> Callable[..., Made]:
    def made(job: str, mesh: TetMesh, **options: Any) -> Made:
        done, folder = call(job, mesh.points, mesh.tets, mesh.regions, **options)
        assert done.returncode == 0, done.stderr
        return Made(folder, {line.split()[0]: float(line.split()[1]) for line in done.stdout.splitlines()})

    return made


def layers() -> TetMesh:
    """The unit cube, region 7 in the lower half and 3 above; the tets of both in any order."""
    cube = kuhn_cube(6)
    tets = cube.tets[np.random.default_rng(5).permutation(len(cube.tets))]
    return TetMesh(cube.points, tets, np.where(cube.points[tets, 2].max(axis=1) > 0.5, 3, 7))


SHAPES = {
    "cube": kuhn_cube(3),
    "jittered": jittered_cube(4),
    "l": l_shape(2),
    "ball": ball(5),
    "regions": two_region_cube(2),
    "layers": layers(),
    "cylinder": cylinder(24, 4),
    "noise": shaken_cube(5, amount=0.2),
    "far": TetMesh(kuhn_cube(2).points * 1e-60 + 1e-58, kuhn_cube(2).tets),
}


@pytest.mark.parametrize("angle", [12.0, 40.0])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_surface_is_cut_as_in_python(make, shape, angle):
    mesh = SHAPES[shape]
    found, expected = make("surface", mesh, crease_angle=angle), find_strata(mesh, angle)
    facets = found.array("facets", 3)
    assert np.array_equal(np.sort(facets, axis=1), np.sort(expected.triangles, axis=1))
    outer = len(mesh.topology.boundary)
    assert np.array_equal(facets[:outer], expected.triangles[:outer])
    assert np.array_equal(found.array("patch"), expected.patch)
    assert np.array_equal(found.array("creases", 2), expected.segments)
    assert np.array_equal(found.array("curve"), expected.curve)
    assert np.array_equal(found.array("corners"), np.flatnonzero(expected.stratum == 3))


def test_sides_of_patches(make):
    mesh = layers()
    found = make("surface", mesh)
    facets, sides = found.array("facets", 3), found.array("sides", 3)[found.array("patch")]
    corners = mesh.points[facets]
    heights = corners[:, :, 2]
    between = (heights == 0.5).all(axis=1)
    assert between.sum() == 72
    assert (sides[between] == [3, 1, 7]).all()
    assert (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[between, 2] < 0).all()
    assert (sides[~between, 1] == 0).all()
    assert (sides[(heights[:, 0] > 0.5) & ~between, 0] == 3).all()


def good(mesh: TetMesh) -> bool:
    return bool(measure(mesh).completely_well_centered.all())


def patch_areas(points: Any, facets: Any, patch: Any) -> Any:
    corners = points[facets]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    return np.bincount(patch, area)


def test_layers_come_out_well_centered(make):
    mesh = layers()
    before, made = make("surface", mesh), make("well_center", mesh, goal="3wc")
    assert made.said["bad_before"] == (~measure(mesh).well_centered_3).sum() > 0
    assert made.said["bad_after"] == made.said["facets_off"] == made.said["kept"] == made.said["stopped"] == 0
    assert made.said["reached"] == 1
    new = made.mesh
    assert not new.repairs
    assert measure(new).well_centered_3.all()
    for tag, volume in ((7, 0.5), (3, 0.5)):
        corners = new.points[new.tets[new.regions == tag]]
        got = np.linalg.det(corners[:, 1:] - corners[:, :1]).sum() / 6
        assert got == pytest.approx(volume, rel=1e-12)
        assert made.said[f"volume_{tag}_before"] == pytest.approx(volume, rel=1e-12)
        assert made.said[f"volume_{tag}_after"] == pytest.approx(got, rel=1e-12)
    facets, patch = made.array("facets", 3), made.array("patch")
    assert len(facets) == len(new.topology.boundary) + len(new.topology.interfaces)
    assert np.array_equal(made.array("sides"), before.array("sides"))
    old = patch_areas(mesh.points, before.array("facets", 3), before.array("patch"))
    assert patch_areas(new.points, facets, patch) == pytest.approx(old, rel=1e-12)
    for k in range(len(old)):  # each patch is in the plane where it was
        was, now = mesh.points[before.array("facets", 3)[before.array("patch") == k]], new.points[facets[patch == k]]
        (axis,) = np.flatnonzero(np.ptp(was, axis=(0, 1)) == 0)
        assert (now[:, :, axis] == was[0, 0, axis]).all()


def test_a_ball_stays_round(make):
    mesh = ball(5)
    made = make("well_center", mesh, tolerance=1e-2)
    assert made.said["reached"] == 1
    assert good(made.mesh)
    radius = np.linalg.norm(made.mesh.points[made.mesh.topology.boundary_points], axis=1)
    assert abs(radius - 1.0).max() < 1e-2 * np.linalg.norm(np.ptp(mesh.points, axis=0)) + 0.02  # its facets' own depth
    assert made.said["volume_0_after"] == pytest.approx(made.said["volume_0_before"], rel=1e-2)


def test_the_same_bits_on_any_number_of_threads(make):
    mesh = ball(4)
    one, *others = [make("well_center", mesh, tolerance=2e-2, threads=threads) for threads in (1, 2, 5)]
    assert all(other.bits == one.bits for other in others)
    assert make("well_center", mesh, tolerance=2e-2, seed=1).bits != one.bits


@pytest.mark.parametrize("power", [-290, 290])
def test_the_unit_of_length_is_no_matter(make, power):
    mesh = kuhn_cube(4)
    large = TetMesh(np.ldexp(mesh.points, power), mesh.tets)
    one, other = make("well_center", mesh), make("well_center", large)
    assert np.array_equal(np.ldexp(one.mesh.points, power), other.mesh.points)
    assert one.bits[1:] == other.bits[1:]


def test_a_mesh_that_meets_the_goal_stays_to_the_bit(make):
    once = make("well_center", kuhn_cube(4)).mesh
    again = make("well_center", once)
    assert again.said["kept"] == again.said["reached"] == 1
    assert again.said["starts"] == 0
    assert again.mesh.points.tobytes() == once.points.tobytes()
    assert np.array_equal(again.mesh.tets, once.tets)


def test_an_edge_length_makes_it_anew(make):
    coarse, fine = (make("well_center", kuhn_cube(4), edge_length=length) for length in (0.25, 0.12))
    assert good(coarse.mesh)
    assert good(fine.mesh)
    assert len(fine.mesh.tets) > 5 * len(coarse.mesh.tets)


def test_a_limit_of_tets_holds(make):
    made = make("well_center", kuhn_cube(4), edge_length=0.1, max_tets=400)
    assert len(made.mesh.tets) <= 400


@pytest.mark.parametrize("calls", [0, 1, 3, 12, 40])
def test_stopped_it_gives_a_mesh_that_is_no_worse(make, calls):
    mesh = kuhn_cube(4)
    made = make("well_center", mesh, stop_at=calls)
    assert made.said["stopped"] == 1
    new = made.mesh
    assert not new.repairs
    bad = (~measure(new).completely_well_centered).mean()
    assert bad <= (~measure(mesh).completely_well_centered).mean()
    if made.said["kept"]:
        assert np.array_equal(new.points, mesh.points)
        assert np.array_equal(new.tets, mesh.tets)


TET = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TWO = np.vstack([TET, [0.3, 0.3, -1.0]])
BACK = np.vstack([TET, [0.2, 0.2, 0.3]])


@pytest.mark.parametrize(
    ("points", "tets", "regions", "options", "said"),
    [
        (TET, [], [], {}, "the mesh has no tets"),
        (TET, [[0, 1, 2, 4]], [], {}, "tet 0 names point 4; there are 4"),
        (TET, [[0, 1, 2, -1]], [], {}, "tet 0 names point -1; there are 4"),
        (TET, [[0, 1, 2, 2]], [], {}, "tet 0 has point 2 twice"),
        (TET, [[1, 0, 2, 3]], [], {}, "tet 0 is inverted or flat"),
        (TET * [1, 1, 0], [[0, 1, 2, 3]], [], {}, "tet 0 is inverted or flat"),
        (np.where(TET == 1, np.nan, TET), [[0, 1, 2, 3]], [], {}, "point 1 is not finite"),
        (np.where(TET == 1, np.inf, TET), [[0, 1, 2, 3]], [], {}, "point 1 is not finite"),
        (TET, [[0, 1, 2, 3]], [1, 2], {}, "regions has length 2; there are 1 tets"),
        (TET * 1e91, [[0, 1, 2, 3]], [], {}, "the bounding box's diagonal is not between 1e-90 and 1e90"),
        (TET * 1e-91, [[0, 1, 2, 3]], [], {}, "the bounding box's diagonal is not between 1e-90 and 1e90"),
        (
            TWO,
            [[0, 1, 2, 3], [0, 2, 1, 4], [0, 1, 2, 3]],
            [],
            {},
            "facet (0, 1, 2) belongs to tets 0, 1 and 2; at most",
        ),
        (BACK, [[0, 1, 2, 3], [0, 1, 2, 4]], [], {}, "tets 0 and 1 lie on the same side of facet (0, 1, 2)"),
        (TET, [[0, 1, 2, 3]], [], {"tolerance": 0.2}, "tolerance is 0.200000; allowed is above 0, at most 0.1"),
        (TET, [[0, 1, 2, 3]], [], {"tolerance": "nan"}, "tolerance is nan; allowed is above 0, at most 0.1"),
        (TET, [[0, 1, 2, 3]], [], {"edge_length": 0}, "edge_length is 0.000000; allowed is a finite length above 0"),
        (TET, [[0, 1, 2, 3]], [], {"crease_angle": 180}, "crease_angle is 180.000000; allowed is above 0, below 180"),
        (TET, [[0, 1, 2, 3]], [], {"margin": -1}, "margin is -1.000000; allowed is 0 to 0.1"),
        (TET, [[0, 1, 2, 3]], [], {"effort": 0}, "effort is 0.000000; allowed is 1 to 100"),
        (TET, [[0, 1, 2, 3]], [], {"max_tets": 0}, "max_tets is 0.000000; allowed is at least 1"),
    ],
)
def test_what_is_wrong_is_named_in_one_line(call, points, tets, regions, options, said):
    done, _ = call("well_center", points, tets, regions, **options)
    assert done.returncode == 2
    assert done.stderr.startswith(said)
    assert done.stderr.count("\n") == 1


def test_points_of_no_tet_do_not_matter(make, call):
    mesh = kuhn_cube(4)
    points = np.insert(mesh.points, 5, [np.nan, 7.0, 1e300], axis=0)
    tets = mesh.tets + (mesh.tets >= 5)
    done, folder = call("well_center", points, tets)
    assert done.returncode == 0
    assert np.fromfile(folder / "new_points").tobytes() == make("well_center", mesh).mesh.points.tobytes()
    _, folder = call("surface", points, tets)
    assert np.array_equal(
        np.fromfile(folder / "corners", dtype=np.int32), np.flatnonzero(np.isin(points, [0.0, 1.0]).all(axis=1))
    )
