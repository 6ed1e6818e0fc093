"""Where ``wct`` prints and how it ends: consoles, exit codes, errors and warnings as one line.

Results go to stdout; progress, warnings and errors to stderr.
"""

import logging
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, Literal

from rich.console import Console, ConsoleOptions, ConsoleRenderable, RenderableType, RenderHook, RenderResult
from rich.control import Control
from rich.segment import Segment
from rich.text import Text

from wct_plugin.errors import WctWarning
from wct_plugin.io.standard_streams import writing_stdout
from wct_plugin.reports.printable import printable

_LOG = logging.getLogger("wct_plugin")

GOAL_MET, GOAL_MISSED, FAILED = 0, 1, 2


def _width(stream: Any) -> int | None:
    """The width to print at: a terminal's own, or that of COLUMNS; rich would take 80 for a pipe and cut tables."""
    given = os.environ.get("COLUMNS", "")
    if given.isdecimal() and int(given) > 0:
        return int(given)
    return None if stream is not None and stream.isatty() else 120


class _Printable:
    """What is printed, with no character in it that would do anything to a terminal: files have any names."""

    def __init__(self, inner: RenderableType) -> None:
        self._inner = inner

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        for segment in console.render(self._inner, options):
            yield segment if segment.control else Segment(printable(segment.text), segment.style)


class _OnlyPrintable(RenderHook):
    """Makes a console print nothing else."""

    def process_renderables(self, renderables: list[ConsoleRenderable]) -> list[ConsoleRenderable]:
        return [one if isinstance(one, Control) else _Printable(one) for one in renderables]


class _Stdout(Console):
    """Standard output; where it takes no more that is an error of one line."""

    def print(self, *objects: Any, **settings: Any) -> None:
        with writing_stdout():
            super().print(*objects, **settings)

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError


class _Stderr(Console):
    """Standard error, which may be full, closed or read by nobody: that ends no work."""

    def print(self, *objects: Any, **settings: Any) -> None:
        with suppress(OSError):
            super().print(*objects, **settings)

    def on_broken_pipe(self) -> None:
        self.quiet = True


def _console(kind: type[Console], stream: Any, **settings: Any) -> Console:
    # With NO_COLOR rich itself would still print bold.
    colors: Literal["auto"] | None = None if os.environ.get("NO_COLOR") else "auto"
    made = kind(highlight=False, markup=False, emoji=False, width=_width(stream), color_system=colors, **settings)
    made.push_render_hook(_OnlyPrintable())
    return made


out = _console(_Stdout, sys.stdout)
err = _console(_Stderr, sys.stderr, stderr=True)


def be_quiet() -> Callable[[], None]:
    """Print nothing but errors until what this gives is called."""
    before = out.quiet, err.quiet
    out.quiet = err.quiet = True

    def talk() -> None:
        out.quiet, err.quiet = before

    return talk


def talk_to_stderr() -> Callable[[], None]:
    """Print on stderr what else goes to stdout, until what this gives is called."""
    out.stderr = True

    def talk() -> None:
        out.stderr = False

    return talk


def fail(message: str) -> int:
    """Print an error as one line and give its exit code."""
    err.quiet = False
    err.print(Text("error: ", style="bold red") + Text(" ".join(message.split())), soft_wrap=True)
    return FAILED


class _Notes(logging.Handler):
    """Prints what the package has to say, each a line on stderr."""

    def emit(self, record: logging.LogRecord) -> None:
        kind = Text("note: ", style="cyan") if record.levelno > logging.DEBUG else Text("debug: ", style="dim")
        err.print(kind + Text(" ".join(record.getMessage().split())), soft_wrap=True)


def be_verbose() -> Callable[[], None]:
    """Print too what is done as it is done, until what this gives is called."""
    before = _LOG.level
    _LOG.setLevel(logging.DEBUG)
    return lambda: _LOG.setLevel(before)


@contextmanager
def showing_notes() -> Iterator[None]:
    """Print what this package logs at the level of INFO, such as where the regions come from."""
    handler, before = _Notes(), _LOG.level
    _LOG.addHandler(handler)
    _LOG.setLevel(logging.INFO)
    try:
        yield
    finally:
        _LOG.removeHandler(handler)
        _LOG.setLevel(before)


def show_warning(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
    """Print one of our warnings as one line, in the place of :func:`warnings.showwarning`."""
    if issubclass(category, WctWarning):
        err.print(Text("warning: ", style="yellow") + Text(" ".join(str(message).split())), soft_wrap=True)
