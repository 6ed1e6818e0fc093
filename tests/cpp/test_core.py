"""The tests of the C++ core, built in build/cpp by the packages cmake and ninja, and run."""

import shutil
import subprocess
from pathlib import Path

import cmake
import ninja

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build" / "cpp"


def run(*command: str | Path) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{command[0]} ends with {done.returncode}\n{(done.stdout + done.stderr)[-8000:]}"


def test_the_core_keeps_its_promises():
    tool = Path(cmake.CMAKE_BIN_DIR) / "cmake"
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    maker = f"-DCMAKE_MAKE_PROGRAM={Path(ninja.BIN_DIR) / 'ninja'}"
    run(tool, "-S", ROOT, "-B", BUILD, "-G", "Ninja", maker, "-DWCT_TESTS=ON", "-DWCT_WERROR=ON", *launcher)
    run(tool, "--build", BUILD, "--target", "wct_tests")
    run(BUILD / "tests" / "cpp" / "wct_tests")
