"""Many files through one pipeline of filters: a process per file, a line per file in a manifest, and a summary.

>>> import wct_plugin as wct
>>> chain = wct.Filter.generate_tetrahedralization() | wct.Filter.meshing_well_centered()
>>> done = wct.run_batch(chain, ["parts/*.stl"], "out", jobs=2, timeout=600)  # doctest: +SKIP
>>> done.exit_code, [record.cause for record in done.failed]  # doctest: +SKIP
"""

import math
import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from queue import Empty, SimpleQueue

from wct_plugin.batch import plan, starters, summary
from wct_plugin.batch.executors import DaskExecutor, Executor, Finished, LocalExecutor
from wct_plugin.batch.job import Job, Record, failure
from wct_plugin.batch.manifest import Manifest
from wct_plugin.errors import OptionError, OutputError, one_line
from wct_plugin.io import atomic_files
from wct_plugin.io.region_choice import Regions
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.pipeline.stage import FilterStage, Options

_MEGABYTE = 1 << 20
_TICK = 0.2  #: seconds between two reports of progress


@dataclass(frozen=True)
class BatchProgress:
    """Where a batch stands."""

    total: int
    finished: int  #: of them; earlier ones that ``resume`` found count
    failed: int
    running: tuple[str, ...] = ()  #: inputs at work, as far as known
    last: Record | None = None  #: what has just been finished


@dataclass(frozen=True)
class BatchResult:
    """Every file's record, and where the summaries are."""

    records: tuple[Record, ...]  #: by input, failures last
    done_now: int  #: how many of them were done by this run; the others were finished before
    csv: Path
    html: Path

    def __repr__(self) -> str:
        return f"<BatchResult: {summary.headline(self.records)}>"

    @property
    def failed(self) -> list[Record]:
        """Those that have no output."""
        return [record for record in self.records if record.failed]

    @property
    def exit_code(self) -> int:
        """0 if every file met its goal, 1 if one missed it or failed."""
        return int(any(record.exit_code for record in self.records))


def run_batch(
    pipeline: Pipeline | FilterStage[Options],
    inputs: Sequence[str | Path],
    folder: str | Path,
    *,
    suffix: str | None = None,
    regions: Regions = None,
    max_bytes: int | None = None,
    jobs: int | None = None,
    timeout: float | None = None,
    time_limit: float | None = None,
    memory_limit: float | None = None,
    resume: bool = False,
    retry_failed: bool = False,
    shard: tuple[int, int] | None = None,
    scheduler: str | None = None,
    progress: Callable[[BatchProgress], None] | None = None,
) -> BatchResult:
    """Run a pipeline of filters on many files, each in a process of its own, and write the outputs to ``folder``.

    Whatever a file does to its process costs that file alone. The directory gets the outputs, ``manifest.jsonl`` with
    a line per finished file, ``summary.csv`` and ``summary.html``.

    Parameters
    ----------
    pipeline : Pipeline or Filter
        Filters only.
    inputs : sequence of str or Path
        Files, or patterns with ``*``, ``?``, ``[]`` and ``**``.
    folder : str or Path
        The output directory; it is made if there is none.
    suffix : str or None
        That of the outputs, such as ``vtu``; None is each input's own, or ``vtu`` where that cannot carry the output.
    regions : str, sequence of str or None
        Names of the array or sets that are the regions of each input, as of :func:`wct_plugin.read`.
    max_bytes : int or None
        Most bytes that packed or declared arrays of an input may become, as of :func:`wct_plugin.read`.
    jobs : int or None
        How many files at a time; None is as many as there are cores.
    timeout : float or None
        Seconds that a file may take; None is no limit.
    time_limit : float or None
        Seconds after which a file's filters are asked to stop and keep their best so far; None is no limit.
    memory_limit : float or None
        Megabytes that a file's processes may use together (Linux only); None is no limit.
    resume : bool
        Go on with the batch that the directory's manifest is of: files finished with the same content by the same
        pipeline are not done again.
    retry_failed : bool
        The same, but those that failed are tried again.
    shard : (int, int) or None
        ``(i, n)``: only the i-th of n equal parts, every n-th input in the order of names.
    scheduler : str or None
        Address of a dask scheduler whose workers do the work.
    progress : callable or None
        Called with a :class:`BatchProgress` after each file and in between.

    Returns
    -------
    BatchResult
        A record per file.

    Raises
    ------
    WctError
        Before anything starts, for whatever is wrong with the pipeline, the inputs, the directory or the options.
    OutputError
        When the directory takes no more files; as the next.
    KeyboardInterrupt
        When Ctrl-C is pressed; it says how many files are finished, and what ran is ended.
    """
    chain = pipeline if isinstance(pipeline, Pipeline) else Pipeline() | pipeline
    _check_limits(jobs, scheduler, timeout=timeout, time_limit=time_limit, memory_limit=memory_limit)
    target = Path(folder)
    tasks = plan.plan(chain, inputs, target, suffix)
    part = ""
    if shard is not None:
        tasks = plan.shard(tasks, shard)
        part = f"-{shard[0]}of{shard[1]}"
    plan.prepare_folder(target)
    manifest = Manifest(target.resolve(), part)
    make = partial(
        Job,
        pipeline=chain.to_json(),
        pipeline_sha256=plan.fingerprint(chain, regions),
        regions=regions if isinstance(regions, str | None) else list(regions),
        max_bytes=max_bytes,
        folder=os.getcwd(),
        work=str(manifest.work),
        timeout=timeout,
        time_limit=time_limit,
        memory=None if memory_limit is None else math.ceil(memory_limit * _MEGABYTE),
    )
    started = False
    try:
        with ExitStack() as stack:
            stack.callback(manifest.close)
            executor = _executor(scheduler, target.resolve(), jobs)
            stack.callback(executor.stop)
            manifest.open(resume=resume or retry_failed)
            started = True
            waiting, found = _sorted_out([make(task.source, task.name) for task in tasks], manifest, again=retry_failed)
            found += _run(waiting, found, manifest, executor, progress or _silent)
        csv, html = (target / f"summary{part}.{form}" for form in ("csv", "html"))
        _write_summaries(found, csv, html, f"Batch {target.resolve().name}{part}")
    except (KeyboardInterrupt, OutputError) as error:
        if started or isinstance(error, KeyboardInterrupt):
            count = manifest.count(make(one.source, one.name) for one in tasks)
            error.args = ("; ".join([*map(str, error.args), f"{count} of {len(tasks)} files are finished"]),)
        raise
    return BatchResult(tuple(summary.ordered(found)), len(waiting), csv, html)


def _sorted_out(jobs: Sequence[Job], manifest: Manifest, *, again: bool) -> tuple[list[Job], list[Record]]:
    """The jobs that are to be done, and the records of the others; ``again``: those that failed are to be done."""
    waiting: list[Job] = []
    found: list[Record] = []
    for job in jobs:
        known = manifest.finished(job)
        if known is None or (again and known.failed):
            waiting.append(job)
        else:
            found.append(known)
    return waiting, found


def _write_summaries(records: Sequence[Record], csv: Path, html: Path, title: str) -> None:
    for path, text in ((csv, summary.to_csv(records)), (html, summary.to_html(records, title))):
        with atomic_files.replacing(path) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _check_limits(jobs: int | None, scheduler: str | None, **limits: float | None) -> None:
    if jobs is not None and scheduler is not None:
        raise OptionError("jobs is for this machine; how many run at a time on a scheduler's workers is theirs to say")
    if jobs is not None and not (isinstance(jobs, int) and jobs >= 1):
        raise OptionError(f"jobs is {jobs}; allowed is a whole number, 1 or more")
    for name, value in limits.items():
        if value is not None and not 0 < value < math.inf:
            raise OptionError(f"{name} is {value}; allowed is a number above 0")
    if limits["memory_limit"] is not None and not (sys.platform == "linux" and starters.forks()):
        raise OptionError(f"memory_limit cannot be kept on {sys.platform}; leave it out")


def _executor(scheduler: str | None, folder: Path, jobs: int | None) -> Executor:
    return LocalExecutor(jobs or starters.cores()) if scheduler is None else DaskExecutor(scheduler, folder)


def _run(
    jobs: Sequence[Job],
    earlier: Sequence[Record],
    manifest: Manifest,
    executor: Executor,
    progress: Callable[[BatchProgress], None],
) -> list[Record]:
    """Do the jobs, and commit each as it ends."""
    ended: SimpleQueue[tuple[Job, Future[Finished]]] = SimpleQueue()

    def note(job: Job, future: "Future[Finished]") -> None:
        ended.put((job, future))

    for job in jobs:
        executor.submit(job).add_done_callback(partial(note, job))
    made: list[Record] = []
    failed = sum(record.failed for record in earlier)
    total = len(jobs) + len(earlier)
    while len(made) < len(jobs):
        last = None
        with suppress(Empty):
            job, future = ended.get(timeout=_TICK)
            last = _commit(job, future, manifest)
            made.append(last)
            failed += last.failed
        progress(BatchProgress(total, len(earlier) + len(made), failed, tuple(executor.running()), last))
    return made


def _commit(job: Job, future: "Future[Finished]", manifest: Manifest) -> Record:
    try:
        record, attempt = future.result()
    except Exception as error:  # of the executor's own: a job's never comes this way
        record, attempt = failure(job, f"could not be done: {type(error).__name__}: {one_line(error)}", 0.0), None
    manifest.commit(record, None if attempt is None else Path(attempt))
    return record


def _silent(_: BatchProgress) -> None:
    pass
