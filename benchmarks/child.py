"""One tool on one mesh in a process of its own: ``python -m benchmarks.child TOOL MESH SURFACE RESULT``.

``SURFACE`` may be empty. ``RESULT`` (.npz) gets the mesh, the CPU seconds and the memory of the tool alone: what
Python, the imports and reading the mesh took is not counted. Exit code 3: not installed.
"""

import resource
import sys
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np

import wct_plugin as wct
from benchmarks.ours import OURS
from benchmarks.peers import PEERS

NOT_INSTALLED = 3
_MEMORY_LIMIT = 16 * 2**30  # address space; some meshers fill the machine before they fail


def _cpu() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used)


def _forget_peak() -> None:
    with suppress(OSError):  # Linux only
        Path("/proc/self/clear_refs").write_text("5")


def _peak() -> int:
    """Most resident memory so far in bytes; of this process and, if larger, of any child it waited for."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
    except OSError:
        return max(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024, children)
    return max(next(int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM:")), children)


def main(name: str, mesh_file: str, surface_file: str, result: str) -> int:
    """Run the tool of that name."""
    mesh = wct.read(mesh_file)
    if surface_file:
        mesh = replace(mesh, reference=wct.read(surface_file))
    tool = next(tool for tool in (*OURS, *PEERS) if tool.name == name)
    try:
        tool.load()
    except ImportError as error:
        print(error, file=sys.stderr)  # noqa: T201
        return NOT_INSTALLED
    with suppress(OSError, ValueError):  # a lower limit is set already, or the system knows none
        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY_LIMIT, resource.getrlimit(resource.RLIMIT_AS)[1]))
    _forget_peak()
    memory, wall, cpu = _peak(), perf_counter(), _cpu()
    points, tets = tool.run(mesh)
    cpu, wall, peak = _cpu() - cpu, perf_counter() - wall, _peak()
    np.savez(result, points=points, tets=tets, cpu=cpu, wall=wall, memory=peak, memory_above=peak - memory)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
