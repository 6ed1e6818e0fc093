"""A limit in seconds for work that reports its progress: when it is over, the work is asked to stop and keep its best.

>>> import wct_plugin as wct
>>> limit = wct.TimeLimit(60)
>>> result = (wct.Reader("part.msh") | wct.Filter.meshing_well_centered()).execute(limit)  # doctest: +SKIP
>>> limit.ended(result)  # doctest: +SKIP
'the time limit of 60 s ended the run; what is written is the best so far'
"""

import math
import time

from wct_plugin.errors import OptionError
from wct_plugin.pipeline.result import Result
from wct_plugin.progress import Progress, ProgressCallback


class TimeLimit:
    """A progress callback that asks to stop once ``seconds`` have gone by since it was made.

    It is no option of a filter: those say what comes out, whatever the machine. Between two calls of a callback work is
    not stopped, nor are programs that know none, such as fTetWild: what comes after them is. Raises
    :class:`OptionError` for what is no number above 0.
    """

    def __init__(self, seconds: float) -> None:
        if not 0 < seconds < math.inf:
            raise OptionError(f"the time limit is {seconds:g} s; allowed is a number above 0")
        self.seconds = seconds
        self._end = time.monotonic() + seconds
        self._asked = False

    def __call__(self, _: Progress) -> bool:
        """Whether there is time left."""
        over = time.monotonic() >= self._end
        self._asked = self._asked or over
        return not over

    def beside(self, progress: ProgressCallback) -> ProgressCallback:
        """A callback that goes on while ``progress`` does and there is time left."""
        return lambda state: progress(state) is not False and self(state)

    def ended(self, result: Result) -> str:
        """A line that says so where the limit ended the run that gave ``result``; empty where it did not."""
        if not self._asked or not any(stage.metrics.get("stopped") for stage in result.stages):
            return ""
        return f"the time limit of {self.seconds:g} s ended the run; what is written is the best so far"
