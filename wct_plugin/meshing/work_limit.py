"""How long a search may go on: counted in work, not in seconds, so that its result is the same on any machine."""

#: Evaluations of a tet's energy allowed whatever the size, and per tet of the larger of input and start. On curved
#: surfaces 4 to 9 of them take a microsecond, with what is asked of the surface for each, between planes 15 to 20: so
#: all together ends within some 5 s and 5 ms per tet of CPU time.
_BASE = 75_000_000
_PER_TET = 42_000
#: The same where all the surface is planar, and a search goes on to the end.
_BASE_PLANAR = 85_000_000
_PER_TET_PLANAR = 75_000
#: What making a start costs, in evaluations per tet of it.
_START = 1_500


class WorkLimit:
    """What searches and their starts may cost together, and have cost since :meth:`begin_with`."""

    def __init__(self, tets: int, effort: int) -> None:
        """Begin; ``tets`` of the input."""
        self._tets = tets
        self._effort = effort
        self._planar = 0.0
        self._spent = 0
        self.reached = False  #: whether a search or a start was cut off

    @property
    def left(self) -> int:
        """Evaluations that are left."""
        base = _BASE + self._planar * (_BASE_PLANAR - _BASE)
        per_tet = _PER_TET + self._planar * (_PER_TET_PLANAR - _PER_TET)
        return max(0, int(self._effort * (base + per_tet * self._tets)) - self._spent)

    def begin_with(self, tets: int, planar: float = 0.0) -> None:
        """Count anew, from a start of so many tets; the share of the surface that is ``planar``, where that counts."""
        self._spent = 0
        self._planar = planar
        self.add_start(tets)

    def add_start(self, tets: int) -> None:
        """Count a start of so many tets."""
        self._tets = max(self._tets, tets)
        self._spent += _START * tets

    def add_search(self, evaluations: int, *, stuck: int) -> None:
        """Count a search that leaves so many tets stuck."""
        self._spent += evaluations
        self.reached = stuck > 0 and self.left == 0
