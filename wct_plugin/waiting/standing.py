"""Where the work stands, in words: ``stage 2 of 4: local search: kicks, 34 bad tets left, 0:52, about 40 s left``."""

import time
from collections.abc import Callable

from wct_plugin.progress import Progress
from wct_plugin.waiting.remaining import Remaining

_MINUTE, _HOUR = 60.0, 3600.0


class Standing:
    """Hears every :class:`Progress` of a piece of work and says where it stands."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._began = clock()
        self._state: Progress | None = None
        self._remaining = Remaining(self._began)
        self._fraction = 0.0

    def hear(self, state: Progress) -> None:
        """Hear where it stands; each stage of a pipeline has a clock of its own."""
        now = self._clock()
        if self._state is not None and state.number != self._state.number:
            self._remaining, self._fraction = Remaining(now), 0.0
        self._state = state
        self._remaining.hear(state, now)

    def phase(self) -> str:
        """What is at work, and how many bad tets are left."""
        state = self._state
        if state is None:
            return ""
        place = f"stage {state.number} of {state.count}: " if state.number else ""
        words = [place + state.stage]
        if state.bad:
            words.append(f"{state.bad} bad tet{'' if state.bad == 1 else 's'} left")
        if state.expected and state.stage == "resampling":
            words.append(f"about {state.expected} tets")
        return ", ".join(words)

    def times(self) -> str:
        """Time gone by, and about how much is left of the stage."""
        left = self._remaining.seconds(self._clock())
        return clock_time(self._clock() - self._began) + (f", {roughly(left)} left" if left is not None else "")

    def line(self) -> str:
        """All of it."""
        return ", ".join(filter(None, (self.phase(), self.times())))

    def fraction(self) -> float | None:
        """How much of the stage is done, never less than before; None where nobody knows."""
        now = self._clock()
        left = self._remaining.seconds(now)
        if left is None:
            return self._fraction or None
        gone = now - self._remaining.began
        self._fraction = max(self._fraction, min(gone / (gone + left), 1.0) if gone + left > 0 else 0.0)
        return self._fraction


def clock_time(seconds: float) -> str:
    """As a clock shows it: 0:52, 12:05, 1:02:03."""
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


def roughly(seconds: float) -> str:
    """A time in no more digits than mean something."""
    if seconds < 5.0:
        return "a few seconds"
    if seconds < _MINUTE:
        return f"about {round(seconds / 5.0) * 5} s"
    if seconds < _HOUR:
        return f"about {round(seconds / _MINUTE)} min"
    return f"about {round(seconds / _HOUR, 1):g} h"
