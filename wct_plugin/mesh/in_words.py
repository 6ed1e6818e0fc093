"""A mesh or a part of one in one short line, as ``repr`` gives it: what is in it and how much, no arrays."""

from collections.abc import Iterable, Mapping
from typing import Any

#: Names of a kind that are shown.
_MOST = 4


def in_words(thing: object, source: str, counts: Mapping[str, int], names: Mapping[str, Iterable[Any]]) -> str:
    """``<TetMesh part.msh: 1248 points, 5229 tets; names: inlet, outlet>``, without what there is none of."""
    counted = ", ".join(f"{count} {what[:-1] if count == 1 else what}" for what, count in counts.items() if count)
    listed = [f"{what}: {few(list(given))}" for what, given in names.items() if given]
    title = " ".join(filter(None, (type(thing).__name__, source)))
    return f"<{title}: {'; '.join([counted or 'empty', *listed])}>"


def few(names: list[Any]) -> str:
    """The first of the names, and how many more there are."""
    shown = ", ".join(map(str, names[:_MOST]))
    return f"{shown} and {len(names) - _MOST} more" if len(names) > _MOST else shown
