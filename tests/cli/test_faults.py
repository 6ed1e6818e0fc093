"""Faults of the machine: a full disk, closed and full streams, devices, links, permissions, two writers, kill -9.

What must not be read or written over is left as it was, errors are one line, and exit codes are those documented.
"""

import os
import re
import resource
import stat
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from support.builders import jittered_cube
from support.refusals import refused

import wct_plugin as wct
from benchmarks import kills
from wct_plugin.io import atomic_files
from wct_plugin.io.workplaces import workplace

WCT = Path(sys.executable).with_name("wct")
CUBE = jittered_cube(4, 0)
FAST = ["--goal", "delaunay"]


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    wct.write("a.vtu", CUBE)
    return tmp_path


def shell(line: str) -> tuple[int, str]:
    """Exit code and stderr of a line of bash, in which ``wct`` is ours."""
    done = subprocess.run(
        ["bash", "-c", f'wct() {{ "{WCT}" "$@"; }}; {line}'], capture_output=True, text=True, timeout=300
    )
    return done.returncode, done.stderr


FULL = "error: -: standard output cannot be written: No space left on device\n"
CLOSED = "error: -: standard output is closed\n"


@pytest.mark.parametrize(
    "unbuffered", ["", "1"]
)  # the environment says it: a failed write fails again at the end, or not
@pytest.mark.parametrize(
    ("line", "code", "said"),
    [
        ("wct report a.vtu > /dev/full", 2, FULL),
        ("wct report a.vtu --json - > /dev/full", 2, FULL),
        ("wct optimize a.vtu - --output-format vtu --goal delaunay > /dev/full", 2, FULL),
        ("wct --help > /dev/full", 2, FULL),
        ("wct report --help > /dev/full", 2, FULL),
        ("wct --version > /dev/full", 2, FULL),
        ("wct completion bash > /dev/full", 2, FULL),
        ("wct report a.vtu >&-", 0, ""),
        ("wct report a.vtu --json - >&-", 2, CLOSED),
        ("wct optimize a.vtu - --output-format vtu --goal delaunay >&-", 2, CLOSED),
        ("wct report - --input-format vtu <&-", 2, "error: -: standard input is closed\n"),
        ("wct report none.vtu 2>&-", 2, ""),
        ("wct report none.vtu > /dev/full 2>&1", 2, ""),
        ("wct > /dev/full 2>&1", 2, ""),
        ("wct --help > /dev/full 2>&1", 2, ""),
        ("wct --version 2> /dev/full", 0, ""),
        ("wct optimize a.vtu out.vtu --goal delaunay 2> /dev/full", 0, ""),
        ("wct optimize a.vtu out.vtu --goal delaunay <&- >&- 2>&-", 0, ""),
        ("wct --help | true; exit ${PIPESTATUS[0]}", 2, ""),
        ("wct report a.vtu | true; exit ${PIPESTATUS[0]}", 2, ""),
        ("wct report a.vtu --json - | true; exit ${PIPESTATUS[0]}", 2, ""),
        ("wct optimize a.vtu out.vtu --goal delaunay | true; exit ${PIPESTATUS[0]}", 2, ""),
    ],
)
def test_standard_streams(
    line: str, code: int, said: str, unbuffered: str, place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONUNBUFFERED", unbuffered)
    before = (place / "a.vtu").read_bytes()
    assert shell(line) == (code, said)
    assert (place / "a.vtu").read_bytes() == before
    left = {"a.vtu", "out.vtu"} if "out.vtu" in line else {"a.vtu"}
    assert {one.name for one in place.iterdir()} == left
    if "out.vtu" in line:
        assert isinstance(wct.read("out.vtu"), wct.TetMesh)


def _device(path: Path) -> None:
    os.mknod(path, 0o666 | stat.S_IFCHR, os.makedev(1, 7))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (os.mkfifo, "is a device or a pipe; allowed are files, and - for standard output"),
        (_device, "is a device or a pipe; allowed are files, and - for standard output"),
        (lambda path: path.symlink_to("/dev/full"), "is a device or a pipe"),
        (lambda path: path.symlink_to(path.name), "is a link that leads to itself"),
        (Path.mkdir, "is a directory; a file name is needed"),
        (lambda path: path.symlink_to("none/b.vtu"), "there is no directory"),
    ],
)
def test_what_is_no_file_is_not_replaced(
    make: Callable[[Path], None], said: str, place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = place / "out.vtu"
    try:
        make(out)
    except PermissionError:
        pytest.skip("making a device needs root")
    before = out.lstat()
    assert said in refused(capsys, "optimize", "a.vtu", out, *FAST)
    assert said in refused(capsys, "report", "a.vtu", "--json", out)
    assert (out.lstat().st_mode, out.lstat().st_ino) == (before.st_mode, before.st_ino)


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664])
def test_permissions_of_what_is_replaced_are_kept(mode: int, place: Path) -> None:
    for name in ("b.xdmf", "b.h5"):
        (place / name).write_text("old")
        (place / name).chmod(mode)
    os.chown(place / "b.xdmf", -1, os.getgid())
    wct.write("b.xdmf", CUBE)
    assert [stat.S_IMODE((place / name).stat().st_mode) for name in ("b.xdmf", "b.h5")] == [mode, mode]
    assert np.array_equal(wct.read("b.xdmf").points, CUBE.points)


def test_owners_are_kept_where_we_may(place: Path) -> None:
    if os.getuid():
        pytest.skip("giving a file away needs root")
    os.chown("a.vtu", 1234, 4321)
    wct.write("a.vtu", CUBE)
    assert (os.stat("a.vtu").st_uid, os.stat("a.vtu").st_gid) == (1234, 4321)


def test_a_write_protected_file_is_left(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (place / "b.vtu").write_text("old")
    (place / "b.vtu").chmod(0o444)
    if not os.getuid():  # whom no permission holds
        monkeypatch.setattr(os, "access", lambda path, _: not str(path).endswith("b.vtu"))
    with pytest.raises(wct.OutputError, match=r"b\.vtu: cannot be written: the file there is write-protected"):
        wct.write("b.vtu", CUBE)
    assert (place / "b.vtu").read_text() == "old"


def test_a_read_only_file_system(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (place / "ro").mkdir()
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", "ro,size=64k", "tmpfs", place / "ro"], capture_output=True)
    if made.returncode:
        pytest.skip("mounting needs root")
    try:
        said = refused(capsys, "optimize", "a.vtu", "ro/out.vtu", *FAST)
        assert said == "ro/out.vtu: cannot be written: Read-only file system"
        assert "Read-only file system" in refused(capsys, "batch", "repair-ftetwild", "a.vtu", "-o", "ro/out")
    finally:
        subprocess.run(["umount", place / "ro"], check=True)


def test_two_writers_of_one_output(place: Path) -> None:
    """Each XDMF file has the HDF5 file that belongs to it, whoever was last."""
    meshes = [jittered_cube(2, seed) for seed in range(4)]
    threads = [threading.Thread(target=lambda mesh=mesh: wct.write("b.xdmf", mesh)) for mesh in meshes * 3]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert any(np.array_equal(wct.read("b.xdmf").points, mesh.points) for mesh in meshes)
    assert sorted(os.listdir()) == ["a.vtu", "b.h5", "b.xdmf"]


def test_what_a_killed_writer_left_goes_with_the_next_and_what_another_is_at_stays(place: Path) -> None:
    command = (
        "import os; from wct_plugin.io.atomic_files import replacing\nwith replacing('b.vtu'): os.kill(os.getpid(), 9)"
    )
    for _ in range(2):
        subprocess.run([sys.executable, "-c", command], cwd=place)
        assert len(list(place.glob(".b.vtu.wct-*"))) == 1
    (place / ".b.vtu.backup12").mkdir()
    with workplace(place, "b.vtu") as mine:
        (mine / "half").touch()
        with atomic_files.replacing("b.vtu") as path:
            path.write_text("new")
        assert (mine / "half").exists()
        assert (place / "b.vtu").read_text() == "new"
    assert sorted(os.listdir()) == [".b.vtu.backup12", "a.vtu", "b.vtu"]


def test_kill_9_leaves_nothing_partial() -> None:
    for found in kills.run(2):
        assert found.kills + found.finished == 2
        assert found.broken == []
        assert [name for name in found.after if name != ".wct-batch"] == []


def test_little_memory(place: Path) -> None:
    """Whatever the limit: it works, or one line says that memory ran out, and nothing is there."""
    for limit in (800, 1500):
        done = subprocess.run(
            [WCT, "optimize", "a.vtu", f"{limit}.vtu", *FAST],
            capture_output=True,
            text=True,
            preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_AS, (limit << 20, limit << 20)),
            env=dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1"),
        )
        if done.returncode == 0:
            assert isinstance(wct.read(f"{limit}.vtu"), wct.TetMesh)
        else:
            assert done.returncode == 2
            assert not os.path.exists(f"{limit}.vtu")


def test_memory_that_runs_out_is_no_fault_of_ours(
    place: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def greedy(*_: object, **__: object) -> None:
        np.empty(1 << 50)

    monkeypatch.setattr("wct_plugin.filters.get_quality.make_report", greedy)
    (place / "chain.json").write_text('["a.vtu", {"type": "filters.get_quality"}, "out.vtu"]')
    said = refused(capsys, "run", "chain.json")
    assert re.match(r"ran out of memory( in stage 2 of 3 \(filters.get_quality\))?: Unable to allocate", said)
    monkeypatch.setattr("wct_plugin.io.vtu.read_pieces", greedy)
    assert refused(capsys, "report", "a.vtu").startswith("a.vtu: cannot be read as VTU: ran out of memory: Unable")
