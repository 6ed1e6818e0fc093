"""Types of ``wct.Filter``, ``wct.apply_filter`` and the like for editors and type checkers, made of the declarations.

``python -m wct_plugin.pipeline.stub FILE`` writes them; ``make docs`` does, into ``signatures.pyi`` beside this file.
Filters of other packages are not among them: their classes have the types, as in ``Theirs(option=1)(mesh)``.
"""

import sys
import types
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from textwrap import indent
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np
from pydantic.fields import FieldInfo
from pydantic.json_schema import SkipJsonSchema

from wct_plugin.objects.conversions import TARGETS
from wct_plugin.pipeline import stage_page
from wct_plugin.pipeline.one_line import OPTIMIZER, optimize
from wct_plugin.pipeline.readers_writers import ENDS, ReadMesh, WriteMesh, WriteReport
from wct_plugin.pipeline.stage import FilterStage, Options, Stage, filter_places, find_filter

#: The committed file.
STUB = Path(__file__).with_name("signatures.pyi")
#: What marks types that JSON cannot hold; to type checkers it is no class.
_FROM_PYTHON: Any = SkipJsonSchema
_OURS = "wct_plugin.filters."
_HEAD = '''"""Made by `make docs` from the declarations of filters, readers and writers: their types."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal, overload

from numpy.typing import ArrayLike

from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.progress import ProgressChoice
from wct_plugin.types import Metrics
'''
_TAG = 'tag: str = ""'
_INPUTS = "inputs: str | Sequence[str] = ()"
_PROGRESS = "progress: ProgressChoice = None"
_FILE = "str | PathLike[str]"


def typed(annotation: Any) -> str:
    """What may be given for an option declared with ``annotation``, as code."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        from_python_only = any(isinstance(mark, _FROM_PYTHON) for mark in parts[1:])
        return "Any" if from_python_only and parts[0] is not np.ndarray else typed(parts[0])
    if origin in (Union, types.UnionType):
        shown = dict.fromkeys(map(typed, parts))
        return "Any" if "Any" in shown else " | ".join(shown)
    if origin is Literal:
        return f"Literal[{', '.join(map(_quoted, parts))}]"
    if origin is dict:
        return f"Mapping[{', '.join(map(typed, parts))}]"
    if origin in (list, tuple):
        return f"Sequence[{' | '.join(dict.fromkeys(map(typed, parts)))}]"
    plain: dict[Any, str] = {types.NoneType: "None", Path: _FILE, np.ndarray: "ArrayLike"}
    if annotation in (str, int, float, bool):
        return str(annotation.__name__)
    return plain.get(annotation, "Any")


def _quoted(value: object) -> str:
    return f'"{value}"' if isinstance(value, str) else repr(value)


def _parameter(name: str, field: FieldInfo) -> str:
    if field.is_required():
        return f"{name}: {typed(field.annotation)}"
    value = field.default
    default = _quoted(value) if isinstance(value, str | int | float | None) else "..."
    return f"{name}: {typed(field.annotation)} = {default}"


def _options(stage: type[Stage[Options]], without: Collection[str] = ()) -> list[str]:
    """The options, those that must be given first."""
    fields = stage.declaration.model_fields.items()
    chosen = [(name, field) for name, field in fields if name not in without]
    return [_parameter(name, field) for name, field in sorted(chosen, key=lambda one: not one[1].is_required())]


def _function(name: str, parameters: Iterable[str], gives: str, doc: str = "", *, overloaded: bool = False) -> str:
    """One function; a method where the first of its parameters is ``self``."""
    lines = ["@overload"] if overloaded else []
    lines += [f"def {name}(", *(f"    {parameter}," for parameter in parameters)]
    if not doc:
        return "\n".join([*lines, f") -> {gives}: ..."])
    text = doc.replace("\\", "\\\\").replace('"""', "'''")
    body = indent(f'"""{text}\n"""' if "\n" in text else f'"""{text}"""', "    ")
    return "\n".join([*lines, f") -> {gives}:", body])


def _method(stage: type[Stage[Options]]) -> str:
    """The stage's constructor."""
    ends = [_TAG] if stage.starts() else [_TAG, _INPUTS]
    return _function(stage.name, ["self", "*", *_options(stage), *ends], "Pipeline", stage_page.docstring(stage))


def _class(name: str, methods: Iterable[str]) -> str:
    return f"class {name}:\n" + indent("\n\n".join(methods), "    ")


def _applied(stage: type[FilterStage[Options]]) -> str:
    """What ``apply_filter`` takes for one filter, and gives."""
    first = f"stage: {typed(Literal[stage.name, stage.type()])}"  # an option may be called name
    mesh = [] if stage.takes is None else ["mesh: Any"]
    gives = f"tuple[{stage.gives.__name__}, Metrics]"
    parameters = [first, *mesh, "/", "*", _PROGRESS, *_options(stage)]
    return _function("apply_filter", parameters, gives, stage_page.docstring(stage, ends=False), overloaded=True)


def _optimized() -> list[str]:
    """``optimize``: of what it knows it gives a tet mesh of ours, else what came in or was asked for."""
    stage = find_filter(OPTIMIZER)
    rest = ["regions: str | Sequence[str] | None = None", _PROGRESS, *_options(stage)]
    target = f"target: {_FILE} | None = None"
    to = f"to: {typed(Literal[TARGETS])} | None = None"
    doc = (optimize.__doc__ or "").strip().splitlines()[0]
    known = [f"source: {_FILE} | TetMesh | SurfaceMesh", target, "*", "to: None = None", *rest]
    return [
        _function("optimize", known, "TetMesh", doc, overloaded=True),
        _function("optimize", ["source: Any", target, "*", to, *rest], "Any", doc, overloaded=True),
    ]


def _reader_call() -> str:
    options = _options(ReadMesh, without=["filename"])
    return _function("__call__", ["self", "source: Any", "*", _TAG, *options], "Pipeline")


def _writer_calls() -> list[str]:
    return [
        _function(
            "__call__",
            ["self", f"target: {_FILE}", "*", _TAG, _INPUTS, *_options(stage, without=["filename"])],
            "Pipeline",
            overloaded=True,
        )
        for stage in (WriteMesh, WriteReport)
    ]


def _ends(family: str) -> list[str]:
    return [_method(one) for one in ENDS.values() if one.family == family]


def text(filters: Mapping[str, type[FilterStage[Options]]]) -> str:
    """The stub for these filters."""
    stages: Sequence[type[FilterStage[Options]]] = list(filters.values())
    parts = [
        _HEAD,
        _class("_Filters", map(_method, stages)),
        _class("_Readers", [_reader_call(), *_ends("readers")]),
        _class("_Writers", [*_writer_calls(), *_ends("writers")]),
        "Filter: _Filters\nReader: _Readers\nWriter: _Writers",
        *map(_applied, stages),
        *_optimized(),
    ]
    return "\n\n".join(parts) + "\n"


def ours() -> dict[str, type[FilterStage[Options]]]:
    """The filters of this package, by name."""
    return {name: find_filter(name) for name, place in filter_places().items() if place.startswith(_OURS)}


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(text(ours()), encoding="utf-8")
