"""What tests in several folders share."""

import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.full_mesh import full_mesh, full_surface, plain_mesh
from support.typing_in import type_in

from wct_plugin.mesh import SurfaceMesh, TetMesh


def pytest_configure() -> None:
    """Ctrl-C is Python's, here and in every child: a shell that starts the suite behind it has it ignored."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A folder with what ``wct demo`` leaves, and what it said: it takes a while, and most documents begin with it."""
    place = tmp_path_factory.mktemp("demo")
    return place, type_in(["wct", "demo"], place)


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 64 KiB; mounting one needs root."""
    disk = tmp_path / "disk"
    disk.mkdir()
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], capture_output=True, text=True)
    if made.returncode:
        pytest.skip(f"no small disk to fill: {made.stderr.strip()}")
    yield disk
    subprocess.run(["umount", disk], check=True)


@pytest.fixture
def plain() -> TetMesh:
    return plain_mesh()


@pytest.fixture
def full(plain: TetMesh) -> TetMesh:
    return full_mesh(plain)


@pytest.fixture
def surface(plain: TetMesh) -> SurfaceMesh:
    return full_surface(plain)
