"""What ends ``wct`` from outside: Ctrl-C, and SIGTERM, which batch schedulers send. Both do the same."""

import signal
from types import FrameType

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


def raise_on_sigterm() -> None:
    """Let SIGTERM raise KeyboardInterrupt, as Python has it for Ctrl-C: what was begun is then tidied up."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)


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
