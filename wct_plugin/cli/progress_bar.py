"""Where long work stands, shown on stderr, and what Ctrl-C does meanwhile."""

import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

from rich.console import RenderableType
from rich.progress import BarColumn, TextColumn
from rich.progress import Progress as ProgressBar
from rich.text import Text

from wct_plugin.cli.interrupt import FirstAsks
from wct_plugin.cli.messages import err
from wct_plugin.progress import Progress, ProgressCallback
from wct_plugin.waiting.printed import LINES
from wct_plugin.waiting.remaining import PER_TET
from wct_plugin.waiting.standing import Standing, roughly

#: Seconds above which it is said before the start how long the work may take.
_LONG = 10.0


@contextmanager
def progress_bar() -> Iterator[ProgressCallback]:
    """Show a bar on a terminal, else a line now and then.

    The first Ctrl-C or SIGTERM asks the filter to stop and keep its best, a second ends it.
    """
    standing = Standing()
    shown = _bar(standing) if err.is_terminal and not err.quiet else _lines(standing)
    with shown as refresh, FirstAsks() as signals:
        estimated, phase = False, ""

        def hear(state: Progress) -> bool:
            nonlocal estimated, phase
            if state.expected and not estimated:
                estimated = True
                _print_estimate(state.expected)
            signals.turn(on=state.bad is not None)  # only a filter that has a best so far can be asked to keep it
            standing.hear(state)
            if state.stage != phase:  # shown at once, however short it is
                phase = state.stage
                refresh()
            if signals.asked:
                err.print("stopping; the best so far is kept (a second Ctrl-C or SIGTERM gives up)")
                return False
            return True

        yield hear


def _print_estimate(tets: int) -> None:
    """Say how large the mesh will be and how long it may take, where that is worth a line."""
    if PER_TET * tets >= _LONG:
        err.print(Text(f"about {tets} tets will be made; that may take {roughly(PER_TET * tets)} or a few times that"))


class _Bar(ProgressBar):
    """What is at work in a line of its own, and below it how far it is."""

    def __init__(self, standing: Standing) -> None:
        self._standing = standing
        times = TextColumn("{task.description}", markup=False)
        super().__init__(BarColumn(), times, console=err, transient=True, refresh_per_second=5)
        self.add_task("", total=1.0)

    def get_renderables(self) -> Iterable[RenderableType]:
        """Called at every refresh, from a thread of rich's own: time goes by while nothing is said."""
        done = self._standing.fraction()
        for task in self.tasks:  # none while it is being set up
            task.total = None if done is None else 1.0
            task.completed = done or 0.0
            task.description = self._standing.times()
        yield Text(self._standing.phase(), overflow="ellipsis", no_wrap=True)
        yield self.make_tasks_table(self.tasks)


@contextmanager
def _bar(standing: Standing) -> Iterator[Callable[[], None]]:
    with _Bar(standing) as bar:
        yield bar.refresh


@contextmanager
def _lines(standing: Standing) -> Iterator[Callable[[], None]]:
    """Print a line every half minute, also while nothing is said."""
    over = threading.Event()

    def print_lines() -> None:
        while not over.wait(LINES):
            err.print(Text(standing.line()), soft_wrap=True)

    thread = threading.Thread(target=print_lines, daemon=True)
    thread.start()
    try:
        yield lambda: None
    finally:
        over.set()
        thread.join()
