"""One file of a batch: what is to be done, what came of it, and the doing, which happens in a process of its own."""

import hashlib
import json
import os
import platform
import tempfile
import time
import warnings
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from wct_plugin.errors import InputError, WctWarning, one_line
from wct_plugin.io import atomic_files
from wct_plugin.measure import compiled_quality
from wct_plugin.mesh import TetMesh
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.pipeline.provenance import plain, versions
from wct_plugin.pipeline.stage import Mesh
from wct_plugin.pipeline.time_limit import TimeLimit

RECORD = "record.json"
OUTPUT = "output"


@dataclass(frozen=True)
class Job:
    """What is to be done, in plain values that travel to any process on any machine."""

    source: str  #: the input, relative to ``folder`` if not absolute
    name: str  #: of the output file
    pipeline: list[Any]  #: filters, as JSON
    pipeline_sha256: str
    folder: str  #: working directory, which names in options start from
    work: str  #: where attempts at the job make their folders
    timeout: float | None = None  #: seconds
    time_limit: float | None = None  #: seconds after which the filters are asked to stop
    memory: int | None = None  #: bytes
    regions: str | list[str] | None = None  #: names of the array or sets that are the regions of the input
    max_bytes: int | None = None  #: that arrays of the input may become


@dataclass(frozen=True)
class Record:
    """What came of a job: a line of the manifest."""

    input: str
    input_sha256: str | None  #: None if it could not be read
    pipeline_sha256: str
    output: str  #: name of the output file in the output directory
    files: Mapping[str, str] = field(default_factory=dict)  #: SHA-256 of each file written
    exit_code: int = 2  #: as of ``wct run``: 0 goal met, 1 goal missed, 2 nothing is written
    cause: str | None = None  #: one line, where the exit code is not 0
    seconds: float = 0.0
    cpu_seconds: float | None = None  #: of the job and the programs it waited for
    peak_bytes: int | None = None  #: greatest resident memory
    before: Mapping[str, Any] | None = None  #: sizes and quality of the input
    after: Mapping[str, Any] | None = None  #: and of the output
    goals: tuple[Mapping[str, Any], ...] = ()
    metrics: Mapping[str, Any] = field(default_factory=dict)  #: of each filter, by its name
    warnings: tuple[str, ...] = ()
    versions: Mapping[str, str] = field(default_factory=lambda: dict(versions()))
    host: str = field(default_factory=platform.node)
    finished: str = field(default_factory=lambda: datetime.now(UTC).isoformat(timespec="seconds"))

    @property
    def failed(self) -> bool:
        """Whether there is no output."""
        return self.exit_code > 1

    def to_json(self) -> str:
        """One line."""
        return json.dumps(asdict(self), allow_nan=False)  # ASCII: a name may be of bytes that are no text

    @classmethod
    def from_json(cls, line: str | bytes) -> "Record":
        """The record of a line; raises ValueError for what is none."""
        found = json.loads(line)
        if not isinstance(found, dict):
            raise ValueError("not an object")
        known = {one.name for one in fields(cls)}
        try:
            return cls(**{name: value for name, value in found.items() if name in known})
        except TypeError as error:
            raise ValueError(str(error)) from error


def failure(job: Job, cause: str, seconds: float) -> Record:
    """The record of a job that ended without one of its own."""
    return Record(job.source, _digest_or_none(job), job.pipeline_sha256, job.name, cause=cause, seconds=seconds)


def digest(path: str | Path) -> str:
    """SHA-256 of a file's content."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _digest_or_none(job: Job) -> str | None:
    try:
        return digest(Path(job.folder, job.source))
    except OSError:
        return None


def perform(job: Job, attempt: Path) -> int:
    """Do the job, with every file it makes under the folder ``attempt``, and give its exit code.

    The record is written last and whole: where there is one, the outputs under ``OUTPUT`` are complete.
    """
    os.chdir(job.folder)
    output, scratch = attempt / OUTPUT, attempt / "tmp"
    for folder in (output, scratch):
        folder.mkdir()
    os.environ["TMPDIR"] = tempfile.tempdir = str(scratch)
    start = time.perf_counter()
    input_sha256 = _digest_or_none(job)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("ignore")  # other packages' warnings are for programmers
        warnings.simplefilter("always", WctWarning)
        try:
            done = _run(job, output)
        except (Exception, SystemExit) as error:  # neighbours are known to leave by sys.exit
            done = {"exit_code": 2, "cause": one_line(error).removeprefix(f"{job.source}: ")}
    record = Record(job.source, input_sha256, job.pipeline_sha256, job.name, **done)
    said = tuple(dict.fromkeys(" ".join(str(one.message).split()) for one in caught))
    record = replace(record, warnings=said, seconds=round(time.perf_counter() - start, 3))
    with atomic_files.replacing(attempt / RECORD) as temporary:
        temporary.write_text(record.to_json(), encoding="utf-8")
    return record.exit_code


def _run(job: Job, output: Path) -> dict[str, Any]:
    if not Path(job.source).exists():  # it was there when the batch started
        raise InputError(f"{job.source}: no such file any more")
    limit = None if job.time_limit is None else TimeLimit(job.time_limit)
    chain = Pipeline.from_json(job.pipeline).between(
        job.source, [output / job.name], regions=job.regions, max_bytes=job.max_bytes
    )
    result = chain.execute(limit)
    missed = [str(goal) for goal in result.goals if not goal.met]
    if limit is not None and (ended := limit.ended(result)):
        missed.append(ended)
    return {
        "exit_code": 1 if missed else 0,
        "cause": "; ".join(missed) or None,
        "files": {file.name: digest(file) for file in sorted(output.iterdir())},
        "before": plain(numbers(result.stages[0].flow.mesh)),
        "after": plain(numbers(result.mesh)),
        "goals": tuple(vars(goal) for goal in result.goals),
        "metrics": plain(result.metrics),
    }


def numbers(mesh: Mesh) -> dict[str, Any]:
    """Size of a mesh, and of tets how well-centered they are."""
    if not isinstance(mesh, TetMesh):
        return {"points": len(mesh.points), "triangles": len(mesh.triangles)}
    measured = compiled_quality.measure(mesh)
    return {
        "points": len(mesh.points),
        "tets": len(mesh.tets),
        "3wc": float(100 * measured.well_centered_3.mean()),
        "cwc": float(100 * measured.completely_well_centered.mean()),
        "min_height": float(measured.min_height.min()),
        "max_dihedral_angle": float(measured.max_dihedral_angle.max()),
    }
