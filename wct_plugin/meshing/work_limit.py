"""How long a search may go on: counted in work, not in seconds, so that its result is the same on any machine."""

#: Evaluations of a tet's energy allowed whatever the size, and per tet of the larger of input and start. From 6 to 14
#: of them take a microsecond, so that all together ends within some 6 s and 4 ms per tet of CPU time.
_BASE = 75_000_000
_PER_TET = 42_000
#: What making a start costs, in evaluations per tet of it.
_START = 1_500


class WorkLimit:
    """What searches and their starts may cost together, and have cost since :meth:`begin_with`."""

    def __init__(self, tets: int, effort: int) -> None:
        """Begin; ``tets`` of the input."""
        self._tets = tets
        self._effort = effort
        self._spent = 0
        self.reached = False  #: whether a search or a start was cut off

    @property
    def left(self) -> int:
        """Evaluations that are left."""
        allowed = self._effort * (_BASE + _PER_TET * self._tets)
        return max(0, int(allowed) - self._spent)

    def begin_with(self, tets: int) -> None:
        """Count anew, from a start of so many tets."""
        self._spent = 0
        self.add_start(tets)

    def add_start(self, tets: int) -> None:
        """Count a start of so many tets."""
        self._tets = max(self._tets, tets)
        self._spent += _START * tets

    def add_search(self, evaluations: int, *, stuck: int) -> None:
        """Count a search that leaves so many tets stuck."""
        self._spent += evaluations
        self.reached = stuck > 0 and self.left == 0
