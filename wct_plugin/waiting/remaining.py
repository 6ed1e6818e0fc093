"""About how many seconds a stage still takes, from what it has said so far.

Most stages say how much is done, and the rest takes as long in proportion. The remesher cannot: how often its search
must kick is not known before. What is known is how many tets its start has, which a start and the sweeps over it take
time in proportion to, and that kicks make the bad tets fewer by about the same factor every second.
"""

import math
from dataclasses import dataclass, field

from wct_plugin.progress import Progress

#: Seconds per tet of a start: for all of the work, and for making the start, as measured on ordinary meshes.
PER_TET = 2.5e-4
_PER_TET_OF_START = 1.5e-4
#: What making the start takes of all of the time, .4 to .9 where it is long; what must be done of it to count alone.
_START, _SURE = 0.6, 0.2
#: After the sweeps: seconds for each bad tet that is left, on the machine that the others were measured on.
_PER_BAD = 0.08
#: The part of the bad tets that all sweeps together leave.
_SWEPT = 0.15
#: Of the time so far: what widening margins and measuring take, and another start with its search.
_MEASURING, _AGAIN = 0.08, 0.35
#: Where less is done, or less time has gone by, a proportion says nothing.
_LEAST_DONE, _LEAST_SECONDS = 0.02, 0.3


@dataclass
class Remaining:
    """Hears where one stage stands; the clock is the caller's."""

    began: float
    _state: Progress | None = None
    _searching: float | None = None  #: when the first search began
    _kicks: "_Decline | None" = None
    _starts: int = field(default=0)

    def hear(self, state: Progress, now: float) -> None:
        """Hear where it stands."""
        before = self._state.stage if self._state else ""
        self._state = state
        phase = state.stage
        if phase == "resampling" and before != phase:
            self._starts += 1
        if phase.startswith("local search") and self._searching is None:
            self._searching = now
        if phase != "local search: kicks":
            self._kicks = None
        elif self._kicks is None and state.bad:
            self._kicks = _Decline(now, state.bad)

    def seconds(self, now: float) -> float | None:
        """What is left, about; None where nothing is known."""
        state, gone = self._state, now - self.began
        if state is None:
            return None
        if state.stage == "resampling" or state.stage.startswith("local search"):
            return self._of_remesher(state, now, gone)
        if state.stage == "measuring":
            return _MEASURING * gone
        if state.done < _LEAST_DONE or gone < _LEAST_SECONDS:
            return None
        return gone * (1.0 - state.done) / state.done

    def _of_remesher(self, state: Progress, now: float, gone: float) -> float | None:
        last = _MEASURING * gone
        if state.stage == "resampling" and self._starts > 1:
            return _AGAIN * gone
        if self._searching is None:
            return None if state.expected is None else max(_of_start(state.done, state.expected, gone) - gone, last)
        if state.stage == "local search: passes":
            left = (state.bad or 0) * math.pow(_SWEPT, 1.0 - state.done)
            return last + _PER_BAD * self._slowness(state) * left
        if self._kicks is not None and state.bad:
            first = _PER_BAD * self._slowness(state) * self._kicks.bad
            return last + self._kicks.left(state.bad, now, first)
        return last

    def _slowness(self, state: Progress) -> float:
        """How many times as long as where it was measured the start took here."""
        if self._searching is None or not state.expected:
            return 1.0
        return max((self._searching - self.began) / (_PER_TET_OF_START * state.expected), 0.1)


def _of_start(done: float, tets: int, gone: float) -> float:
    """Seconds that all of it takes, by what is done of the start and how many tets it will have."""
    sure = min(done / _SURE, 1.0)
    return (1.0 - sure) * PER_TET * tets + (sure * gone / (_START * done) if done else 0.0)


@dataclass(frozen=True)
class _Decline:
    """Bad tets that become fewer by about the same factor every second, since they were so many."""

    began: float
    bad: int

    def left(self, bad: int, now: float, guess: float) -> float:
        """Seconds until none is left; at first mostly the guess that is given."""
        gone = now - self.began
        fewer = math.log(self.bad / bad) if bad < self.bad else 0.0
        steps = math.log(bad) + 1.0
        # The guess weighs as much as one step, of which there are log(bad) + 1 until none is left.
        pace = (gone + guess / (math.log(self.bad) + 1.0)) / (fewer + 1.0)
        return pace * steps
