"""The bar that shows how far long work is, and what Ctrl-C does meanwhile."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as ProgressBar

from wct_plugin.cli.interrupt import FirstAsks
from wct_plugin.cli.messages import err
from wct_plugin.progress import Progress, ProgressCallback


@contextmanager
def progress_bar() -> Iterator[ProgressCallback]:
    """Show a bar on stderr; the first Ctrl-C or SIGTERM asks the filter to stop and keep its best, a second ends it."""
    what, bad = (TextColumn(text, markup=False) for text in ("{task.description}", "{task.fields[bad]}"))
    columns = (what, BarColumn(), bad, TimeElapsedColumn())
    with (
        ProgressBar(*columns, console=err, transient=True, disable=not err.is_terminal) as bar,
        FirstAsks() as signals,
    ):
        task = bar.add_task("", total=1.0, bad="")

        def show(state: Progress) -> bool:
            signals.turn(on=state.bad is not None)  # only a filter that has a best so far can be asked to keep it
            bad = "" if state.bad is None else f"{state.bad} bad"
            if state.expected is not None:
                bad += f", about {state.expected} tets"
            new = bar.tasks[task].description != state.stage  # shown at once, however short the stage is
            bar.update(task, description=state.stage, completed=state.done, bad=bad, refresh=new)
            if signals.asked:
                err.print("stopping; the best so far is kept (a second Ctrl-C or SIGTERM gives up)")
                return False
            return True

        yield show
