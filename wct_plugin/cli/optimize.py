"""``wct optimize``: one mesh or surface in, a well-centered mesh out."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
from rich.text import Text

from wct_plugin.cli import filter_options, formats_of_streams
from wct_plugin.cli.in_and_out import in_and_out
from wct_plugin.cli.messages import GOAL_MET, err, out
from wct_plugin.cli.output import check_apart, print_before_after, write_text, writes_over
from wct_plugin.cli.progress_bar import progress_bar
from wct_plugin.cli.time_limit import CommandLimit, time_limit_option
from wct_plugin.errors import OptionError
from wct_plugin.io import read
from wct_plugin.io.region_choice import Regions
from wct_plugin.io.standard_streams import STREAM
from wct_plugin.measure.goals import DUAL
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline import json_form
from wct_plugin.pipeline.flow import side_by_side
from wct_plugin.pipeline.fractions import told_as_lengths
from wct_plugin.pipeline.graph import Step, unplaced_errors
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.pipeline.readers_writers import (
    FileOptions,
    ReadMesh,
    WriteMesh,
    Writer,
    WriteReport,
    mesh_reader,
    report_content,
)
from wct_plugin.pipeline.remaking import MESHER_PREFIX, flag
from wct_plugin.pipeline.stage import FilterStage, Options, find_filter

#: The filters ``wct optimize`` may run, the default first.
OPTIMIZERS = ("meshing_well_centered", "apply_coord_well_centering")
_MESHER = "generate_tetrahedralization"


@click.command()
@click.option(
    "--filter",
    "optimizer_name",
    type=click.Choice(OPTIMIZERS),
    default=OPTIMIZERS[0],
    show_default=True,
    help="What improves the tets; the options below are those of the default, `wct filters NAME` shows another's",
)
@filter_options.filter_options(*OPTIMIZERS)
@filter_options.filter_options(_MESHER, prefix=MESHER_PREFIX)
@filter_options.order_option
@filter_options.msh_options
@in_and_out
@formats_of_streams.output_format
@time_limit_option
@click.option("--json", "json_path", metavar="FILE", help="Write the reports before and after as JSON (- for stdout)")
@click.option(
    "--html",
    "html_path",
    metavar="FILE",
    callback=filter_options.page_name,
    help="Write the reports before and after as one HTML page",
)
@click.option("--print-pipeline", is_flag=True, help="Print the pipeline that does the same under `wct run`, and end")
def optimize(
    source: str,
    target: str,
    optimizer_name: str,
    order: int | None,
    regions: Regions,
    repair: bool,
    max_bytes: int | None,
    input_format: str | None,
    output_format: str | None,
    seconds: float | None,
    json_path: str | None,
    html_path: str | None,
    print_pipeline: bool,
    **values: Any,
) -> int:
    """Improve the tets of IN and write OUT; a surface IN goes through fTetWild or TetGen first.

    OUT may be IN with --force, which also makes a mesh anew that meets the goal already.

    - as IN is standard input, as OUT standard output: wct optimize - - --input-format vtu --output-format msh

    Exit code 0: every tet meets the goal, and all of the domain is kept. 1: the best mesh is written, and the last line
    says what was missed. 2: an error or an interrupt, which says what was written before it, if anything.
    """
    formats_of_streams.leave_stdout(target, json_path)
    check_apart([source], json_path, html_path)
    limit = CommandLimit(seconds)
    over = writes_over(source, target, allowed=bool(values["force"]))
    if over and (optimizer_name != OPTIMIZERS[0] or values["goal"] in DUAL):
        values["force"] = None  # which is for the file alone there
    mesher_options = filter_options.given(values, _MESHER, prefix=MESHER_PREFIX)
    with told_as_lengths(lambda: read(source, suffix=input_format, regions=regions, repair=repair)):
        optimizer = find_filter(optimizer_name)(**filter_options.given(values, *OPTIMIZERS))
        mesher = find_filter(_MESHER)(**mesher_options)
    written = filter_options.given_msh(values) | ({} if output_format is None else {"format": output_format})
    written |= {"order": order} if order else {}
    writers = [WriteMesh(filename=target, **written), *_report_writers(json=json_path, html=html_path)]
    for writer in writers:  # before the file is read, which may take long
        writer.validate()
        writer.check_takes(TetMesh)

    mesh = read(source, suffix=input_format, regions=regions, repair=repair, max_bytes=max_bytes)
    filters = [optimizer]
    if isinstance(mesh, SurfaceMesh):
        filters = [mesher, optimizer]
    elif mesher_options:
        named = flag(next(iter(mesher_options)), MESHER_PREFIX)
        raise OptionError(f"{named} is for surfaces; {source} has tets already")
    reader = mesh_reader(source, regions, input_format=input_format, repair=repair, max_bytes=max_bytes)
    if print_pipeline:
        chain = _optimizing(reader, filters, writers)
        with unplaced_errors():
            chain.check()
        write_text("-", json_form.text(chain.to_json()))
        return GOAL_MET
    with unplaced_errors(), progress_bar() as progress:
        result = _optimizing(reader.holding(mesh), filters, writers).execute(limit.beside(progress))
    optimized = len(filters)  # the stage that improves; its mesh as written is what the next one hands on
    flows = {"before": result.stages[optimized - 1].flow, "after": result.stages[optimized + 1].flow}
    if json_path == "-":
        write_text("-", json.dumps(report_content(flows), indent=2))
    else:
        print_before_after(*side_by_side(flows).values())
    console = err if json_path == "-" else out
    for goal in result.goals:  # the last lines say what exit code 1 is for
        if not goal.met:
            console.print(Text(f"missed: {goal}"))
    return limit.exit_code(result, console)


def _report_writers(**paths: str | None) -> list[WriteReport]:
    """Writers of reports, by their format, to the files of those that are given; standard output is not theirs."""
    return [
        WriteReport(filename=path, **({} if Path(path).suffix.lower() == f".{form}" else {"format": form}))
        for form, path in paths.items()
        if path is not None and path != STREAM
    ]


def _optimizing(
    reader: ReadMesh, filters: Sequence[FilterStage[Options]], writers: Sequence[Writer[FileOptions]]
) -> Pipeline:
    """What ``wct optimize`` runs: the last of ``filters`` is the one that stands between before and after."""
    tags = ("before", "after") if len(writers) > 1 else ("", "")
    mesh_writer, *report_writers = writers
    *made, optimizer = filters
    *others, last = (reader, *made)
    steps = [*map(Step, others), Step(last, tags[0]), Step(optimizer), Step(mesh_writer, tags[1])]
    return Pipeline([*steps, *(Step(writer, inputs=tags) for writer in report_writers)])
