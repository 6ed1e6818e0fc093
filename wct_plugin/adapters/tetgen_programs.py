"""Which TetGen there is: ``tetgen`` on the PATH, Debian's (1.5), else that in the Python package ``tetgen`` (1.6).

The package runs in a process of its own as :mod:`wct_plugin.adapters.tetgen_wheel`, with the program's command line and
files.
"""

import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from importlib.util import find_spec

from wct_plugin.errors import NeighbourError

_CHILD = "wct_plugin.adapters.tetgen_wheel"


@dataclass(frozen=True)
class Program:
    """A TetGen, and how it is called."""

    version: str  #: as in ``1.5 (/usr/bin/tetgen)``
    start: tuple[str, ...]  #: what stands before the arguments
    limits_itself: bool  #: takes its memory limit as its first argument; else whoever starts it sets one

    def command(self, switches: str, file: str, memory: int | None) -> Sequence[str]:
        """The command that runs it on a file with at most so many bytes of memory, where that is its own to see to."""
        limit = [str(memory or 0)] if self.limits_itself else []
        return [*self.start, *limit, switches, file]


def find() -> Program:
    """The TetGen that is used. Raises :class:`NeighbourError` where there is none."""
    line_by_line = shutil.which("stdbuf")  # an abort swallows what was not printed yet
    if path := shutil.which("tetgen"):
        if not line_by_line:
            raise NeighbourError("stdbuf is not on the PATH; on Debian and Ubuntu: apt install coreutils")
        return Program(f"{_version(line_by_line, path)} ({path})", (line_by_line, "-oL", path), limits_itself=False)
    if find_spec("tetgen") is None:
        raise NeighbourError(
            "there is no TetGen: neither tetgen on the PATH (on Debian and Ubuntu: apt install tetgen) nor the Python "
            "package (pip install tetgen)"
        )
    # Without -P the working directory would be the first place to look for modules.
    start = (*([line_by_line, "-oL"] if line_by_line else []), sys.executable, "-P", "-m", _CHILD)
    return Program(f"1.6 (Python package tetgen {metadata.version('tetgen')})", start, limits_itself=True)


@cache
def _version(line_by_line: str, path: str) -> str:
    """What the program says of itself; it ends its help with an abort."""
    try:
        done = subprocess.run(
            [line_by_line, "-oL", path, "-h"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=20
        )
    except (OSError, subprocess.TimeoutExpired):
        return "of unknown version"
    found = re.search(r"^Version (\S+)", done.stdout, re.M)
    return found[1] if found else "of unknown version"
