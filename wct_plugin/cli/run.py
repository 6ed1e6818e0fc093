"""``wct run``: pipelines from JSON."""

import json
import sys
from collections.abc import Sequence

import click
from click.shell_completion import CompletionItem
from rich.text import Text

from wct_plugin.cli import filter_options, formats_of_streams
from wct_plugin.cli.messages import GOAL_MET, err, out
from wct_plugin.cli.output import check_apart, check_outputs, print_result, write_text, writes_over
from wct_plugin.cli.progress_bar import progress_bar
from wct_plugin.cli.settings import set_option
from wct_plugin.cli.time_limit import CommandLimit, time_limit_option
from wct_plugin.errors import WctError
from wct_plugin.io import read
from wct_plugin.io.region_choice import Regions
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline import presets
from wct_plugin.pipeline.fractions import told_as_lengths
from wct_plugin.pipeline.json_schema import schema
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.pipeline.readers_writers import Writer

_READY_MADE = "\b\nReady-made pipelines:\n" + "\n".join(
    f"  {name:<20} {presets.description(name)}" for name in presets.names()
)


def read_pipeline(chain: str, settings: Sequence[str]) -> Pipeline:
    """The pipeline of a JSON file, of stdin (``-``) or of a ready-made one's name."""
    content = sys.stdin.buffer.read() if chain == "-" else presets.read(chain)
    try:
        return Pipeline.from_json(content, settings)
    except WctError as error:
        error.args = (f"{'stdin' if chain == '-' else chain}: {error}", *error.args[1:])
        raise


def complete_pipeline(_context: click.Context, _param: click.Parameter, begun: str) -> list[CompletionItem]:
    """Ready-made pipelines, and files."""
    ready = [CompletionItem(name) for name in presets.names() if name.startswith(begun)]
    return [*ready, CompletionItem(begun, type="file")]


@click.command("run", epilog=_READY_MADE)
@click.argument("chain", metavar="PIPELINE", required=False, shell_complete=complete_pipeline)
@click.argument("paths", metavar="[IN [OUT...]]", nargs=-1)
@set_option
@filter_options.regions_option
@filter_options.max_bytes_option
@formats_of_streams.input_format
@formats_of_streams.output_format
@time_limit_option
@click.option("--force", is_flag=True, help="Write over IN where an OUT is the same file")
@click.option("--validate", is_flag=True, help="Check the pipeline and end; inputs are read, no filter runs")
@click.option(
    "--metadata", "metadata_path", metavar="FILE", help="Write options, metrics, seconds as JSON (- for stdout)"
)
@click.option("--schema", "print_schema", is_flag=True, help="Print the JSON schema of pipelines and end")
def run_pipeline(
    chain: str | None,
    paths: Sequence[str],
    settings: Sequence[str],
    regions: Regions,
    max_bytes: int | None,
    input_format: str | None,
    output_format: str | None,
    seconds: float | None,
    force: bool,
    validate: bool,
    metadata_path: str | None,
    print_schema: bool,
) -> int:
    """Run PIPELINE: a JSON file, - for stdin, or the name of a ready-made one.

    IN is read before its first stage, each OUT written behind its last one: a mesh, or the report where the name ends
    in .html or .json. A pipeline with files of its own needs neither.

    Exit code 0: every tet meets the goal of the last filter that has one and all of the domain is kept, or none has a
    goal. 1: something was missed, and the last line says what; all is written. 2: an error or an interrupt, which says
    what was written before it, if anything.
    """
    formats_of_streams.leave_stdout(*paths[1:], metadata_path)
    if chain == "-" and paths[:1] == ("-",):
        raise click.UsageError("'-' is given twice; standard input is one file")
    limit = CommandLimit(seconds)
    if print_schema:
        write_text("-", json.dumps(schema(), indent=2))
        return GOAL_MET
    if chain is None:
        raise click.UsageError("Missing argument 'PIPELINE'.")
    for target in paths[1:]:
        writes_over(paths[0], target, allowed=force)
    with told_as_lengths(lambda: read(paths[0] if paths else "", suffix=input_format, regions=regions)):
        pipeline = read_pipeline(chain, settings)
    if paths:
        pipeline = pipeline.between(
            paths[0],
            paths[1:],
            regions=regions,
            max_bytes=max_bytes,
            input_format=input_format,
            output_format=output_format,
        )
    elif regions is not None:
        raise click.UsageError("--regions is of IN; for a reader of the pipeline: --set readers.mesh.regions=NAME")
    elif max_bytes is not None:
        raise click.UsageError("--max-bytes is of IN; for a reader of the pipeline: --set readers.mesh.max_bytes=BYTES")
    if validate:
        pipeline.check([TetMesh, SurfaceMesh], read=True)
        out.print(Text("valid: " + " | ".join(step.stage.type() for step in pipeline.steps)))
        return GOAL_MET
    if pipeline.is_open:
        raise click.UsageError(f"{chain} reads no file of its own; give one: wct run {chain} IN [OUT...]")
    if not metadata_path and not any(isinstance(step.stage, Writer) for step in pipeline.steps):
        raise click.UsageError(f"nothing would be written; give an output: wct run {chain} IN OUT, or --metadata FILE")
    check_apart(paths, metadata_path)
    check_outputs(metadata_path)
    with progress_bar() as progress:
        result = pipeline.execute(limit.beside(progress))
    if metadata_path:
        write_text(metadata_path, json.dumps(result.metadata(), indent=2))
    if metadata_path != "-":
        print_result(result)
    return limit.exit_code(result, err if metadata_path == "-" else out)
