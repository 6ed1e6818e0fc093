"""The manifest of a batch: a JSON line per finished job, on the disk before the next one is taken up.

A job is finished when its attempt has left a record beside its outputs. From there on :meth:`Manifest.commit` moves
the outputs to their place, writes the line, and takes the attempt away; wherever that is broken off,
:meth:`Manifest.recover` goes on with it. So nothing finished is lost or done again, whatever was killed when.
"""

import os
import shutil
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

from wct_plugin.batch.isolation import read_record
from wct_plugin.batch.job import OUTPUT, Job, Record, digest
from wct_plugin.errors import InputError, OptionError, OutputError

if sys.platform != "win32":
    import fcntl

_BINARY = getattr(os, "O_BINARY", 0)  # Windows would write two characters for a line break


class Manifest:
    """The manifest of the output directory ``folder``, or of one shard there, held by one batch at a time.

    ``suffix`` tells shards apart: ``-2of8``. A batch that is gone on with knows the records of all of them; new ones go
    to the own file.
    """

    def __init__(self, folder: Path, suffix: str = "") -> None:
        self.folder = folder
        self.path = folder / f"manifest{suffix}.jsonl"
        self._whole = folder / "manifest.jsonl"
        self.work = folder / f".wct-batch{suffix}"
        self._records: dict[str, Record] = {}
        self._file: int | None = None

    def open(self, *, resume: bool) -> None:
        """Take hold of the manifest, heal it and finish what was broken off.

        Raises :class:`OptionError` if there is one and ``resume`` is False or another batch holds it, and
        :class:`InputError` for a line that is no record, the last one apart, which a kill may have torn. To a batch
        of all files the manifest of any shard is one; shards that start side by side do not mind each other's.
        """
        if not resume:
            self._refuse_earlier()
        self._file = _hold(self.path)
        if self._file is None:
            raise OptionError(f"{self.path} is in use: another batch is writing to {self.folder}")
        _cut_torn_line(self._file)
        for path in self._manifests() if resume else ():
            self._learn(path)
        self.recover()
        if self.path == self._whole:  # one shard tidying up for another would be in its way when it starts again
            self._recover_others()
        self.work.mkdir(exist_ok=True)

    def _learn(self, path: Path) -> None:
        for record in _read(path):
            self._records[record.output] = record

    def _manifests(self) -> list[Path]:
        return sorted(self.folder.glob("manifest*.jsonl"))

    def _refuse_earlier(self) -> None:
        for path in self._manifests():
            if path in (self.path, self._whole) or self.path == self._whole:
                raise OptionError(
                    f"{path} exists: --resume goes on with that batch; remove the file to do everything again"
                )

    def close(self) -> None:
        """Finish what is finished, take away what is not, and let go."""
        if self._file is not None:
            try:
                _cut_torn_line(self._file)
                self._learn(self.path)  # Ctrl-C may have come between a line and the note of it
                self.recover()
            finally:
                os.close(self._file)
                self._file = None

    def finished(self, job: Job) -> Record | None:
        """The record of ``job`` finished before on the same content, if its outputs are still as written."""
        record = self._records.get(job.name)
        if record is None or record.pipeline_sha256 != job.pipeline_sha256 or record.input_sha256 is None:
            return None
        if digest(job.source) != record.input_sha256:
            return None
        for name, sha256 in record.files.items():
            file = self.folder / name
            if not file.is_file() or digest(file) != sha256:
                return None
        return record

    def count(self, jobs: Iterable[Job]) -> int:
        """How many of the jobs this pipeline has finished, whatever has become of their inputs and outputs."""
        known = ((job, self._records.get(job.name)) for job in jobs)
        return sum(record is not None and record.pipeline_sha256 == job.pipeline_sha256 for job, record in known)

    def commit(self, record: Record, attempt: Path | None) -> None:
        """Put the outputs of a finished attempt in their place, write the line, and take the attempt away."""
        try:
            if attempt is not None and not record.failed:
                # The file itself goes last, behind companions that it may name.
                for file in sorted((attempt / OUTPUT).glob("*"), key=lambda file: file.name == record.output):
                    file.replace(self.folder / file.name)
            assert self._file is not None
            line = record.to_json().encode() + b"\n"
            while line:
                line = line[os.write(self._file, line) :]
            os.fsync(self._file)
        except OSError as error:
            raise OutputError(f"{error.filename or self.path}: cannot be written: {error.strerror or error}") from error
        self._records[record.output] = record
        if attempt is not None:
            shutil.rmtree(attempt, ignore_errors=True)

    def recover(self) -> None:
        """Commit every attempt that is finished and not in the manifest yet; take away all others."""
        self._commit_all(self.work)
        _remove(self.work)

    def _recover_others(self) -> None:
        """The same for what shards left behind, those that are at work excepted."""
        for work in self.folder.glob(".wct-batch*"):
            held = _hold(self.folder / f"manifest{work.name.removeprefix('.wct-batch')}.jsonl")
            if held is not None:
                self._commit_all(work)
                _remove(work)
                os.close(held)

    def _commit_all(self, work: Path) -> None:
        for attempt in sorted(work.glob("*")):
            record = read_record(attempt)
            if record is not None and not self._knows(record):
                self.commit(record, attempt)

    def _knows(self, record: Record) -> bool:
        """Whether the job is in the manifest: two attempts may have finished it where a worker was believed lost."""
        known = self._records.get(record.output)
        if known is None or (known.input_sha256, known.pipeline_sha256) != (
            record.input_sha256,
            record.pipeline_sha256,
        ):
            return False
        return record.failed or not known.failed


def _hold(path: Path) -> int | None:
    """A handle of the file that no other batch has; None if one has it. The lock goes when its process ends."""
    try:
        handle = os.open(path, os.O_RDWR | os.O_APPEND | os.O_CREAT | _BINARY, 0o666)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error
    if sys.platform != "win32":
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(handle)
            return None
    return handle


def _cut_torn_line(handle: int) -> None:
    with open(handle, "rb", closefd=False) as file:
        file.seek(0)
        content = file.read()
    os.ftruncate(handle, content.rfind(b"\n") + 1)


def _read(path: Path) -> Iterator[Record]:
    lines = path.read_bytes().split(b"\n")
    for number, line in enumerate(lines[:-1], 1):  # behind the last line break there is nothing, or a torn line
        try:
            yield Record.from_json(line)
        except ValueError as error:
            raise InputError(f"{path}: line {number} is no record of a batch: {error}") from error


def _remove(folder: Path) -> None:
    """Take a folder away; jobs on other machines may still write there until they see that it is gone."""
    for _ in range(20):
        shutil.rmtree(folder, ignore_errors=True)
        if not folder.exists():
            return
        time.sleep(0.1)
