"""A child process with a timeout: how it ended, and what it used."""

import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from types import MappingProxyType

import numpy as np

from benchmarks.child import NOT_INSTALLED

#: What a tool's process imports from: this folder's package and the tests' helpers.
_ROOT = Path(__file__).resolve().parents[1]
_PATH = (_ROOT, _ROOT / "tests")


@dataclass(frozen=True)
class Outcome:
    """How one tool did on one mesh; ``arrays`` is what the child saved, empty unless ``status`` is ok."""

    status: str
    load: float  #: the machine's load average over the last minute, when the tool started
    cpu: float  #: CPU seconds of the child and its children, start-up included
    arrays: MappingProxyType[str, np.ndarray]


def run(tool: str, mesh: Path, surface: Path | None, timeout: float) -> Outcome:
    """Run one tool on one mesh file in a process, and a directory, of its own."""
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "result.npz"
        given = [str(mesh.resolve()), str(surface.resolve()) if surface else ""]
        command = [sys.executable, "-m", "benchmarks.child", tool, *given, str(result)]
        load, before = os.getloadavg()[0], _used()
        status = watch(command, folder, timeout)
        arrays = {}
        if status == "ok":
            with np.load(result) as saved:
                arrays = dict(saved)
        return Outcome(status, load, _used() - before, MappingProxyType(arrays))


def watch(command: list[str], folder: str | Path, timeout: float) -> str:
    """Run a command in ``folder`` to its end or its timeout; "ok", or what became of it in a few words."""
    path = os.pathsep.join([*map(str, _PATH), *filter(None, [os.environ.get("PYTHONPATH")])])
    log = Path(folder) / "log"
    with log.open("wb") as output:
        started = monotonic()
        child = subprocess.Popen(
            command,
            cwd=folder,
            env=os.environ | {"PYTHONPATH": path},
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # so that its own children end with it
        )
        try:
            code = child.wait(timeout)
        except subprocess.TimeoutExpired:
            return f"stopped after {monotonic() - started:.0f} s"
        finally:
            if child.returncode is None:
                os.killpg(child.pid, signal.SIGKILL)
                child.wait()
    if code == 0:
        return "ok"
    if code == NOT_INSTALLED:
        return "not installed"
    if code < 0:
        return f"crashed: {signal.Signals(-code).name}"
    lines = [line.strip() for line in log.read_text(errors="replace").splitlines() if line.strip()]
    return f"failed: {lines[-1][:160] if lines else f'exit code {code}'}"


def _used() -> float:
    times = os.times()
    return times.children_user + times.children_system
