"""How long a search may go on: counted in work, not in seconds, so that its result is the same on any machine.

Work is counted in evaluations of a tet's energy, of which 15 take about a microsecond; the core counts what else takes
long, looks at curved surfaces and the making of starts, as so many of them (``cpp/base/work.h``).
"""

#: Allowed whatever the size, and per tet of the larger of input and result: some 5 s and 5 ms per tet of CPU time.
_BASE = 75_000_000
_PER_TET = 75_000


class WorkLimit:
    """What searches and their starts may cost together, and have cost since :meth:`begin`."""

    def __init__(self, tets: int, effort: int) -> None:
        """Begin; ``tets`` of the input."""
        self._input = tets
        self._tets = tets
        self._effort = effort
        self._spent = 0
        self.reached = False  #: whether a search or a start was cut off

    @property
    def left(self) -> int:
        """Work that is left."""
        return max(0, self._effort * (_BASE + _PER_TET * self._tets) - self._spent)

    def begin(self) -> None:
        """Count anew."""
        self._spent = 0
        self._tets = self._input

    def lead_to(self, tets: int) -> None:
        """Allow for a result of so many tets: those of the best mesh so far, or of the first start."""
        self._tets = max(self._input, tets)

    def add_start(self, work: int) -> None:
        """Count a start."""
        self._spent += work

    def add_search(self, work: int, *, stuck: int) -> None:
        """Count a search that leaves so many tets stuck."""
        self._spent += work
        self.reached = stuck > 0 and self.left == 0
