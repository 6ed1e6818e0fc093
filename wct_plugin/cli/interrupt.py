"""What ends ``wct`` from outside: Ctrl-C, and SIGTERM, which batch schedulers send. Both do the same."""

import _thread
import signal
import sys
import threading
from types import FrameType

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
#: Seconds after which an interrupt that was lost comes again.
_AGAIN = 0.02


def raise_on_sigterm() -> None:
    """Let SIGTERM raise KeyboardInterrupt, as Python has it for Ctrl-C: what was begun is then tidied up."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)


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

    def _note(self, _signal: int, _frame: FrameType | None) -> None:
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True  # and no more: the signal may have come in the middle of a print
