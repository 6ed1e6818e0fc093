"""How many tets a result may have at most, and how many a start is expected to have before it is made."""

import math
import warnings

from wct_plugin.errors import WctWarning
from wct_plugin.meshing.phase_progress import Listener

#: A start is not even begun where so many times more tets are expected than there may be: the estimate is not off by
#: more where the tolerance is above the depth of the surface's own facets.
_SURELY = 1.25
#: Nor, where nobody named a limit, with more than so many tets, if that is so many times those that came: a layer of a
#: thousandth of the body, or an edge length in the wrong unit, would take hours and all memory.
_MANY, _TIMES = 2_000_000, 20
#: Another start is expected to have at most so many times the tets of the first, or of what came: with more, of several
#: thousand, more are left bad, and each that is finer still takes several times the work. Of few there may be more.
_GROWTH, _FEW = 3.0, 25_000
#: The same of a start with three rows of tets through layers where the first had one, which is so much easier that it
#: takes no longer.
_GROWTH_IN_LAYERS = 10.0


class TetLimit:
    """The most that there may be (None: any number), and what has been expected and refused on the way.

    ``came``: tets of the mesh that came in.
    """

    def __init__(self, most: int | None, came: int, listen: Listener) -> None:
        self.most = most
        self.expected: int | None = None  #: tets of the first start, about
        self.needed: int | None = None  #: a limit with which the first start that was refused would have been made
        self._came = came
        self._refused = ""  #: how many tets that start had, in words
        self._listen = listen

    def expect(self, tets: float) -> bool:
        """Hear about how many tets a start will have; whether to make it."""
        return self._begins(tets, _GROWTH)

    def expect_more_rows(self, tets: float) -> bool:
        """The same of a start with more rows through layers."""
        return self._begins(tets, _GROWTH_IN_LAYERS)

    def _begins(self, tets: float, growth: float) -> bool:
        if self.expected is None:
            self.expected = round(tets)
        elif tets > max(_FEW, growth * max(self.expected, self._came)):
            return False
        begun = max(_MANY, _TIMES * self._came) if self.most is None else _SURELY * self.most
        if tets > begun:
            self._refuse(tets, f"about {_rounded(tets)}")
            if self.most is None:
                warnings.warn(
                    f"a start of about {_rounded(tets)} tets was not begun, {_rounded(tets / self._came)} times those"
                    f" that came: max_tets={self.needed} allows it; a larger tolerance or a longer edge_length takes"
                    " fewer",
                    WctWarning,
                    stacklevel=4,
                )
            return False
        return self._listen.expect(round(tets))

    def takes(self, tets: int) -> bool:
        """Whether a mesh of so many tets may be a start or a result."""
        if self.holds(tets):
            return True
        self._refuse(tets, str(tets))
        return False

    def holds(self, tets: int) -> bool:
        """Whether so many may be."""
        return self.most is None or tets <= self.most

    def warn(self, *, missed: bool) -> None:
        """Say what was refused, where something asked for is missed."""
        if self._refused and missed and self.most is not None:
            warnings.warn(
                f"a start of {self._refused} tets was not taken, as option 'max_tets' is {self.most}; a larger"
                " tolerance or a longer edge_length takes fewer",
                WctWarning,
                stacklevel=4,
            )

    def _refuse(self, tets: float, said: str) -> None:
        self._refused = self._refused or said
        if self.needed is None:
            digit = 10.0 ** (math.floor(math.log10(tets)) - 1)
            self.needed = round(math.ceil(_SURELY * tets / digit) * digit)


def _rounded(tets: float) -> str:
    """To two digits, as no more of them mean anything."""
    return f"{float(f'{tets:.1e}'):,.0f}".replace(",", " ")
