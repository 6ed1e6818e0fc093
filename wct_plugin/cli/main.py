"""``wct``: parses and prints, nothing else.

Exit codes as in ruff: 0 done and goal met, 1 done and goal missed (the output is written), 2 usage, input, crash or
interrupt. Results go to stdout; progress, warnings and errors to stderr, errors as one line, which names what was
written before.
"""

import json
import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

import wct_plugin as wct
from wct_plugin.cli import filter_options
from wct_plugin.cli.batch import batch
from wct_plugin.cli.commands import Commands, completion
from wct_plugin.cli.create import create
from wct_plugin.cli.demo import demo
from wct_plugin.cli.interrupt import raise_on_sigterm
from wct_plugin.cli.output import (
    FAILED,
    GOAL_MET,
    GOAL_MISSED,
    check_outputs,
    fail,
    out,
    print_before_after,
    print_page,
    progress_bar,
    show_warning,
    table,
    write_text,
)
from wct_plugin.cli.report import report
from wct_plugin.cli.run import run_pipeline
from wct_plugin.errors import InternalError, OptionError, WctError, WctWarning, one_line
from wct_plugin.io import atomic_files
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline import json_form, stage_page
from wct_plugin.pipeline.flow import side_by_side
from wct_plugin.pipeline.graph import Step, unplaced
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.pipeline.readers_writers import FileOptions, ReadMesh, WriteMesh, Writer, WriteReport, report_content
from wct_plugin.pipeline.stage import FilterStage, Mesh, Options, filter_names, find_filter

#: The filters ``wct optimize`` may run, the default first.
_OPTIMIZERS = ("meshing_well_centered", "apply_coord_well_centering")
_MESHER = "generate_tetrahedralization"
_MESHER_PREFIX = "mesher_"


def _complete_filter(_context: click.Context, _param: click.Parameter, begun: str) -> list[str]:
    return [name for name in filter_names() if name.startswith(begun)]


# --- commands -------------------------------------------------------------------------------------------------------


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="wct_plugin")
def cli() -> None:
    """Make tetrahedral meshes well-centered, and say how well-centered they are."""


cli.add_command(run_pipeline)
cli.add_command(report)
cli.add_command(create)
cli.add_command(batch)
cli.add_command(demo)
cli.add_command(completion)


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
@filter_options.filter_options(*_OPTIMIZERS)
@filter_options.filter_options(_MESHER, prefix=_MESHER_PREFIX)
@filter_options.msh_options
@click.option("--json", "json_path", metavar="FILE", help="Write the reports before and after as JSON (- for stdout)")
@click.option(
    "--html",
    "html_path",
    metavar="FILE",
    callback=filter_options.not_stdout,
    help="Write the reports before and after as one HTML page",
)
@click.option("--print-pipeline", is_flag=True, help="Print the pipeline that does the same under `wct run`, and end")
def optimize(
    source: str,
    target: str,
    optimizer_name: str,
    json_path: str | None,
    html_path: str | None,
    print_pipeline: bool,
    **values: Any,
) -> int:
    """Improve the tets of IN and write OUT; a surface IN goes through fTetWild or TetGen first.

    Exit code 0: every tet meets the goal. 1: not every one, the best mesh is written. 2: an error or an interrupt,
    which says what was written before it, if anything.
    """
    optimizer = find_filter(optimizer_name)(**filter_options.given(values, *_OPTIMIZERS))
    mesher_options = filter_options.given(values, _MESHER, prefix=_MESHER_PREFIX)
    mesher = find_filter(_MESHER)(**mesher_options)
    reports = [
        WriteReport(filename=path, **({} if Path(path).suffix.lower() == f".{form}" else {"format": form}))
        for path, form in ((json_path, "json"), (html_path, "html"))
        if path not in (None, "-")
    ]
    writers: list[Writer[FileOptions]] = [WriteMesh(filename=target, **filter_options.given_msh(values)), *reports]
    for writer in writers:  # before the file is read, which may take long
        writer.validate()
        writer.check_takes(TetMesh)

    mesh = wct.read(source)
    filters = [optimizer]
    if isinstance(mesh, SurfaceMesh):
        filters = [mesher, optimizer]
    elif mesher_options:
        flag = filter_options.flag(next(iter(mesher_options)), _MESHER_PREFIX)
        raise OptionError(f"{flag} is for surfaces; {source} has tets already")
    if print_pipeline:
        chain = _optimizing(source, filters, writers)
        with _unplaced():
            chain.check()
        write_text("-", json_form.text(chain.to_json()))
        return GOAL_MET
    with _unplaced(), progress_bar() as progress:
        result = _optimizing(mesh, filters, writers).execute(progress)
    optimized = len(filters)  # the stage that improves; its mesh as written is what the next one hands on
    flows = {"before": result.stages[optimized - 1].flow, "after": result.stages[optimized + 1].flow}
    if json_path == "-":
        write_text("-", json.dumps(report_content(flows), indent=2))
    else:
        print_before_after(*side_by_side(flows).values())
    return GOAL_MET if result.goal_met else GOAL_MISSED


@contextmanager
def _unplaced() -> Iterator[None]:
    """Take the number of the stage from errors: who runs one filter never numbered any."""
    try:
        yield
    except WctError as error:
        error.args = (unplaced(str(error)), *error.args[1:])
        raise


def _optimizing(
    source: str | Mesh, filters: Sequence[FilterStage[Options]], writers: Sequence[Writer[FileOptions]]
) -> Pipeline:
    """What ``wct optimize`` runs: the last of ``filters`` is the one that stands between before and after."""
    tags = ("before", "after") if len(writers) > 1 else ("", "")
    mesh_writer, *report_writers = writers
    *made, optimizer = filters
    *others, last = (ReadMesh(filename=source), *made)
    steps = [*map(Step, others), Step(last, tags[0]), Step(optimizer), Step(mesh_writer, tags[1])]
    return Pipeline([*steps, *(Step(writer, inputs=tags) for writer in report_writers)])


@cli.command()
@click.argument("name", required=False, shell_complete=_complete_filter)
@click.option("--json", "json_path", metavar="FILE", help="Write the declarations as JSON schema (- for stdout)")
@click.option("--markdown", "markdown_path", metavar="FILE", help="Write the filters' pages as Markdown (- for stdout)")
def filters(name: str | None, json_path: str | None, markdown_path: str | None) -> int:
    """List the filters, or print one filter's page: what it does, its options, their ranges and defaults."""
    check_outputs(json_path, markdown_path)
    found: dict[str, type[FilterStage[Options]]] = {}
    broken: dict[str, str] = {}
    for one in [name] if name else filter_names():
        try:
            found[one] = find_filter(one)
        except WctError as error:  # another package's; the list has a line that says so
            if name:
                raise
            broken[one] = str(error)
    if json_path:
        schema: dict[str, Any] = {one: {"error": message} for one, message in broken.items()}
        for stage in found.values():
            schema[stage.name] = {"summary": stage.summary(), "options": stage.declaration.model_json_schema()}
        write_text(json_path, json.dumps(schema, indent=2))
    if markdown_path:
        write_text(markdown_path, stage_page.markdown(found.values()))
    if "-" in (json_path, markdown_path):
        return GOAL_MET
    if name:
        print_page(*found.values())
        return GOAL_MET
    lines = {one: stage.summary() for one, stage in found.items()} | broken
    out.print(table("Filters", ("filter", "does"), sorted(lines.items()), left=True))
    return GOAL_MET


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and give its exit code; errors are printed as one line, with what was written before."""
    with atomic_files.noting() as written:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # other packages' warnings are for programmers
                warnings.simplefilter("always", WctWarning)
                warnings.showwarning = show_warning
                code = cli.main(args=arguments, prog_name="wct", standalone_mode=False)
        except click.ClickException as error:
            message = error.format_message()
        except InternalError as error:
            message = _crash(error)
        except WctError as error:
            message = str(error)
        except BrokenPipeError:  # whoever read stdout has read enough, as head does
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return FAILED
        except (KeyboardInterrupt, click.Abort):
            message = "interrupted" if written.names() else "interrupted; nothing was written"
        except Exception as error:
            message = _crash(error)
        else:
            return code if isinstance(code, int) else GOAL_MET
        before = ", ".join(written.names())
        return fail(f"{message}; written before: {before}" if before else message)


def _crash(error: Exception) -> str:
    """What is said of a bug of ours: still one line, still exit code 2; the traceback on request."""
    if os.environ.get("WCT_TRACEBACK"):
        raise error
    return f"{one_line(error)} (WCT_TRACEBACK=1 shows where)"


def main() -> None:
    """Entry point of the ``wct`` script."""
    raise_on_sigterm()
    sys.exit(run())
