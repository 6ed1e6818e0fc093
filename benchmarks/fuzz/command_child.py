"""The child that runs commands, for each in a fork of itself: ``python -m benchmarks.fuzz.command_child``.

Before each case it prints the number, after it a line of JSON where there is a fault. The fork has limits of memory and
time of its own, so what becomes of it is its case's alone.
"""

import ctypes
import json
import os
import resource
import signal
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

from benchmarks.fuzz import command_case, object_program, telling
from benchmarks.fuzz.command_case import Case, Ran
from benchmarks.fuzz.judge import result

#: Address space of a command, and wall seconds after which it is ended.
SPACE, WALL = 6 << 30, 240.0


def _imports() -> None:
    """All that commands import; nothing of it starts a thread."""
    import importlib

    for name in ("main", "optimize", "run", "report", "dual", "create"):
        importlib.import_module(f"wct_plugin.cli.{name}")
    from wct_plugin.pipeline.stage import filter_names, find_filter

    for name in filter_names():
        find_filter(name)
    for name in ("vtu", "gmsh_reader", "medit", "writer", "reader", "meshio_writers"):
        importlib.import_module(f"wct_plugin.io.{name}")


def _become(case: Case, folder: Path, cores: int) -> None:
    """In the fork: run the command and end."""
    code, began = 99, False
    try:
        os.setsid()
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG: it ends with the child
        os.chdir(folder)
        os.sched_setaffinity(0, set(sorted(os.sched_getaffinity(0))[:cores]))
        printed = os.open(folder / "printed", os.O_WRONLY | os.O_CREAT)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(printed, 1)
        os.dup2(printed, 2)
        sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")  # whatever stood for them here
        resource.setrlimit(resource.RLIMIT_AS, (SPACE, SPACE))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (2 * command_case.CPU, 2 * command_case.CPU + 1))
        signal.signal(signal.SIGINT, signal.default_int_handler)
        from wct_plugin.cli import entry

        sys.argv = ["wct", *case.arguments]
        began = True
        try:
            if case.name == "object":
                sys.exit(object_program.main(case.arguments))
            entry.main()
        except SystemExit as ended:
            code = ended.code if isinstance(ended.code, int) else 0 if ended.code is None else 1
    except KeyboardInterrupt:
        if not began:  # the command could not hear it yet
            signal.signal(signal.SIGINT, signal.SIG_DFL)
            os.kill(os.getpid(), signal.SIGINT)
        code = 130
    except BaseException:
        import traceback

        traceback.print_exc()
    finally:
        with suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


def _wait(child: int, case: Case) -> Ran:
    """Wait for the fork; send it what stops it, and end it where it does not end."""
    start, stop = time.monotonic(), case.stop
    while True:
        ended, status, usage = os.wait4(child, os.WNOHANG)
        if ended:
            code = os.waitstatus_to_exitcode(status)
            return Ran(code, "", usage.ru_utime + usage.ru_stime)
        waited = time.monotonic() - start
        if stop is not None and waited > stop[0]:
            os.kill(child, stop[1])
            stop = None
        if waited > WALL:
            os.killpg(child, signal.SIGKILL)
        time.sleep(0.002 if waited < 0.2 else 0.02)


def run(case: Case, folder: Path, cores: int = 2) -> Ran:
    """Run the command of a case in a fork."""
    child = os.fork()
    if not child:
        _become(case, folder, cores)
    ran = _wait(child, case)
    printed = folder / "printed"  # not there where a signal came before the command began
    return Ran(ran.code, printed.read_text(errors="replace") if printed.exists() else "", ran.cpu)


def _again(case: Case, ran: Ran, folder: Path) -> list[str]:
    """Run it once more, on one core: the same end, and the same bits."""
    target = folder / case.outputs[0]
    first = result.load(target) if target.exists() else None
    for name in (*case.outputs, "printed"):
        (folder / name).unlink(missing_ok=True)
    once_more = run(case, folder, cores=1)
    if once_more.code != ran.code:
        return [f"the exit code is {ran.code}, and {once_more.code} on one core"]
    return result.faults_of_same(first, result.load(target), "on one core") if first is not None else []


def _round_trip(case: Case, folder: Path) -> list[str]:
    """Read the output as users do, and write it again: the same mesh, to the bit."""
    import wct_plugin as wct

    target = folder / case.outputs[0]
    if not target.exists():
        return []
    again = folder / f"again{target.suffix}"
    wct.write(again, wct.read(target))
    return result.faults_of_same(result.load(target), result.load(again), "when it is read and written")


def whole(seed: int, number: int, folder: Path) -> tuple[Case, Ran, list[str]]:
    """Make, run and judge a case in an empty folder; a judge that fails is a fault too."""
    case = command_case.make(seed, number, folder)
    ran = run(case, folder)
    try:
        faults = command_case.judge(case, ran, folder)
        if case.name == "optimize" and not faults and number % 2:
            faults = _round_trip(case, folder)
        if case.again and not faults and number % 3 == 0:
            faults = _again(case, ran, folder)
    except Exception as error:
        faults = [f"what was written cannot be judged: {type(error).__name__}: {error}"]
    return case, ran, faults


def main() -> None:
    """Run the cases ``first`` to ``last`` of a seed, until the seconds are over."""
    seed, first, last = map(int, sys.argv[1:4])
    seconds = float(sys.argv[4])
    tell = telling.alone()
    _imports()
    counts: Counter[str] = Counter()
    start = time.monotonic()
    for number in range(first, last):
        if time.monotonic() - start > seconds:
            break
        tell(str(number))
        with tempfile.TemporaryDirectory(prefix="wct-fuzz-") as name:
            case, ran, faults = whole(seed, number, Path(name))
            counts[f"{case.name} {case.options.get('filter', '')} exit {ran.code}".replace("  ", " ")] += 1
            if faults:
                told = {"number": number, "name": " ".join(case.arguments), "faults": faults, "said": ran.text[-600:]}
                tell(json.dumps(told | {"kind": case.mesh.kind, "cpu": round(ran.cpu, 2)}))
    tell(json.dumps({"counts": counts}))


if __name__ == "__main__":
    main()
