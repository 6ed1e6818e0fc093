"""Steps of a pipeline: a stage with its tag and its inputs, and how steps hang together."""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from wct_plugin.errors import OptionError, WctError
from wct_plugin.pipeline.readers_writers import ENDS, Writer
from wct_plugin.pipeline.stage import Options, Stage, did_you_mean, filter_names, find_filter

_TAG = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")


@dataclass(frozen=True)
class Step:
    """One stage of a pipeline; without ``inputs``, tags of other steps, it takes what the step before it gives."""

    stage: Stage[Options]
    tag: str = ""
    inputs: tuple[str, ...] = ()


def find_stage(type_name: str) -> type[Stage[Options]]:
    """The stage of a type such as ``filters.get_quality``; raises :class:`OptionError` for an unknown one."""
    if type_name in ENDS:
        return ENDS[type_name]
    known = [*ENDS, *(f"filters.{name}" for name in filter_names())]
    if type_name not in known:
        raise OptionError(f"unknown stage {type_name!r}{did_you_mean(type_name, known)} (allowed: {', '.join(known)})")
    return find_filter(type_name)


def label(steps: Sequence[Step], index: int) -> str:
    """How messages name a step."""
    return place(index, len(steps), steps[index].stage.type())


def place(index: int, count: int, type_name: str = "") -> str:
    """How messages name a stage by where it stands."""
    return f"stage {index + 1} of {count}" + (f" ({type_name})" if type_name else "")


def unnamed(message: str, type_name: str) -> str:
    """A message without the type it may begin with, for where :func:`place` has said it."""
    return message.removeprefix(type_name).removeprefix(":").lstrip()


def unplaced(message: str) -> str:
    """A message without the place it may begin with, but with a filter's type: for those who wrote no pipeline."""
    found = re.match(r"stage \d+ of \d+ \((.+?)\): ", message)
    if not found:
        return message
    rest = message[found.end() :]
    return f"{found[1]}: {rest}" if found[1].startswith("filters.") else rest


@contextmanager
def unplaced_errors() -> Iterator[None]:
    """Take the number of the stage from errors: who runs one filter never numbered any."""
    try:
        yield
    except WctError as error:
        error.args = (unplaced(str(error)), *error.args[1:])
        raise


def wire(steps: Sequence[Step]) -> list[list[int]]:
    """For each step the indices of those whose meshes it takes; the first may have none, though it needs one.

    Raises :class:`OptionError` for bad, repeated and unknown tags, a step without input, and a cycle.
    """
    if not steps:
        raise OptionError("the pipeline has no stages")
    tags = _tags(steps)
    wires: list[list[int]] = []
    for index, step in enumerate(steps):
        name = label(steps, index)
        if step.stage.starts():
            if step.inputs:
                raise OptionError(f"{name}: a stage that takes no mesh takes no inputs")
            wires.append([])
        elif not step.inputs:
            wires.append([index - 1] if index else [])
        else:
            if len(step.inputs) > 1 and not (isinstance(step.stage, Writer) and step.stage.many):
                raise OptionError(f"{name}: takes one mesh; {len(step.inputs)} inputs are given")
            for one in step.inputs:
                if one not in tags:
                    hint = did_you_mean(one, tags)
                    raise OptionError(f"{name}: unknown input {one!r}{hint} (tags: {', '.join(tags) or 'none'})")
            if isinstance(step.stage, Writer) and (taken := sorted(step.stage.reserved.intersection(step.inputs))):
                raise OptionError(
                    f"{name}: no input may have the tag {taken[0]!r}, which stands for something else there"
                )
            if len(set(step.inputs)) < len(step.inputs):
                raise OptionError(f"{name}: an input is given twice")
            wires.append([tags[one] for one in step.inputs])
    order(steps, wires)
    _check_used(steps, wires)
    return wires


def _tags(steps: Sequence[Step]) -> Mapping[str, int]:
    tags: dict[str, int] = {}
    for index, step in enumerate(steps):
        if not step.tag:
            continue
        if not _TAG.fullmatch(step.tag):
            raise OptionError(
                f"{label(steps, index)}: tag {step.tag!r} is not a letter or _ followed by letters, digits, _ and -"
            )
        if step.tag in tags:
            raise OptionError(f"{label(steps, index)}: tag {step.tag!r} is that of {label(steps, tags[step.tag])} too")
        tags[step.tag] = index
    return tags


def order(steps: Sequence[Step], wires: Sequence[Sequence[int]]) -> list[int]:
    """The order to run in: that of the steps, but none before its inputs."""
    done: list[int] = []
    while len(done) < len(steps):
        waiting = [index for index in range(len(steps)) if index not in done]
        ready = [index for index in waiting if set(wires[index]) <= set(done)]
        if not ready:
            raise OptionError(f"cycle: {_cycle(steps, wires, waiting)}; a stage cannot take what comes of it")
        done.append(ready[0])
    return done


def _cycle(steps: Sequence[Step], wires: Sequence[Sequence[int]], waiting: Sequence[int]) -> str:
    path = [waiting[0]]
    while path.count(path[-1]) < 2:
        path.append(next(index for index in wires[path[-1]] if index in waiting))
    round_trip = path[path.index(path[-1]) :][::-1]
    return " -> ".join(label(steps, index) for index in round_trip)


def _check_used(steps: Sequence[Step], wires: Sequence[Sequence[int]]) -> None:
    used = {source for sources in wires for source in sources}
    for index, step in enumerate(steps):
        if step.stage.starts() and index not in used and len(steps) > 1:
            raise OptionError(f"{label(steps, index)}: no stage takes its mesh")


def upstream(wires: Sequence[Sequence[int]], index: int) -> set[int]:
    """Every step that ``index`` gets its mesh through."""
    found: set[int] = set()
    ahead = list(wires[index])
    while ahead:
        source = ahead.pop()
        if source not in found:
            found.add(source)
            ahead += wires[source]
    return found
