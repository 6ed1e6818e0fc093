"""One reason why a goal is out of reach."""

from collections.abc import Sequence
from dataclasses import dataclass

_KINDS = ("vertex", "edge", "facet", "tet")


@dataclass(frozen=True)
class Reason:
    """Something in a mesh that, under the options given, leaves at least one tet of several short of the goal."""

    cells: tuple[tuple[int, ...], ...]  #: what is to blame: vertices, edges, facets, tets, each by its vertices
    why: str  #: the theorem in words
    tets: tuple[int, ...]  #: at least one of these misses the goal, whatever is done within the options
    frees: str  #: the option that takes the reason away

    def __str__(self) -> str:
        return f"{', '.join(map(name, self.cells))}: {self.why}"


def name(cell: Sequence[int]) -> str:
    """A vertex, edge, facet or tet in words, by its vertices."""
    return " ".join((_KINDS[len(cell) - 1], *map(str, cell)))
