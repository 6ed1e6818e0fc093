"""What stays of a mesh that came right nearly everywhere, and where it is made anew."""

from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from wct_plugin.finer import middles

if TYPE_CHECKING:  # the stubs' names are not in the module
    from wct_plugin._core import SearchedArrays

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Radius within which points are new, in edges of the tet that is stuck: more would undo what came right round it. It
#: grows each time in vain.
_RADIUS = 1.4
_GROWTH = 1.4
#: Share of stuck tets up to which the rest is worth keeping.
_FEW = 0.002


class Renewal(NamedTuple):
    """Points (k, 3) with stratum and label (k,) stay, but for those within ``radius`` (z,) of ``at`` (z, 3)."""

    points: Floats
    stratum: Ints
    label: Ints
    at: Floats
    radius: Floats
    old: "SearchedArrays"  #: where they are from

    @classmethod
    def of(cls, found: "SearchedArrays", vain: int) -> Self | None:
        """A search's result, to be made anew where it is stuck; None where too much of it is.

        ``vain``: how often that has brought nothing.
        """
        tets, stuck = found["tets"], found["stuck"]
        if len(stuck) > _FEW * len(tets):
            return None
        region = np.empty(len(found["points"]), dtype=np.int64)
        region[tets.ravel()] = np.repeat(found["regions"], 4)
        keep = (found["stratum"] < 3) | (found["label"] >= 0)  # but for corners that do not move anyway
        at, edge = middles(found["points"][tets[stuck]])
        return cls(
            found["points"][keep],
            found["stratum"][keep].astype(np.int64),
            np.where(found["stratum"] > 0, found["label"], region)[keep],
            at,
            _RADIUS * _GROWTH**vain * edge,
            found,
        )
