"""How many points of a mesh are in a place that others are in too."""

from typing import TypedDict

import numpy as np

from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.coincident_points import places


class Coincident(TypedDict):
    """How many there are."""

    points: int  #: where another one is
    places: int  #: with more than one point


def count_coincident(mesh: TetMesh) -> Coincident:
    """Count those that are equal to the bit."""
    sizes = np.bincount(places(mesh.points))
    return {"points": int(sizes[sizes > 1].sum()), "places": int((sizes > 1).sum())}


def describe(found: Coincident) -> str:
    """A line, or nothing where every point has its own place."""
    if not found["points"]:
        return ""
    return f"{found['points']} points coincide, in {found['places']} places (merge=all joins them)"
