"""``progress=True``: where the work stands, printed to stderr; over and over in one line where that can be."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TextIO

from wct_plugin.progress import Progress, ProgressCallback, ProgressChoice
from wct_plugin.waiting.standing import Standing

#: Seconds between two updates of a line, and between two lines where none can be written over.
_UPDATES, LINES = 0.2, 30.0


@contextmanager
def told(progress: ProgressChoice) -> Iterator[ProgressCallback]:
    """The callback that ``progress`` stands for: itself, one that prints, or one that does nothing."""
    if callable(progress):
        yield progress
    elif not progress:
        yield _silent
    else:
        printing = _Printing(sys.stderr)
        try:
            yield printing
        finally:
            printing.end()


def _silent(_: Progress) -> bool:
    return True


def _rewrites(stream: TextIO) -> bool:
    """Whether a line can be written over: on a terminal, and in a notebook."""
    return stream.isatty() or type(stream).__module__.startswith("ipykernel")


class _Printing:
    """Prints each :class:`Progress` that it is called with, at most so often."""

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic) -> None:
        self._stream = stream
        self._clock = clock
        self._standing = Standing(clock)
        self._live = _rewrites(stream)
        self._width = 0
        self._next = clock() + (0.0 if self._live else LINES)

    def __call__(self, state: Progress) -> bool:
        self._standing.hear(state)
        now = self._clock()
        if now >= self._next:
            self._next = now + (_UPDATES if self._live else LINES)
            self._print(self._standing.line())
        return True

    def _print(self, line: str) -> None:
        if not self._live:
            self._stream.write(f"{line}\n")
        else:
            self._stream.write(f"\r{line.ljust(self._width)}")
            self._width = len(line)
        self._stream.flush()

    def end(self) -> None:
        """Take the line away, as what comes next is to begin in its place."""
        if self._live and self._width:
            self._stream.write(f"\r{' ' * self._width}\r")
            self._stream.flush()
