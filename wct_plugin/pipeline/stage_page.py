"""A stage's page, made of its declaration: what it does, takes and gives, its options and an example.

The same rows serve the terminal, ``docs/filters.md`` and the docstrings of ``wct.Filter``.
"""

import inspect
import json
import types
from collections.abc import Iterable, Sequence
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline.stage import FilterStage, Kind, Options, Stage

KINDS: dict[Kind, str] = {TetMesh: "tet mesh", SurfaceMesh: "surface"}
_INPUT: dict[Kind, str] = {TetMesh: "part.msh", SurfaceMesh: "part.ply"}
_OUTPUT: dict[Kind, str] = {TetMesh: "out.vtu", SurfaceMesh: "out.ply"}
_BOUNDS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


def choices(field: FieldInfo) -> list[str]:
    """The words an option may be, if it is a choice."""
    return [choice for choice in get_args(field.annotation) if isinstance(choice, str)]


def words(annotation: Any) -> list[str]:
    """What may be typed for an option declared with ``annotation`` as far as that is a choice, for completion."""
    if annotation is bool:
        return ["true", "false"]
    if get_origin(annotation) is Literal:
        return [str(choice) for choice in get_args(annotation)]
    if get_origin(annotation) in (Union, types.UnionType, Annotated):
        return [word for part in get_args(annotation) for word in words(part)]
    return []


def describe_default(field: FieldInfo) -> str:
    """Give an option's default as the help prints it."""
    if field.is_required():
        return "required"
    default = field.get_default(call_default_factory=True, validated_data={})
    return "none" if default is None else str(default)


def describe_range(field: FieldInfo) -> str:
    """Give an option's choices or bounds, as declared."""
    if choices(field):
        return " | ".join(choices(field))
    return ", ".join(
        f"{sign} {getattr(mark, name):g}"
        for mark in field.metadata
        for name, sign in _BOUNDS.items()
        if hasattr(mark, name)
    )


def takes_and_gives(stage: type[FilterStage[Options]]) -> str:
    """Both kinds of mesh in words."""
    return f"{KINDS[stage.takes] if stage.takes else 'nothing'} -> {KINDS[stage.gives]}"


def about(stage: type[Stage[Options]]) -> str:
    """What the stage does, as its docstring says it."""
    return inspect.cleandoc(stage.__doc__ or "")


def option_rows(stage: type[Stage[Options]]) -> list[tuple[str, str, str, str]]:
    """Name, default, what is allowed, and help of each option."""
    return [
        (name, describe_default(field), describe_range(field), field.description or "")
        for name, field in stage.declaration.model_fields.items()
    ]


def example(stage: type[FilterStage[Options]]) -> list[Any]:
    """A pipeline that reads a file, runs the filter with the options of its example, and writes a file."""
    source = [_INPUT[stage.takes]] if stage.takes else []
    return [*source, {"type": stage.type(), **stage.example}, _OUTPUT[stage.gives]]


def example_in_python(stage: type[FilterStage[Options]]) -> str:
    """The same pipeline as a line of Python."""
    options = ", ".join(f"{name}={_in_python(value)}" for name, value in stage.example.items())
    source = f'wct.Reader("{_INPUT[stage.takes]}") | ' if stage.takes else ""
    return f'({source}wct.Filter.{stage.name}({options}) | wct.Writer("{_OUTPUT[stage.gives]}")).execute()'


def _in_python(value: Any) -> str:
    return json.dumps(value) if isinstance(value, str) else repr(value)


def example_lines(stage: type[FilterStage[Options]]) -> list[str]:
    """The example as JSON and as Python, for a terminal."""
    return [f"pipeline.json: {json.dumps(example(stage))}", f"Python: {example_in_python(stage)}"]


def docstring(stage: type[Stage[Options]], *, ends: bool = True) -> str:
    """The docstring of the stage's constructor in NumPy's form; ``ends``: with what says how stages hang together."""
    lines = [about(stage), *(["", "Parameters", "----------"] if ends or stage.declaration.model_fields else [])]
    for name, field in stage.declaration.model_fields.items():
        kind = " | ".join(choices(field)) or _called(field.annotation)
        bounds = "" if choices(field) else describe_range(field)
        default = "" if field.is_required() else f"default {describe_default(field)}"
        lines += [f"{name} : {', '.join(filter(None, (kind, bounds, default)))}", f"    {field.description}."]
    if ends:
        lines += ["tag : str", "    Name of the stage, for the inputs of others."]
    if ends and not stage.starts():
        lines += ["inputs : str or list of str"]
        lines += ["    Tag of the stage whose mesh it takes (default: the stage before)."]
    return "\n".join(lines)


def _called(annotation: Any) -> str:
    """A type in words."""
    origin = get_origin(annotation)
    if origin is Annotated:
        return _called(get_args(annotation)[0])
    if origin in (Union, types.UnionType):
        return " or ".join(map(_called, get_args(annotation)))
    if origin is Literal:
        return " | ".join(map(str, get_args(annotation)))
    if annotation is types.NoneType:
        return "None"
    return getattr(origin or annotation, "__name__", str(annotation))


def markdown(filters: Iterable[type[FilterStage[Options]]]) -> str:
    """Every filter's page in one document."""
    found = list(filters)
    parts = [
        "# Filters",
        "Made by `make docs` from the filters' own declarations; `wct filters NAME` prints the same page.",
        table(("filter", "does"), [(f"[{one.name}](#filters{one.name})", one.summary()) for one in found]),
        *map(_section, found),
    ]
    return "\n\n".join(parts) + "\n"


def _section(stage: type[FilterStage[Options]]) -> str:
    rows = [(f"`{name}`", default, _code(allowed), what) for name, default, allowed, what in option_rows(stage)]
    parts = [
        f"## filters.{stage.name}",
        f"*{takes_and_gives(stage)}*",
        about(stage).replace("``", "`"),
        table(("option", "default", "allowed", "what"), rows) if rows else "It has no options.",
        f"```json\n{json.dumps(example(stage))}\n```",
        f"```python\n{example_in_python(stage)}\n```",
    ]
    return "\n\n".join(parts)


def _code(text: str) -> str:
    return f"`{text}`" if text else ""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown; a bar within a cell is escaped."""
    lines = [head, ["---"] * len(head), *([cell.replace("|", "\\|") for cell in row] for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
