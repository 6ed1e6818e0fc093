"""How far a mesh may be from the surface it follows, place by place: less where walls, gaps and radii are small."""

from typing import NamedTuple, TypedDict

import numpy as np

from wct_plugin.core import _core
from wct_plugin.meshing.reference import Reference
from wct_plugin.meshing.reference_fit import apart_at
from wct_plugin.types import Floats

#: The least, as a share of the tolerance asked for.
_FLOOR = 0.25
#: A default beyond this, as a fraction of the diagonal, is mentioned.
_COARSE = 2e-3


class LeastTolerance(TypedDict):
    """The smallest tolerance of any place."""

    least: float  #: as a fraction of the diagonal
    at: list[float]


class Tolerance(NamedTuple):
    """Lengths: the greatest distance, and per point of the surface where it is less in places (None: it is not)."""

    most: float
    local: Floats | None = None

    def least(self, on: Reference, diagonal: float, scale: float) -> LeastTolerance | None:
        """The smallest; ``scale`` brings places to the user's unit."""
        if self.local is None:
            return None
        row = int(np.argmin(self.local))
        return {"least": float(self.local[row]) / diagonal, "at": (on.points[row] * scale).tolist()}


def find_tolerance(on: Reference, most: float, apart: float = 0.0, own: Reference | None = None) -> Tolerance:
    """At most ``most``, and a tenth of the wall, gap or radius there: no less than a quarter, or what is ``apart``.

    ``apart``: how far the mesh that came in is from the surface where it follows that at all. ``own``: its boundary,
    where that is not the surface itself; it may be farther off in places, as where walls are too thin for its mesher.
    """
    local = _core.local_tolerance(on.surface, tolerance=most, floor=max(_FLOOR * most, apart))
    if own is not None:
        local = np.maximum(local, np.minimum(apart_at(on, own), most))
    return Tolerance(most, local if (local < most).any() else None)


def describe(tolerance: float, default: bool, local: LeastTolerance | None) -> str:
    """What there is to say of the tolerance that was used, a fraction of the diagonal."""
    said = []
    if default and tolerance > _COARSE:
        said.append(
            f"the default tolerance is {tolerance:.1e} of the diagonal: the surface's own facets are that coarse;"
            " --tolerance takes a smaller one"
        )
    if local:
        x, y, z = local["at"]
        said.append(
            f"the tolerance is {tolerance:.2e} of the diagonal, and down to {local['least']:.2e} where walls, gaps or"
            f" radii are small, as near ({x:.4g}, {y:.4g}, {z:.4g})"
        )
    return "; ".join(said)
