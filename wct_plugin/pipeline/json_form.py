"""Pipelines as JSON, in PDAL's form: an array of stages, or an object that holds it under ``pipeline``.

A string is a file: the one that comes first is read, every other one is written, as a report where its name ends in
.html or .json. An object has ``type``, the stage's options beside it, and if need be ``tag`` and ``inputs`` (one tag
or a list). With a ``filename`` and no ``type`` it is a file as a string is. Without ``inputs`` a stage takes what the
one before it gives.
"""

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

from wct_plugin.errors import InputError, OptionError, WctError
from wct_plugin.pipeline.graph import Step, find_stage, place, unnamed
from wct_plugin.pipeline.readers_writers import ReadMesh, writer_type
from wct_plugin.pipeline.stage import RESERVED, did_you_mean, unknown_option

#: What the object round a pipeline may hold.
KEYS = ("pipeline", "description", "$schema")


def parse(content: Any, settings: Sequence[str] = ()) -> list[Step]:
    """Steps of JSON text, or of the list or dict that it stands for; ``settings`` are ``stage.option=value``."""
    entries = _entries(load(content) if isinstance(content, str | bytes) else content)
    for setting in settings:
        _set(entries, setting)
    return [_step(entry, place(index, len(entries), entry["type"])) for index, entry in enumerate(entries)]


def load(text: str | bytes) -> Any:
    """What JSON text stands for; :class:`InputError` says in which line it is none."""
    try:
        return json.loads(text, object_pairs_hook=_distinct)
    except UnicodeDecodeError as error:
        raise InputError(f"the pipeline is no JSON: not UTF-8 at byte {error.start}") from error
    except json.JSONDecodeError as error:
        raise InputError(f"the pipeline is no JSON: line {error.lineno}, column {error.colno}: {error.msg}") from error
    except RecursionError as error:
        raise InputError("the pipeline is nested too deep") from error


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise InputError(f"the pipeline has an object with two keys {twice!r}")
    return found


def _entries(content: Any) -> list[dict[str, Any]]:
    """A dict with a type per stage."""
    if isinstance(content, Mapping):
        if unknown := [key for key in content if key not in KEYS]:
            hint = did_you_mean(unknown[0], KEYS)
            raise OptionError(f"unknown key {unknown[0]!r} beside the pipeline{hint} (allowed: {', '.join(KEYS)})")
        if "pipeline" not in content:
            raise OptionError("the object has no key 'pipeline'")
        content = content["pipeline"]
    if not isinstance(content, list | tuple):
        raise OptionError(f"a pipeline is an array of stages, here is {_called(content)}")
    return [_entry(item, index, len(content)) for index, item in enumerate(content)]


def _entry(item: Any, index: int, count: int) -> dict[str, Any]:
    where = place(index, count)
    if isinstance(item, str):
        item = {"filename": item}
    if not isinstance(item, Mapping):
        raise OptionError(f"{where}: a stage is a file's name or an object, here is {_called(item)}")
    entry = dict(item)
    if "type" not in entry:
        if not isinstance(entry.get("filename"), str) or not entry["filename"]:
            raise OptionError(f"{where}: needs a 'type', such as filters.meshing_well_centered, or the name of a file")
        entry["type"] = ReadMesh.type() if index == 0 else writer_type(entry["filename"])
    if not isinstance(entry["type"], str):
        raise OptionError(f"{where}: 'type' must be a string, here is {_called(entry['type'])}")
    return entry


def _step(entry: Mapping[str, Any], where: str) -> Step:
    tag, inputs = entry.get("tag", ""), entry.get("inputs", ())
    if not isinstance(tag, str) or ("tag" in entry and not tag):
        raise OptionError(f"{where}: 'tag' must be a string that is not empty, here is {_called(tag)}")
    if isinstance(inputs, str):
        inputs = [inputs]
    if not isinstance(inputs, list | tuple) or not all(isinstance(one, str) for one in inputs):
        raise OptionError(f"{where}: 'inputs' must be a tag or a list of tags, here is {_called(inputs)}")
    if "inputs" in entry and not inputs:
        raise OptionError(f"{where}: 'inputs' is empty; leave it out to take what the stage before gives")
    options = {key: value for key, value in entry.items() if key not in RESERVED}
    try:
        stage = find_stage(entry["type"])(**options)
    except WctError as error:
        error.args = (f"{where}: {unnamed(str(error), entry['type'])}", *error.args[1:])
        raise
    return Step(stage, tag, tuple(inputs))


def _set(entries: Sequence[dict[str, Any]], setting: str) -> None:
    """Carry out one ``stage.option=value`` on the entry it names by type or tag."""
    path, equals, text = setting.partition("=")
    name, dot, option = path.rpartition(".")
    if not (equals and dot and name and option):
        raise OptionError(f"{setting!r} is not stage.option=value, such as filters.get_quality.worst=3")
    found = [entry for entry in entries if name in (entry["type"], entry.get("tag"))]
    if not found:
        names = [name for entry in entries for name in (entry.get("tag"), entry["type"]) if isinstance(name, str)]
        known = ", ".join(dict.fromkeys(names)) or "none"
        raise OptionError(f"{setting!r}: no stage {name!r} in the pipeline{did_you_mean(name, names)} (there: {known})")
    if len(found) > 1:
        raise OptionError(f"{setting!r}: {len(found)} stages are {name!r}; give them tags and name one")
    declaration = find_stage(found[0]["type"]).declaration
    if option not in declaration.model_fields:
        raise unknown_option(declaration, option, repr(setting))
    try:
        value = json.loads(text)
    except ValueError:
        value = text
    found[0][option] = value


def _called(value: Any) -> str:
    match value:
        case None:
            return "null"
        case str():
            return f"the string {value!r}"
        case bool() | int() | float():
            return f"{json.dumps(value)}"
        case list() | tuple():
            return "an array"
        case Mapping():
            return "an object"
        case _:
            return f"a {type(value).__name__}"


def form(steps: Sequence[Step]) -> list[Any]:
    """The array that :func:`parse` makes these steps of; options that were not given stay out."""
    return [_form(step, place(index, len(steps), step.stage.type()), index) for index, step in enumerate(steps)]


def text(entries: Sequence[Any]) -> str:
    """What :func:`form` gives as JSON text, a line per stage."""
    return "[\n" + ",\n".join(f"  {json.dumps(entry, ensure_ascii=False)}" for entry in entries) + "\n]"


def _form(step: Step, where: str, index: int) -> Any:
    options = step.stage.options
    entry: dict[str, Any] = {"type": step.stage.type()}
    for name in type(options).model_fields:
        if name in options.model_fields_set:
            value = getattr(options, name)
            entry[name] = os.fspath(value) if isinstance(value, os.PathLike) else value
            try:
                json.dumps(entry[name])
            except TypeError as error:
                what = type(entry[name]).__name__
                raise OptionError(f"{where}: option {name!r} is a {what} in memory, which JSON cannot hold") from error
    if step.tag:
        entry["tag"] = step.tag
    if step.inputs:
        entry["inputs"] = list(step.inputs)
    if set(entry) == {"type", "filename"} and _entry(entry["filename"], index, index + 1) == entry:
        return entry["filename"]
    return entry
