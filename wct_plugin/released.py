"""Creases of the surface that the search gave up, as :func:`wct_plugin._core.search_well_centered` says."""

from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from wct_plugin.reference import Reference

Ints = NDArray[np.int64]


class Released(TypedDict):
    """Creases by their angle alone that became ordinary surface, within the tolerance as all of it."""

    creases: int
    length: float  #: together, as a fraction of the surface's bounding-box diagonal


def released(on: Reference, curves: Ints) -> Released:
    """Measure ``curves`` (r,), ids of :class:`wct_plugin.surface.Strata`."""
    segments = on.strata.segments[np.isin(on.strata.curve, curves)]
    ends = on.points[segments]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    return {"creases": len(curves), "length": float(length / on.diagonal)}


def describe(found: Released) -> str:
    """One line for the report, empty where all creases were kept."""
    if not found["creases"]:
        return ""
    what = "1 crease" if found["creases"] == 1 else f"{found['creases']} creases"
    return (
        f"{what} ({found['length']:.2g} of the diagonal long together) too close to others for well-centered tets:"
        " the surface there is within the tolerance, but no edges run along it"
    )
