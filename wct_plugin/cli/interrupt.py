"""What ends ``wct`` from outside: Ctrl-C, and SIGTERM, which batch schedulers send. Both do the same."""

import _thread
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
#: Seconds after which an interrupt that was lost comes again.
_AGAIN = 0.02


class _Interrupt:
    """What a signal does: it raises KeyboardInterrupt, and is noted."""

    noted = False

    def __call__(self, _signal: int, _frame: FrameType | None) -> None:
        self.noted = True
        raise KeyboardInterrupt


def raise_on_sigterm() -> None:
    """Let SIGTERM raise KeyboardInterrupt, as Python has it for Ctrl-C: what was begun is then tidied up."""
    interrupt = _Interrupt()
    signal.signal(signal.SIGTERM, interrupt)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # a shell may have it ignored
        signal.signal(signal.SIGINT, interrupt)


@contextmanager
def raised_in_the_end() -> Iterator[None]:
    """Raise KeyboardInterrupt for whatever the body raises after one, if :func:`raise_on_sigterm` was called.

    Native code may have put an error of its own in its place, as NumPy does where it compares structured arrays or
    asks an index for its number.
    """
    try:
        yield
    except Exception as error:
        now = (signal.getsignal(one) for one in _SIGNALS)
        if any(isinstance(one, _Interrupt) and one.noted for one in now):
            raise KeyboardInterrupt from error
        raise


def repeat_where_lost() -> None:
    """Let an interrupt come again that was raised where Python drops exceptions: in what runs as an object is freed."""
    before = sys.unraisablehook

    def hear(lost: "sys.UnraisableHookArgs") -> None:
        if not issubclass(lost.exc_type, KeyboardInterrupt):
            before(lost)
            return
        if sys.is_finalizing():  # no thread may begin any more, and there is nothing left to interrupt
            return
        again = threading.Timer(_AGAIN, _thread.interrupt_main)
        again.daemon = False  # it is awaited where the interpreter ends, and nothing of Python's runs on after that
        again.start()

    sys.unraisablehook = hear


def end_at_once() -> None:
    """Let either signal end the process without a word: all is done."""
    for one in _SIGNALS:
        signal.signal(one, signal.SIG_DFL)


class FirstAsks:
    """While it is on, the first signal only sets ``asked``; the second one raises KeyboardInterrupt.

    It is off at first, and again when the ``with`` block ends: signals then do what they did before it.
    """

    def __init__(self) -> None:
        self.asked = False

    def __enter__(self) -> "FirstAsks":
        self._before = {one: signal.getsignal(one) for one in _SIGNALS}
        return self

    def __exit__(self, *_: object) -> None:
        self.turn(on=False)

    def turn(self, *, on: bool) -> None:
        """Turn it on or off; what was asked stays asked."""
        for one, before in self._before.items():
            signal.signal(one, self._note if on else before)

    def _note(self, signal_: int, frame: FrameType | None) -> None:
        if self.asked:
            before = self._before[signal.Signals(signal_)]
            (before if callable(before) else signal.default_int_handler)(signal_, frame)
        self.asked = True  # and no more: the signal may have come in the middle of a print
