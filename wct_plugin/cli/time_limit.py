"""The option ``--time-limit`` of commands that run filters, and how they end where the time was up."""

import click
from rich.console import Console
from rich.text import Text

from wct_plugin.cli.messages import GOAL_MET, GOAL_MISSED
from wct_plugin.pipeline.result import Result
from wct_plugin.pipeline.time_limit import TimeLimit
from wct_plugin.progress import ProgressCallback

time_limit_option = click.option(
    "--time-limit",
    "seconds",
    type=click.FloatRange(min=0, min_open=True),
    metavar="SECONDS",
    help="Stop after so long and keep the best so far, with exit code 1; a mesher before it is waited for",
)


class CommandLimit:
    """The time limit of a command, if it has one."""

    def __init__(self, seconds: float | None) -> None:
        self._limit = None if seconds is None else TimeLimit(seconds)

    def beside(self, progress: ProgressCallback) -> ProgressCallback:
        """The callback, with the limit."""
        return progress if self._limit is None else self._limit.beside(progress)

    def exit_code(self, result: Result, last_line_to: Console) -> int:
        """The command's exit code; where the limit ended the run, a last line says so."""
        ended = "" if self._limit is None else self._limit.ended(result)
        if ended:
            last_line_to.print(Text(ended), soft_wrap=True)
        return GOAL_MET if result.goal_met and not ended else GOAL_MISSED
