"""``wct``: parses and prints, nothing else.

Exit codes as in ruff: 0 done and goal met, 1 done and goal missed (the output is written), 2 usage, input or crash.
Results go to stdout; progress, warnings and errors to stderr, errors as one line.
"""

import inspect
import json
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import FrameType
from typing import Any, get_args

import click
from pydantic.fields import FieldInfo
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as ProgressBar
from rich.table import Table
from rich.text import Text

import wct_plugin as wct
from wct_plugin import files, pipeline
from wct_plugin.adapters import formats
from wct_plugin.errors import OptionError, WctError, WctWarning
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.report import Report, make_report
from wct_plugin.report_page import html
from wct_plugin.stage import Filter, Mesh, Metrics, Options, Progress, ProgressCallback, filter_names, find_filter

GOAL_MET, GOAL_MISSED, FAILED = 0, 1, 2

#: The filters ``wct optimize`` may run, the default first.
_OPTIMIZERS = ("meshing_well_centered", "apply_coord_well_centering")
_MESHER = "generate_tetrahedralization"
_MESHER_PREFIX = "mesher_"


def _width(stream: Any) -> int | None:
    return None if stream.isatty() else 120  # a pipe has no width of its own; rich would take 80 and cut tables


out = Console(highlight=False, width=_width(sys.stdout))
err = Console(highlight=False, width=_width(sys.stderr), stderr=True)


# --- options from a filter's declaration ----------------------------------------------------------------------------


def _click_type(field: FieldInfo) -> Any:
    alternatives = [kind for kind in get_args(field.annotation) if kind is not type(None)] or [field.annotation]
    return alternatives[0] if len(alternatives) == 1 and alternatives[0] in (int, float, bool) else str


def _choices(field: FieldInfo) -> list[str]:
    return [choice for choice in get_args(field.annotation) if isinstance(choice, str)]


def describe_default(field: FieldInfo) -> str:
    """Give an option's default as the help prints it."""
    return "none" if field.default is None else str(field.default)


def describe_range(field: FieldInfo) -> str:
    """Give an option's choices or bounds, as declared."""
    if _choices(field):
        return " | ".join(_choices(field))
    signs = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
    bounds = [
        f"{sign} {getattr(mark, name):g}"
        for mark in field.metadata
        for name, sign in signs.items()
        if hasattr(mark, name)
    ]
    return ", ".join(bounds)


def _fields(*names: str) -> dict[str, FieldInfo]:
    found = [find_filter(name).declaration.model_fields.items() for name in reversed(names)]
    return {option: field for fields in found for option, field in fields}


def _parameter(prefix: str, option: str) -> str:
    """The command line's name of a filter's option; ``--mesher-mesher`` would be a stutter."""
    return option if prefix == f"{option}_" else prefix + option


def _flag(prefix: str, option: str) -> str:
    return "--" + _parameter(prefix, option).replace("_", "-")


def _filter_options(*names: str, prefix: str = "") -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Decorate a command with one ``--option`` per field the filters declare; unset ones stay out of the call.

    Where two filters declare a field the help is the first one's; each checks the values it is given by itself.
    """
    fields = _fields(*names)

    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        for option, field in reversed(fields.items()):
            choices = "|".join(_choices(field))
            range_and_default = ["" if choices else describe_range(field), f"default {describe_default(field)}"]
            shown = f"{field.description}  [{'; '.join(filter(None, range_and_default))}]"
            spelling = (_flag(prefix, option), _parameter(prefix, option))
            metavar = f"[{choices}]" if choices else None
            command = click.option(*spelling, type=_click_type(field), metavar=metavar, help=shown)(command)
        return command

    return decorate


def _given(values: dict[str, Any], *names: str, prefix: str = "") -> dict[str, Any]:
    found = {option: values[_parameter(prefix, option)] for option in _fields(*names)}
    return {option: value for option, value in found.items() if value is not None}


# --- progress and Ctrl-C --------------------------------------------------------------------------------------------


@contextmanager
def _progress() -> Iterator[ProgressCallback]:
    """Show a bar on stderr; the first Ctrl-C asks the filter to stop and keep its best, the second one breaks."""
    stop = threading.Event()

    def interrupt(_signal: int, _frame: FrameType | None) -> None:
        if stop.is_set():
            raise KeyboardInterrupt
        stop.set()  # and no more: the signal may have come in the middle of a print

    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[bad]}"), TimeElapsedColumn())
    with ProgressBar(*columns, console=err, transient=True, disable=not err.is_terminal) as bar:
        task = bar.add_task("", total=1.0, bad="")
        before = signal.getsignal(signal.SIGINT)

        def show(state: Progress) -> bool:
            if state.bad is not None:  # only a filter that has a best so far can be asked to keep it
                signal.signal(signal.SIGINT, interrupt)
            bad = "" if state.bad is None else f"{state.bad} bad"
            new = bar.tasks[task].description != state.stage  # shown at once, however short the stage is
            bar.update(task, description=state.stage, completed=state.done, bad=bad, refresh=new)
            if stop.is_set():
                err.print("stopping; the best so far is kept (Ctrl-C again to give up)")
                return False
            return True

        try:
            yield show
        finally:
            signal.signal(signal.SIGINT, before)


# --- tables ---------------------------------------------------------------------------------------------------------


def _table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]], *, left: bool = False) -> Table:
    table = Table(title=title, title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    for index, name in enumerate(head):
        table.add_column(name, justify="left" if index == 0 or left else "right", overflow="fold")
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    return table


def _print_report(report: Report) -> None:
    out.print(Text(report.headline(), style="bold"))
    out.print(_table("Ranges", ("", "min", "max"), report.rows_ranges()))
    out.print(_table("Well-centered", ("", "tets", "percent"), report.rows_flags()))
    out.print(_table("Tiers", ("", "", ""), report.rows_tiers(), left=True))
    out.print(_table("Where the bad tets are", ("", "tets", "not 3WC", "not CWC"), report.rows_places()))
    for title, lines in report.text_histograms():
        out.print(Text(title, style="bold"))
        for line in lines:
            out.print(Text(line))
    if report.worst:
        out.print(_table("Worst tets", report.worst_head(), report.rows_worst()))


def _print_before_after(before: Report, after: Report) -> None:
    rows = [(name, old, new) for (name, old), (_, new) in zip(before.rows_summary(), after.rows_summary(), strict=True)]
    out.print(_table(f"{before.source} -> {after.source}", ("", "before", "after"), rows))
    if left := after.left():
        out.print(_table(*left, left=True))
    for note in after.notes:
        out.print(Text(note))


def _report(mesh: Mesh, worst: int = 10, found: Metrics | None = None) -> Report:
    find_filter("get_quality").check_takes(type(mesh))
    assert isinstance(mesh, TetMesh)
    return make_report(mesh, worst, found)


def _meets(report: Report, goal: str) -> bool:
    return report.flags[goal] == report.tets


def _write_text(path: str, text: str) -> None:
    if path == "-":
        click.echo(text)
        return
    with files.replacing(Path(path)) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _check_outputs(*paths: str | None) -> None:
    for path in paths:
        if path not in (None, "-"):
            files.check_writable(Path(path))


# --- commands -------------------------------------------------------------------------------------------------------


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="wct_plugin")
def cli() -> None:
    """Make tetrahedral meshes well-centered, and say how well-centered they are."""


@cli.command()
@click.argument("source", metavar="IN")
@click.argument("target", metavar="OUT")
@click.option(
    "--filter",
    "optimizer_name",
    type=click.Choice(_OPTIMIZERS),
    default=_OPTIMIZERS[0],
    show_default=True,
    help="What improves the tets; the options below are those of the default, `wct filters NAME` shows another's",
)
@_filter_options(*_OPTIMIZERS)
@_filter_options(_MESHER, prefix=_MESHER_PREFIX)
@click.option("--json", "json_path", metavar="FILE", help="Write the reports before and after as JSON (- for stdout)")
@click.option("--html", "html_path", metavar="FILE", help="Write the reports before and after as one HTML page")
def optimize(
    source: str, target: str, optimizer_name: str, json_path: str | None, html_path: str | None, **values: Any
) -> int:
    """Improve the tets of IN and write OUT; a surface IN goes through fTetWild or TetGen first.

    Exit code 0: every tet meets the goal. 1: not every one, the best mesh is written. 2: nothing is written.
    """
    optimizer = find_filter(optimizer_name)(**_given(values, *_OPTIMIZERS))
    mesher_options = _given(values, _MESHER, prefix=_MESHER_PREFIX)
    mesher = find_filter(_MESHER)(**mesher_options)
    _check_outputs(target, json_path, html_path)
    formats.to_write(Path(target), volume=True)

    mesh = wct.read(source)
    chain: list[Filter[Options]] = []
    if isinstance(mesh, SurfaceMesh):
        chain = [pipeline.mesher_within_tolerance(mesher, optimizer)]
    elif mesher_options:
        raise OptionError(
            f"{_flag(_MESHER_PREFIX, next(iter(mesher_options)))} is for surfaces; {source} has tets already"
        )
    pipeline.check(type(mesh), [*chain, optimizer])
    with _progress() as progress:
        tets, mesher_metrics = pipeline.run(mesh, chain, progress)
        done, metrics = pipeline.run(tets, [optimizer], progress)
    assert isinstance(tets, TetMesh)
    assert isinstance(done, TetMesh)
    wct.write(target, done)
    before = _report(replace(tets, reference=done.reference))
    after = _report(replace(done, source=target), found=metrics[optimizer_name])
    if json_path:
        content = {"before": before.to_dict(), "after": after.to_dict(), "filters": mesher_metrics | metrics}
        _write_text(json_path, json.dumps(content, indent=2))
    if html_path:
        _write_text(html_path, html([before, after], f"{source} → {target}"))
    if json_path != "-":
        _print_before_after(before, after)
    return GOAL_MET if _meets(after, optimizer.options.model_dump()["goal"]) else GOAL_MISSED


@cli.command()
@click.argument("sources", metavar="FILE...", nargs=-1, required=True)
@click.option("--json", "json_path", metavar="FILE", help="Write JSON (- for stdout): one object, or a list of them")
@click.option("--html", "html_path", metavar="FILE", help="Write one self-contained HTML page")
@click.option("--worst", type=click.IntRange(min=0), default=10, show_default=True, help="How many worst tets to list")
@click.option("--goal", type=click.Choice(["3wc", "cwc"]), help="Exit with 1 unless every tet of every FILE meets it")
def report(sources: Sequence[str], json_path: str | None, html_path: str | None, worst: int, goal: str | None) -> int:
    """Measure tet meshes: ranges, tiers, flags, histograms, and the worst tets with their place."""
    _check_outputs(json_path, html_path)
    reports = []
    for source in sources:
        reports.append(_report(wct.read(source), worst))
    if html_path:
        _write_text(html_path, html(reports, ", ".join(sources)))
    if json_path:
        found = [one.to_dict() for one in reports]
        _write_text(json_path, json.dumps(found[0] if len(found) == 1 else found, indent=2))
    if json_path != "-":
        for one in reports:
            _print_report(one)
    return GOAL_MET if goal is None or all(_meets(one, goal) for one in reports) else GOAL_MISSED


@cli.command()
@click.argument("name", required=False)
@click.option("--json", "json_path", metavar="FILE", help="Write the declarations as JSON schema (- for stdout)")
def filters(name: str | None, json_path: str | None) -> int:
    """List the filters, or print one filter's page: what it does, its options, their ranges and defaults."""
    _check_outputs(json_path)
    names = [name] if name else filter_names()
    found = [find_filter(one) for one in names]
    if json_path:
        schema = {one.name: {"summary": one.summary(), "options": one.declaration.model_json_schema()} for one in found}
        _write_text(json_path, json.dumps(schema, indent=2))
    if json_path == "-":
        return GOAL_MET
    if name is None:
        out.print(_table("Filters", ("filter", "does"), [(one.name, one.summary()) for one in found], left=True))
        return GOAL_MET
    _print_page(found[0])
    return GOAL_MET


def _print_page(stage: type[Filter[Options]]) -> None:
    kinds = {TetMesh: "tet mesh", SurfaceMesh: "surface"}
    out.print(Text(f"filters.{stage.name}", style="bold"), Text(f"({kinds[stage.takes]} -> {kinds[stage.gives]})"))
    out.print(Text(inspect.cleandoc(stage.__doc__ or "")))
    fields = stage.declaration.model_fields.items()
    rows = [(name, describe_default(field), describe_range(field), field.description or "") for name, field in fields]
    out.print(_table("Options", ("option", "default", "allowed", "what"), rows, left=True))


def _fail(message: str) -> int:
    err.print(Text("error: ", style="bold red") + Text(" ".join(message.split())), soft_wrap=True)
    return FAILED


def _show_warning(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
    if issubclass(category, WctWarning):
        err.print(Text("warning: ", style="yellow") + Text(" ".join(str(message).split())), soft_wrap=True)


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and give its exit code; errors are printed as one line."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # other packages' warnings are for programmers
            warnings.simplefilter("always", WctWarning)
            warnings.showwarning = _show_warning
            code = cli.main(args=arguments, prog_name="wct", standalone_mode=False)
    except click.ClickException as error:
        return _fail(error.format_message())
    except WctError as error:
        return _fail(str(error))
    except (KeyboardInterrupt, click.Abort):
        return _fail("interrupted; nothing was written")
    except Exception as error:  # a bug of ours: still one line, still exit code 2; the traceback on request
        if os.environ.get("WCT_TRACEBACK"):
            raise
        return _fail(f"internal error, please report it: {type(error).__name__}: {error} (WCT_TRACEBACK=1 shows where)")
    return code if isinstance(code, int) else GOAL_MET


def main() -> None:
    """Entry point of the ``wct`` script."""
    sys.exit(run())
