"""A case of a mutated file: made of its seed and number, read, and judged."""

import random
import resource
import shutil
import signal
import time
import warnings
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.fuzz import changed_bytes, changed_hdf5
from benchmarks.fuzz.judge.read_mesh import faults_of
from benchmarks.fuzz.judge.said import faults_of_message
from benchmarks.fuzz.seed_files import main_file

#: CPU seconds that a file of some kilobytes may take, and bytes by which the process may grow with it.
SECONDS, BYTES = 4.0, 900 << 20
_HDF5 = (".med", ".h5", ".e")


class TooLongError(BaseException):
    """A reader is still at it; no handler of readers may catch it."""


@dataclass(frozen=True)
class Outcome:
    """What came of a case: the class of the outcome, its seconds, and the faults that the judges found."""

    what: str  #: read, or refused
    said: str
    seconds: float
    faults: tuple[str, ...]


def make(seeds: list[Path], seed: int, number: int, folder: Path) -> Path:
    """The file of a case, in the empty ``folder``, where its companions are too."""
    draw = random.Random(f"file {seed} {number}")
    origin = seeds[draw.randrange(len(seeds))]
    for path in origin.iterdir():
        shutil.copyfile(path, folder / path.name)
    victim = folder / draw.choice(sorted(path.name for path in origin.iterdir()))
    if victim.suffix in _HDF5 and draw.random() < 0.8:
        with suppress(OSError, ValueError, TypeError, KeyError, RuntimeError, OverflowError):  # what HDF5 does not have
            changed_hdf5.changed(draw, victim)
    else:
        other = main_file(seeds[draw.randrange(len(seeds))])
        victim.write_bytes(changed_bytes.changed(draw, victim.read_bytes(), other.read_bytes()))
    return folder / main_file(origin).name


def _stop(*_: Any) -> None:
    raise TooLongError


def read_and_judge(path: Path) -> Outcome:
    """Read a file; it must become a mesh, or an error of one line, in bounded time and memory."""
    import wct_plugin as wct

    signal.signal(signal.SIGPROF, _stop)
    before, start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    said, mesh, faults = "", None, []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            mesh = wct.read(path)
        except wct.WctError as error:
            said = str(error)
            faults += faults_of_message(said, f"{path}: ")
        except TooLongError:
            faults.append(f"reading took more than {SECONDS:g} s")
        except Exception as error:
            faults.append(f"{type(error).__name__} is raised: {' '.join(str(error).split())[:200]}")
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
    seconds = time.process_time() - start
    for one in caught:
        if not issubclass(one.category, wct.WctWarning):
            faults.append(f"{one.category.__name__} is left: {one.message}")
        elif "\n" in str(one.message):
            faults.append("a warning has several lines")
    if mesh is not None:
        faults += faults_of(mesh)
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) << 10
    if grown > BYTES:
        faults.append(f"reading took {grown >> 20} MiB")
    what = "refused" if said else "read" if mesh is not None else "fault"
    return Outcome(what, said.removeprefix(f"{path}: "), seconds, tuple(faults))
