"""Command-line options made from filters' declarations."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar, get_args

import click
from pydantic.fields import FieldInfo

from wct_plugin.io.standard_streams import STREAM
from wct_plugin.pipeline.readers_writers import MeshFileOptions, SourceOptions, TargetOptions
from wct_plugin.pipeline.remaking import flag, parameter
from wct_plugin.pipeline.stage import find_filter
from wct_plugin.pipeline.stage_page import choices, describe_default, describe_range, words

#: What the flags for writing gmsh files begin with.
MSH_PREFIX = "msh_"


def _click_type(field: FieldInfo) -> Any:
    alternatives = [kind for kind in get_args(field.annotation) if kind is not type(None)] or [field.annotation]
    return alternatives[0] if len(alternatives) == 1 and alternatives[0] in (int, float, bool) else str


def _fields(*names: str) -> dict[str, FieldInfo]:
    found = [find_filter(name).declaration.model_fields.items() for name in reversed(names)]
    return {option: field for fields in found for option, field in fields}


def filter_options(*filters: str, prefix: str = "") -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Decorate a command with one ``--option`` per field the filters declare; unset ones stay out of the call.

    What is False unless asked for is asked for by the flag alone, without a value.
    Where two filters declare a field the help is the first one's; each checks the values it is given by itself.
    """
    return _options(_fields(*filters), prefix)


def msh_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Decorate a command with an ``--msh-option`` for each option there is for writing gmsh files."""
    return _options(_msh_fields(), MSH_PREFIX)(command)


def repair_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Decorate a command with ``--repair``."""
    shown = f"{SourceOptions.model_fields['repair'].description}; a warning counts them"
    return click.option("--repair", is_flag=True, help=shown)(command)


class _Size(click.ParamType[int]):
    name = "size"
    _UNITS: ClassVar[dict[str, int]] = {"": 0, "K": 10, "M": 20, "G": 30, "T": 40}

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> int:
        found = re.fullmatch(r"(\d+)([KMGT]?)", str(value).upper())
        if not found or not int(found[1]):
            self.fail(f"{value!r} is no size; allowed is a number of bytes, as 8G or 500M", param, ctx)
        return int(found[1]) << self._UNITS[found[2]]


def max_bytes_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Decorate a command with ``--max-bytes``."""
    shown = "Most bytes that packed or declared arrays of an input may become, as 8G"
    shown += "  [default: 100 times the size of its files, at least 256M]"
    return click.option("--max-bytes", type=_Size(), metavar="SIZE", help=shown)(command)


def order_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Decorate a command with ``--order``."""
    shown = MeshFileOptions.model_fields["order"].description
    return click.option("--order", type=click.IntRange(1, 2), help=shown)(command)


def regions_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Decorate a command with ``--regions``."""
    return click.option(
        "--regions",
        metavar="NAME",
        multiple=True,
        callback=lambda _, __, names: names[0] if len(names) == 1 else list(names) or None,
        help="Array of whole numbers that the regions are, or set of tets; several sets: again, or with commas"
        "  [default: as the file says it]",
    )(command)


def given_msh(values: dict[str, Any]) -> dict[str, Any]:
    """Take those of the command's ``values`` that are for writing gmsh files out, and give the ones that were set."""
    found = {option: values.pop(parameter(option, MSH_PREFIX)) for option in _msh_fields()}
    return {option: value for option, value in found.items() if value is not None}


def _msh_fields() -> dict[str, FieldInfo]:
    fields = MeshFileOptions.model_fields
    return {option: field for option, field in fields.items() if option not in (*TargetOptions.model_fields, "order")}


def _options(fields: dict[str, FieldInfo], prefix: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        for option, field in reversed(fields.items()):
            choice = "|".join(choices(field))
            range_and_default = ["" if choice else describe_range(field), f"default {describe_default(field)}"]
            shown = f"{field.description}  [{'; '.join(filter(None, range_and_default))}]"
            metavar = f"[{choice}]" if choice else None
            names = (flag(option, prefix), parameter(option, prefix))
            kind: dict[str, Any] = {"type": _click_type(field), "metavar": metavar}
            kind["shell_complete"] = _completing(field)
            if field.default is False:
                kind, shown = {"is_flag": True, "default": None}, str(field.description)
            command = click.option(*names, **kind, help=shown)(command)
        return command

    return decorate


def _completing(field: FieldInfo) -> Callable[[click.Context, click.Parameter, str], list[str]]:
    allowed = words(field.annotation)
    return lambda _context, _param, begun: [word for word in allowed if word.startswith(begun)]


def given(values: dict[str, Any], *names: str, prefix: str = "") -> dict[str, Any]:
    """Those of the command's ``values`` that were given for the filters' options."""
    found = {option: values[parameter(option, prefix)] for option in _fields(*names)}
    return {option: value for option, value in found.items() if value is not None}


def page_name(_: click.Context, __: click.Parameter, value: str | None) -> str | None:
    """The name of an HTML page, which has a suffix; ``-`` is refused, as a page is no text to be piped on."""
    if value == STREAM:
        raise click.BadParameter("is '-'; it must be the name of a file")
    return value if value is None or Path(value).suffix or Path(value).is_dir() else f"{value}.html"
