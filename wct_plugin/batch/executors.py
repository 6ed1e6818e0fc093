"""Where the jobs of a batch run, by one job function: on this machine, or on the workers of a dask scheduler."""

import importlib
import importlib.util
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from importlib.metadata import version
from pathlib import Path
from typing import Any, Protocol

from wct_plugin.batch.isolation import run_isolated, starter
from wct_plugin.batch.job import Job, Record
from wct_plugin.errors import OptionError, WctError, how_to_install

CONNECT_SECONDS = 10

#: What comes of a job: its record, and the folder of the attempt with the outputs.
Finished = tuple[Record, str]


class Executor(Protocol):
    """What a batch hands its jobs to."""

    def submit(self, job: Job) -> "Future[Finished]":
        """Take a job up as soon as there is room."""

    def running(self) -> list[str]:
        """The inputs at work now, as far as known."""

    def stop(self) -> None:
        """End what runs, forget what waits."""


class LocalExecutor:
    """A thread per job at work, each waiting for a process started for its job."""

    def __init__(self, jobs: int) -> None:
        self._starter = starter(jobs)
        self._threads = ThreadPoolExecutor(jobs, thread_name_prefix="wct-batch")
        self._running: dict[str, None] = {}

    def submit(self, job: Job) -> "Future[Finished]":  # noqa: D102
        return self._threads.submit(self._run, job)

    def _run(self, job: Job) -> Finished:
        self._running[job.source] = None
        try:
            return run_isolated(job, self._starter)
        finally:
            del self._running[job.source]

    def running(self) -> list[str]:  # noqa: D102
        return list(self._running)

    def stop(self) -> None:  # noqa: D102
        self._threads.shutdown(wait=False, cancel_futures=True)
        self._starter.close()
        self._threads.shutdown()


class DaskExecutor:
    """The workers of a dask scheduler, which must see the same files under the same names.

    A job whose worker is lost goes to another one.
    """

    def __init__(self, address: str, folder: Path) -> None:
        if importlib.util.find_spec("distributed") is None:
            raise WctError(f"a scheduler needs dask.distributed: {how_to_install('distributed')}")
        distributed: Any = importlib.import_module("distributed")
        try:
            self._client = distributed.Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            raise OptionError(f"scheduler {address}: cannot be reached: {' '.join(str(error).split())}") from error
        try:
            _check_workers(self._client.run(_look_round, str(folder), on_error="return"), folder)
        except BaseException:
            self._client.close()
            raise
        self._executor = self._client.get_executor(pure=False)

    def submit(self, job: Job) -> "Future[Finished]":  # noqa: D102
        future: Future[Finished] = self._executor.submit(run_isolated, job)
        return future

    def running(self) -> list[str]:  # noqa: D102
        return []

    def stop(self) -> None:  # noqa: D102
        self._executor.shutdown(wait=False)
        self._client.close()


def _look_round(folder: str) -> tuple[str, bool]:
    """On a worker: the version there, and whether the output directory is there too."""
    return version("wct_plugin"), Path(folder).is_dir()


def _check_workers(found: Mapping[str, Any], folder: Path) -> None:
    """Refuse workers that could do no job; ones that come later are not asked."""
    ours = version("wct_plugin")
    for worker, answer in sorted(found.items()):
        if isinstance(answer, BaseException):
            what = f"{type(answer).__name__}: {' '.join(str(answer).split())}"
            raise OptionError(f"worker {worker} cannot do jobs: {what}")
        theirs, sees = answer
        if theirs != ours:
            raise OptionError(f"worker {worker} has wct_plugin {theirs}, here is {ours}; they must be the same")
        if not sees:
            raise OptionError(f"worker {worker} does not see the directory {folder}; all machines must share it")
