"""How many tets a result may have at most, and how many a start is expected to have before it is made."""

import warnings

from wct_plugin.errors import WctWarning
from wct_plugin.meshing.phase_progress import Listener

#: A start is not even begun where so many times more tets are expected than there may be: the estimate is not off by
#: more where the tolerance is above the depth of the surface's own facets.
_SURELY = 1.25


class TetLimit:
    """The most that there may be (None: any number), and what has been expected and refused on the way."""

    def __init__(self, most: int | None, listen: Listener) -> None:
        self.most = most
        self.expected: int | None = None  #: tets of the first start, about
        self.refused = ""  #: the start that had too many tets, in words
        self._listen = listen

    def expect(self, tets: float) -> bool:
        """Hear about how many tets a start will have; whether to make it."""
        if self.expected is None:
            self.expected = round(tets)
        if self.most is not None and tets > _SURELY * self.most:
            self._refuse(f"about {_rounded(tets)}")
            return False
        return self._listen.expect(round(tets))

    def takes(self, tets: int) -> bool:
        """Whether a mesh of so many tets may be a start or a result."""
        if self.holds(tets):
            return True
        self._refuse(str(tets))
        return False

    def holds(self, tets: int) -> bool:
        """Whether so many may be."""
        return self.most is None or tets <= self.most

    def warn(self, *, missed: bool) -> None:
        """Say what was refused, where something asked for is missed."""
        if self.refused and missed:
            warnings.warn(
                f"a start of {self.refused} tets was not taken, as option 'max_tets' is {self.most}; a larger tolerance"
                " or a longer edge_length takes fewer",
                WctWarning,
                stacklevel=4,
            )

    def _refuse(self, tets: str) -> None:
        self.refused = self.refused or tets


def _rounded(tets: float) -> str:
    """To two digits, as no more of them mean anything."""
    return f"{float(f'{tets:.1e}'):,.0f}".replace(",", " ")
