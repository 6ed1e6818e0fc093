"""A case as a command, stopped by signals, and in Python, stopped by its callback."""

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.fuzz.judge.result import Arrays, load
from benchmarks.fuzz.random_mesh import Made
from benchmarks.stops.cases import Case
from benchmarks.stops.forks import Ended, Forks, Found
from benchmarks.stops.left import Promise, faults_of_command, faults_of_mesh

#: Signals of which the second comes at once.
SIGNALS = {"SIGINT": (2,), "SIGTERM": (15,), "SIGINT, SIGTERM": (2, 15), "SIGTERM, SIGTERM": (15, 15)}
#: CPU seconds in which these small runs must end once they were asked to: two measurements, reports, files, and the
#: import of what draws them.
_SOON = 8.0
#: The boundary's tolerance where it is the sag of the facets that there are.
_SAG = {"delaunay": 0.05, "one-sided": 0.05}


class StoppedError(Exception):
    """What a callback raises to stop."""


def _prepare(case: Case, folder: Path) -> Promise:
    points, tets = case.mesh()
    behind = (points[tets].mean(axis=1) @ [1.0, 0.3, 0.1]) > np.median(points @ [1.0, 0.3, 0.1])
    made = Made("", points, tets, 1 + behind.astype(np.int64) if case.regions else np.ones(len(tets), dtype=np.int64))
    made.write(folder / "in.vtu")
    tolerance = _SAG.get(case.name, case.options.get("tolerance", 1e-3))
    return Promise(load(folder / "in.vtu"), case.options["goal"], tolerance)


def _slow(ended: Ended) -> list[str]:
    return [f"it took {ended.cpu:.1f} s of CPU time to end"] if ended.cpu > _SOON else []


def as_command(case: Case, most: int, folder: Path) -> Found:
    """Run ``wct`` here, with forks at the calls of its progress bar; this process is at its end then."""
    from wct_plugin.cli import interrupt, main, optimize, progress_bar

    promise = _prepare(case, folder)
    inputs = {path.name for path in folder.iterdir()}

    def judge(_: str, __: str, ended: Ended) -> list[str]:
        return faults_of_command(ended.code, ended.text, folder, inputs, promise) + _slow(ended)

    forks = Forks(list(SIGNALS), most, folder, judge)

    @contextmanager
    def stopped_bar() -> Iterator[Any]:
        with progress_bar.progress_bar() as hear:

            def listen(state: Any) -> bool | None:
                goes_on = hear(state)
                for number in SIGNALS.get(forks.at(state.stage), ()):
                    os.kill(os.getpid(), number)
                return goes_on

            yield listen

    optimize.progress_bar = stopped_bar  # type: ignore[assignment]
    parent = os.getpid()
    os.chdir(folder)
    interrupt.raise_on_sigterm()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell that starts this behind it has it ignored
    code = main.run(case.command)
    if os.getpid() != parent:
        os._exit(code)
    return forks.found


def in_python(case: Case, most: int, folder: Path) -> Found:
    """Apply the filter, with forks at the calls of the callback, which gives False there or raises."""
    import wct_plugin as wct

    promise = _prepare(case, folder)

    def judge(kind: str, _: str, ended: Ended) -> list[str]:
        faults = [f"it ended with {ended.code}: {ended.text[-300:]}"] if ended.code else []
        if kind == "False" and not faults:
            with np.load(folder / "left.npz") as arrays:
                faults += faults_of_mesh(Arrays(arrays["points"], arrays["tets"], arrays["regions"]), promise)
        return faults + _slow(ended)

    forks = Forks(["False", "an exception"], most, folder, judge)
    mesh = wct.read(folder / "in.vtu")
    before = mesh.points.tobytes() + mesh.tets.tobytes()
    stopped = at = ""

    def listen(state: Any) -> bool:
        nonlocal stopped, at
        at = at if stopped else state.stage
        stopped = stopped or forks.at(state.stage)
        if stopped == "an exception":
            raise StoppedError
        return not stopped

    parent = os.getpid()
    faults = []
    try:
        new, metrics = wct.apply_filter(case.filter, mesh, progress=listen, **case.options)
        if stopped == "an exception":
            faults.append("the exception of the callback did not come out")
        elif stopped:
            np.savez(folder / "left.npz", points=new.points, tets=new.tets, regions=new.regions)
            if not metrics["stopped"] and at != "measuring":  # all is done there
                faults.append("the metrics do not say that it was stopped")
    except StoppedError:
        if stopped != "an exception":
            faults.append("an exception of nobody's came out")
    if os.getpid() != parent:
        if mesh.points.tobytes() + mesh.tets.tobytes() != before:
            faults.append("the input changed")
        os.write(2, "; ".join(faults).encode())
        os._exit(bool(faults))
    return forks.found
