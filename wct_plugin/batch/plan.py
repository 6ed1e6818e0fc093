"""What a batch is to do: which inputs, to which outputs, found fit for the pipeline before anything starts."""

import glob
import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wct_plugin.batch.job import digest
from wct_plugin.errors import InputError, OptionError, OutputError, WctError
from wct_plugin.io import atomic_files, formats
from wct_plugin.io.region_choice import Regions
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline.graph import label
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.pipeline.readers_writers import ReadMesh
from wct_plugin.pipeline.stage import FilterStage

_OTHERWISE = ".vtu"  #: what an input's own format cannot carry goes there


@dataclass(frozen=True)
class Task:
    """One input and the name of its output in the output directory."""

    source: str
    name: str


def plan(pipeline: Pipeline, inputs: Sequence[str | Path], folder: Path, suffix: str | None = None) -> list[Task]:
    """The tasks, sorted by input, of ``pipeline`` on files and patterns; all that can be refused early is.

    ``suffix`` is that of the outputs; without it each has its input's own, or ``.vtu`` where that cannot carry it.
    """
    _check_filters_only(pipeline)
    sources = expand(inputs)
    last = pipeline.steps[-1].stage
    assert isinstance(last, FilterStage)
    tasks = [Task(one, _output_name(Path(one), last.gives is TetMesh, suffix)) for one in sources]
    _check_kinds(pipeline, sources)
    _check_collisions(tasks, folder)
    return tasks


def expand(inputs: Sequence[str | Path]) -> list[str]:
    """The files that names and patterns (``*``, ``?``, ``[]``, ``**``) stand for, sorted, each once."""
    found: dict[Path, str] = {}
    for given in map(str, inputs):
        for name in _matches(given):
            file = Path(name)
            if file.is_dir():
                raise InputError(f"{name}: is a directory; '{file / '*'}' names the files in it")
            place = file.resolve()
            if place in found:
                same = "" if found[place] == name else f", as {found[place]} too"
                raise InputError(f"{name}: is given twice{same}")
            found[place] = name
    if not found:
        raise InputError("no inputs are given")
    return sorted(found.values())


def _matches(given: str) -> list[str]:
    if Path(given).exists():
        return [given]
    if not glob.has_magic(given):
        raise InputError(f"{given}: no such file")
    matched = [name for name in glob.glob(given, recursive=True) if not Path(name).is_dir()]
    if not matched:
        raise InputError(f"{given}: no file matches")
    return matched


def shard(tasks: Sequence[Task], part: tuple[int, int]) -> list[Task]:
    """Part ``i`` of ``n``, counted from 1: every n-th of the tasks in the order of their names.

    So the parts are equally long, and the same on every machine that sees the same files.
    """
    index, count = part
    if not 1 <= index <= count:
        raise OptionError(f"shard {index}/{count}: allowed are 1/{count} to {count}/{count}")
    return list(tasks[index - 1 :: count])


def fingerprint(pipeline: Pipeline, regions: Regions = None) -> str:
    """SHA-256 of the pipeline's stages, options, the contents of the files that its options name, and the regions."""
    content = pipeline.to_json()
    named = {name: digest(name) for name in sorted(set(_strings(content))) if _is_file(name)}
    chosen = [] if regions is None else [regions if isinstance(regions, str) else list(regions)]
    return hashlib.sha256(json.dumps([content, named, *chosen], sort_keys=True).encode()).hexdigest()


def _strings(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for item in value.values() if isinstance(value, dict) else value:
            yield from _strings(item)


def _is_file(name: str) -> bool:
    try:
        return Path(name).is_file()
    except (OSError, ValueError):  # a string that is no name
        return False


def prepare_folder(folder: Path) -> None:
    """Make the output directory and find out whether it takes files."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise OutputError(f"{folder}: is a file; a batch needs a directory for its outputs") from error
    except OSError as error:
        raise OutputError(f"{folder}: cannot be created: {error.strerror or error}") from error
    atomic_files.check_writable(folder / "manifest.jsonl")


def _check_filters_only(pipeline: Pipeline) -> None:
    if not pipeline.steps:
        raise OptionError("the pipeline has no stages")
    for index, step in enumerate(pipeline.steps):
        if not isinstance(step.stage, FilterStage):
            raise OptionError(
                f"{label(pipeline.steps, index)}: a batch's pipeline holds filters only; the batch itself reads each"
                " input and writes its output"
            )
        if step.stage.starts():
            raise OptionError(
                f"{label(pipeline.steps, index)}: makes a mesh from nothing; a batch's pipeline takes each input's"
            )
    pipeline.check([TetMesh, SurfaceMesh])


def _check_kinds(pipeline: Pipeline, sources: Sequence[str]) -> None:
    """Check the pipeline with each format there is among the inputs, for the kinds of mesh that it can hold."""
    checked = set()
    for source in sources:
        kinds = ReadMesh(filename=source).kinds()
        if kinds not in checked:
            checked.add(kinds)
            try:
                pipeline.check(kinds)
            except WctError as error:
                error.args = (f"{source}: {error}", *error.args[1:])
                raise


def _output_name(source: Path, volume: bool, suffix: str | None) -> str:
    own = formats.to_read(source)
    packed = formats.PACKED if source.suffix.lower() == formats.PACKED else ""
    source = source.with_suffix("") if packed else source
    if suffix is None:
        suffix = source.suffix + packed if (own.volume if volume else own.surface) else _OTHERWISE
    try:
        name = source.with_suffix(f".{suffix.removeprefix('.')}").name
    except ValueError as error:
        raise OptionError(f"suffix {suffix!r} cannot end a file's name; allowed is one such as vtu") from error
    formats.to_write(Path(name), volume=volume)
    return name


def _check_collisions(tasks: Sequence[Task], folder: Path) -> None:
    inputs = {file: task.source for task in tasks for file in _family(Path(task.source).resolve())}
    taken: dict[Path, str] = {}
    for task in tasks:
        for file in _family(folder.resolve() / task.name):
            if file in taken:
                raise OptionError(
                    f"{taken[file]} and {task.source} would both be written to {folder / task.name}; rename one,"
                    " or do them in two batches"
                )
            if file in inputs:
                raise OptionError(f"{folder / task.name} would be written over the input {inputs[file]}")
        taken |= dict.fromkeys(_family(folder.resolve() / task.name), task.source)


def _family(file: Path) -> list[Path]:
    """The names that a mesh file and its companions may have: formats of several files tell them by the suffix."""
    packed = file.suffix if file.suffix.lower() == formats.PACKED else ""
    plain = file.with_suffix("") if packed else file
    others = (suffix for suffix in formats.to_read(file).suffixes if suffix != plain.suffix)
    return [file, *(plain.with_name(plain.with_suffix(suffix).name + packed) for suffix in others)]
