"""How a mesh was made, and what makes it again: the command of ``wct optimize``, else the pipeline for ``wct run``."""

import json
import shlex
from collections.abc import Iterable, Mapping
from pathlib import PurePath
from typing import Any

from wct_plugin.pipeline.flow import Flow, Passed
from wct_plugin.pipeline.provenance import environment, options_of

#: The reader, the mesher and the filters that ``wct optimize`` runs, the first without being asked.
_READER, _MESHER = "readers.mesh", "filters.generate_tetrahedralization"
_OPTIMIZERS = ("filters.meshing_well_centered", "filters.apply_coord_well_centering")
#: What flags for the mesher begin with; ``--mesher-mesher`` would be a stutter.
MESHER_PREFIX = "mesher_"
#: Flags of the reader's options that are not called as these are.
_READING = {"format": "input_format"}


def parameter(option: str, prefix: str = "") -> str:
    """The command line's name of a filter's option."""
    return option if prefix == f"{option}_" else prefix + option


def flag(option: str, prefix: str = "") -> str:
    """The flag of an option."""
    return "--" + parameter(option, prefix).replace("_", "-")


def provenance(flow: Flow) -> dict[str, Any]:
    """How a mesh was made, ready for JSON: the stages it came through with options and seconds, and the versions."""
    return {
        "stages": [
            {
                "type": one.stage.type(),
                "options": options_of(one.stage),
                "given": sorted(one.stage.options.model_fields_set),
                "mesh": one.size,
                "seconds": one.seconds,
            }
            for one in flow.history
        ],
        **environment(),
    }


def remaking(flow: Flow) -> str:
    """Text for a shell in the folder of the files; empty where something was given in memory, which no shell has.

    Of paths it has the names alone, as it may go where the folders are nobody's business. The mesh goes where it was
    written, and to OUT.vtu where it was not.
    """
    target = PurePath(flow.written).name or "OUT.vtu"
    steps = [(one, _given(one)) for one in flow.history]
    if any(_in_memory(value) for _, given in steps for value in given.values()):
        return ""
    types = [one.stage.type() for one, _ in steps]
    if types[0] == _READER and types[-1] in _OPTIMIZERS and types[1:-1] in ([], [_MESHER]):
        return _command(steps, target)
    entries = [*({"type": one.stage.type(), **given} for one, given in steps), target]
    lines = ",\n".join(f"  {json.dumps(entry, ensure_ascii=False)}" for entry in entries)
    return f"wct run - <<'END'\n[\n{lines}\n]\nEND"


def _command(steps: Iterable[tuple[Passed, Mapping[str, Any]]], target: str) -> str:
    (reader, reading), *others, (last, given) = steps
    reading = {_READING.get(name, name): value for name, value in reading.items()}
    words = ["wct", "optimize", str(reading.pop("filename")), target]
    if last.stage.type() != _OPTIMIZERS[0]:
        words += ["--filter", last.stage.name]
    of_filters = [*((one, MESHER_PREFIX, made.stage) for made, one in others), (given, "", last.stage)]
    for options, prefix, stage in ((reading, "", reader.stage), *of_filters):
        defaults = {name: field.default for name, field in stage.declaration.model_fields.items()}
        for name, value in options.items():
            words += _words(flag(name, prefix), value, defaults.get(name))
    return shlex.join(words)


def _words(name: str, value: Any, default: Any) -> list[str]:
    """What sets an option; one that is False unless asked for is asked for by the flag alone."""
    if value is None or (default is False and not value):
        return []
    if default is False:
        return [name]
    match value:
        case list():
            return [word for one in value for word in (name, str(one))]
        case Mapping():
            return [name, ",".join(f"{key}={one}" for key, one in value.items())]
        case bool():
            return [name, str(value).lower()]
        case _:
            return [name, str(value)]


def _given(one: Passed) -> dict[str, Any]:
    given = one.stage.options.model_fields_set
    found = {name: value for name, value in options_of(one.stage).items() if name in given}
    return {name: PurePath(value).name if isinstance(value, str) else value for name, value in found.items()}


def _in_memory(value: Any) -> bool:
    """Whether an option is a mesh without a file, or numbers per point."""
    return (isinstance(value, str) and value.startswith("<")) or (
        isinstance(value, list) and any(isinstance(one, float | list) for one in value)
    )
