"""The real fTetWild: what it fills, what it must not be asked, and how it is stopped."""

import itertools
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from wct_plugin.adapters.ftetwild import _run, tetrahedralize
from wct_plugin.errors import InputError, NeighbourError, OptionError
from wct_plugin.mesh import SurfaceMesh

FAST: dict[str, Any] = {"edge_length": 0.3, "num_opt_iter": 3, "epsilon": 1e-2}


def box(size: float = 1.0) -> SurfaceMesh:
    points = size * np.array(list(itertools.product((0.0, 1.0), repeat=3)))
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return SurfaceMesh(
        points, np.array([face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]), source="box.stl"
    )


def sphere(rounds: int) -> SurfaceMesh:
    """An octahedron, each triangle cut in four so many times, on the unit sphere."""
    corners = np.vstack([np.eye(3), -np.eye(3)])[[0, 1, 2, 3, 4, 5]]
    faces = np.array([(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)])
    soup = corners[faces]
    for _ in range(rounds):
        a, b, c = soup[:, 0], soup[:, 1], soup[:, 2]
        ab, bc, ca = a + b, b + c, c + a
        soup = np.concatenate([np.stack(new, axis=1) for new in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
        soup /= np.linalg.norm(soup, axis=2, keepdims=True)
    points, inverse = np.unique(soup.reshape(-1, 3).round(12), axis=0, return_inverse=True)
    return SurfaceMesh(points, inverse.reshape(-1, 3))


def children() -> set[int]:
    """Processes started by this one that still run the mesher."""
    found = set()
    for process in Path("/proc").glob("[0-9]*"):
        try:
            parent = (process / "stat").read_text().rpartition(")")[2].split()[1]
            command = (process / "cmdline").read_bytes()
        except OSError:  # it has ended meanwhile
            continue
        if parent == str(os.getpid()) and b"adapters.ftetwild" in command:
            found.add(int(process.name))
    return found


def volume(mesh: Any) -> float:
    a, b, c = (mesh.points[mesh.tets[:, k]] - mesh.points[mesh.tets[:, 0]] for k in (1, 2, 3))
    return float(np.einsum("ij,ij->i", np.cross(a, b), c).sum() / 6)


def test_a_cube(capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    surface = box(5.0)
    mesh = tetrahedralize(surface, **FAST)
    assert volume(mesh) == pytest.approx(125, rel=0.01)
    assert mesh.reference is surface
    assert mesh.source == "box.stl"
    assert not mesh.repairs  # fTetWild's orientation is not the user's fault
    assert capfd.readouterr() == ("", "")
    assert os.listdir(tmp_path) == []


def test_a_sphere() -> None:
    mesh = tetrahedralize(sphere(3), **FAST)
    assert volume(mesh) == pytest.approx(4 / 3 * np.pi, rel=0.1)
    assert np.linalg.norm(mesh.points, axis=1).max() < 1.04


def test_options_are_passed_on() -> None:
    options = {"edge_length": 0.5, "num_opt_iter": 1}
    near, far = (tetrahedralize(sphere(1), epsilon=epsilon, **options) for epsilon in (3e-3, 5e-2))
    assert len(near.topology.boundary) > len(far.topology.boundary)


def test_points_no_triangle_uses_do_not_matter() -> None:
    surface = box()
    mesh = tetrahedralize(SurfaceMesh(np.vstack([[9.0, 9, 9], surface.points]), surface.triangles + 1), **FAST)
    assert volume(mesh) == pytest.approx(1, rel=0.01)


@pytest.mark.parametrize(
    ("option", "value", "allowed"),
    [
        ("epsilon", float("nan"), "above 0, at most 1"),
        ("epsilon", -1e-3, "above 0, at most 1"),
        ("epsilon", 0, "above 0, at most 1"),
        ("edge_length", 0, "above 0, at most 1"),
        ("edge_length", 1.5, "above 0, at most 1"),
        ("stop_energy", 1, "at least 3"),
        ("stop_energy", float("inf"), "at least 3"),
        ("num_opt_iter", 0, "at least 1"),
        ("timeout", 0, "a number of seconds above 0, or None"),
        ("timeout", float("nan"), "a number of seconds above 0, or None"),
    ],
)
def test_options_out_of_range(option: str, value: float, allowed: str) -> None:
    with pytest.raises(OptionError) as caught:
        tetrahedralize(box(), **{option: value})
    assert str(caught.value) == f"{option} is {value}; allowed is {allowed}"


def test_planar_surfaces_are_not_asked_for() -> None:
    surface = box()
    with pytest.raises(
        InputError, match=r"^box\.stl: the surface is planar, .* fTetWild needs one that encloses a volume$"
    ):
        tetrahedralize(SurfaceMesh(surface.points, surface.triangles[:2], source="box.stl"))
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    flat = SurfaceMesh(1e6 + (surface.points * [1, 1, 0]) @ turn * 1e3, surface.triangles)
    with pytest.raises(InputError, match="planar"):
        tetrahedralize(flat)
    with pytest.raises(InputError, match="planar"):
        tetrahedralize(SurfaceMesh(np.zeros((3, 3)), np.array([[0, 1, 2]])))


def test_a_timeout_ends_the_child() -> None:
    start = time.monotonic()
    with pytest.raises(NeighbourError, match=r"fTetWild was stopped after 1\.5 s, its timeout"):
        tetrahedralize(sphere(5), edge_length=0.004, epsilon=1e-4, timeout=1.5)
    assert time.monotonic() - start < 10
    assert not children()


def test_ctrl_c_ends_the_child() -> None:
    def interrupt(*_: Any) -> None:
        raise KeyboardInterrupt

    old = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 1.5)
    try:
        with pytest.raises(KeyboardInterrupt):
            tetrahedralize(sphere(5), edge_length=0.004, epsilon=1e-4)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, old)
    assert not children()


def test_a_crash_is_reported_by_its_signal(tmp_path: Path) -> None:
    """A surface with such an index cannot be made; so this goes round the front door."""
    surface = box()
    triangles = np.where(surface.triangles == 0, 2**31 - 1, surface.triangles)
    np.savez(tmp_path / "in.npz", points=surface.points, triangles=triangles)
    with pytest.raises(NeighbourError, match=r"^fTetWild crashed with SIGSEGV; it last said: .*Loaded mesh data"):
        _run([str(tmp_path / "in.npz"), str(tmp_path / "out.npz"), "{}"], tmp_path, None)


def test_a_failure_of_the_child_is_told_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(
        NeighbourError, match=r"^fTetWild failed with exit code 1; it last said: .*FileNotFoundError"
    ) as caught:
        _run([str(tmp_path / "in.npz"), str(tmp_path / "out.npz"), "{}"], tmp_path, None)
    assert "\n" not in str(caught.value)


def test_nothing_filled_is_an_error() -> None:
    surface = box()
    with pytest.raises(
        NeighbourError, match=r"^fTetWild filled nothing: is the surface open, or thinner than epsilon\?$"
    ):
        tetrahedralize(SurfaceMesh(surface.points * [1, 1, 1e-6], surface.triangles), **FAST)


def test_files_in_the_working_directory_do_not_matter(tmp_path: Path) -> None:
    for name in ("numpy", "pytetwild", "json", "meshio"):
        (tmp_path / f"{name}.py").write_text("raise RuntimeError('the wrong module')")
    code = (
        "import itertools, os, sys, numpy as np; from wct_plugin.mesh import SurfaceMesh; "
        "from wct_plugin.adapters.ftetwild import tetrahedralize; os.chdir(sys.argv[1]); "
        "points = np.vstack([np.zeros(3), np.eye(3)]); "
        "faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]); "
        "print(len(tetrahedralize(SurfaceMesh(points, faces), edge_length=.5, num_opt_iter=2).tets) > 0)"
    )
    done = subprocess.run([sys.executable, "-P", "-c", code, tmp_path], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("True\n", "")
