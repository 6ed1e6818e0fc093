"""``wct batch``: many files through one pipeline."""

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import click
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as ProgressBar
from rich.text import Text

from wct_plugin.batch import summary
from wct_plugin.batch.job import Record
from wct_plugin.batch.run import BatchProgress, BatchResult, run_batch
from wct_plugin.cli import filter_options
from wct_plugin.cli.messages import err, fail, out
from wct_plugin.cli.output import print_table
from wct_plugin.cli.run import complete_pipeline, read_pipeline
from wct_plugin.cli.settings import set_option
from wct_plugin.io.region_choice import Regions


class _Shard(click.ParamType[tuple[int, int]]):
    name = "i/n"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, int]:
        found = re.fullmatch(r"(\d+)/(\d+)", str(value))
        if not found:
            self.fail(f"{value!r} is not i/n, such as 1/8 for the first of eight parts", param, ctx)
        return int(found[1]), int(found[2])


@click.command("batch")
@click.argument("chain", metavar="PIPELINE", shell_complete=complete_pipeline)
@click.argument("inputs", metavar="INPUT...", nargs=-1, required=True)
@click.option("-o", "--output", "folder", metavar="DIR", required=True, help="Where the outputs go; made if missing")
@click.option("--format", "suffix", metavar="SUFFIX", help="Of the outputs  [default: each input's own; surfaces: vtu]")
@filter_options.regions_option
@filter_options.max_bytes_option
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Files at a time  [default: number of cores]")
@click.option("--timeout", type=float, metavar="SECONDS", help="Longest that a file may take")
@click.option("--time-limit", type=float, metavar="SECONDS", help="Stop a file after so long and keep its best so far")
@click.option("--memory-limit", type=float, metavar="MB", help="Most memory that a file's processes may use together")
@click.option("--resume", is_flag=True, help="Go on with the batch in DIR; what is finished is not done again")
@click.option("--retry-failed", is_flag=True, help="The same, but try again what failed")
@click.option("--shard", type=_Shard(), help="Only the i-th of n parts: every n-th input in the order of names")
@click.option("--scheduler", metavar="ADDRESS", help="Let the workers of this dask scheduler do it: tcp://host:8786")
@set_option
def batch(
    chain: str,
    inputs: Sequence[str],
    folder: str,
    suffix: str | None,
    regions: Regions,
    max_bytes: int | None,
    jobs: int | None,
    timeout: float | None,
    time_limit: float | None,
    memory_limit: float | None,
    resume: bool,
    retry_failed: bool,
    shard: tuple[int, int] | None,
    scheduler: str | None,
    settings: Sequence[str],
) -> int:
    """Run PIPELINE on many files, each in a process of its own.

    PIPELINE is a JSON file with filters only, - for stdin, or the name of a ready-made one; an INPUT is a file or a
    quoted pattern such as 'parts/**/*.stl'. A crash, hang or blow-up costs that file alone. DIR gets the outputs,
    manifest.jsonl (a line per finished file), summary.csv and summary.html.

    Exit code 0: every file met its goal. 1: some missed it or failed. 2: nothing was started, or it was interrupted or
    could not go on; what is finished is kept.
    """
    pipeline = read_pipeline(chain, settings)
    try:
        with _shown() as progress:
            result = run_batch(
                pipeline,
                inputs,
                folder,
                suffix=suffix,
                regions=regions,
                max_bytes=max_bytes,
                jobs=jobs,
                timeout=timeout,
                time_limit=time_limit,
                memory_limit=memory_limit,
                resume=resume,
                retry_failed=retry_failed,
                shard=shard,
                scheduler=scheduler,
                progress=progress,
            )
    except KeyboardInterrupt as error:
        state = f"{error}, --resume goes on with the rest" if error.args else "nothing was started"
        return fail(f"interrupted; {state}")
    _print(result)
    return result.exit_code


@contextmanager
def _shown() -> Iterator[Callable[[BatchProgress], None]]:
    """Show a bar over all files on a terminal, else a line per file."""
    columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
    with ProgressBar(*columns, console=err, transient=True, disable=not err.is_terminal or err.quiet) as bar:
        task = bar.add_task("")

        def show(state: BatchProgress) -> None:
            failed = f"{state.failed} failed; " if state.failed else ""
            at_work = ", ".join(state.running[:3]) + (", …" if len(state.running) > 3 else "")
            bar.update(task, total=state.total, completed=state.finished, description=f"{failed}{at_work}")
            if state.last is not None and not err.is_terminal:
                err.print(Text(f"[{state.finished}/{state.total}] {_line(state.last)}"), soft_wrap=True)

        yield show


def _line(record: Record) -> str:
    result = summary.RESULTS[record.exit_code]
    said = f"{record.input}: {result}{f': {record.cause}' if record.cause else ''} ({record.seconds:.1f} s)"
    return " ".join(said.split())  # a name may have line breaks


def _print(result: BatchResult) -> None:
    """The table over all files, failures last with their causes."""
    rows = [summary.row(record) for record in result.records]
    print_table("Files", summary.HEAD, rows)
    earlier = len(result.records) - result.done_now
    note = f" ({earlier} of them finished before)" if earlier else ""
    out.print(Text(summary.headline(result.records) + note, style="bold"))
    for name, cause in summary.causes(result.records):
        out.print(Text(f"{name}: ", style="red") + Text(cause), soft_wrap=True)
