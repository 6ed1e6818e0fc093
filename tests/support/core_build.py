"""The C++ library and its tests, built once for all that need them, by the packages cmake and ninja."""

import fcntl
import os
import shutil
import subprocess
from pathlib import Path

import cmake
import ninja

ROOT = Path(__file__).parents[2]
#: Kept from run to run, so that only what has changed is compiled.
BUILD = ROOT / "build" / "cpp"


def run(*command: str | Path) -> str:
    """What a program prints; it must end well."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{command[0]} ends with {done.returncode}\n{(done.stdout + done.stderr)[-8000:]}"
    return done.stdout


def run_cmake(*arguments: str | Path) -> str:
    return run(Path(cmake.CMAKE_BIN_DIR) / "cmake", *arguments)


def build(source: Path, folder: Path, *definitions: str) -> Path:
    """Configure and build; without optimization beyond -O1, which takes a third of the time."""
    fast = ["-GNinja", f"-DCMAKE_MAKE_PROGRAM={Path(ninja.BIN_DIR) / 'ninja'}", "-DCMAKE_BUILD_TYPE=Release"]
    fast.append("-DCMAKE_CXX_FLAGS_RELEASE=-O1")
    if shutil.which("ccache"):
        fast += [
            "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache",
            "-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON",
        ]  # it keeps none of those
    run_cmake("-S", source, "-B", folder, *fast, *definitions)
    run_cmake("--build", folder)
    return folder


def built_core() -> Path:
    """The folder of the library and of ``tests/cpp/wct_tests``; processes that ask at once wait for each other."""
    BUILD.mkdir(parents=True, exist_ok=True)
    os.environ["CCACHE_BASEDIR"], os.environ["CCACHE_NOHASHDIR"] = str(ROOT), "1"  # other checkouts' objects will do
    with (BUILD / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        return build(ROOT, BUILD, "-DWCT_TESTS=ON", "-DWCT_WERROR=ON")
