"""The unit of length a mesh is worked on in: a power of two, so that changing it changes no digit.

What makes a tet well-centered has no unit, but on the way to it up to eight lengths are multiplied, which neither 1e-60
nor 1e60 survives. In a unit in which the bounding box is from 1 to 2 long they all fit. Two meshes that differ by a
power of two are then one and the same, and so is all that becomes of them.
"""

import math
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.mesh import SurfaceMesh, TetMesh

Floats = NDArray[np.float64]
Scalable = TypeVar("Scalable", TetMesh, SurfaceMesh)

#: Diagonals of bounding boxes between which floating-point numbers hold volumes, also those of small tets, and their
#: inverses.
SMALLEST, LARGEST = 1e-90, 1e90


def exponent(points: Floats) -> int:
    """Of the greatest power of two no longer than the longest side of the points' bounding box; 0 for one place."""
    longest = float(np.ptp(points, axis=0).max(initial=0.0)) if len(points) else 0.0
    return math.frexp(longest)[1] - 1 if longest > 0.0 else 0


def normalized(points: Floats) -> Floats:
    """The points in the unit in which the longest side of their bounding box is at least 1 and less than 2."""
    return rescaled(points, -exponent(points))


def rescaled(lengths: Floats, by: int) -> Floats:
    """The lengths times 2 ** ``by``."""
    out: Floats = np.ldexp(lengths, by)
    return out


def scaled(mesh: Scalable, by: int) -> Scalable:
    """The mesh, and its reference, times 2 ** ``by``; data stay as they are."""
    if by == 0:
        return mesh
    bigger = replace(mesh, points=rescaled(mesh.points, by))
    if isinstance(bigger, TetMesh) and bigger.reference is not None:
        bigger = replace(bigger, reference=scaled(bigger.reference, by))
    return bigger


def check(mesh: TetMesh) -> None:
    """Raise :class:`InputError` for a mesh too small or too large for its volumes to be numbers."""
    with np.errstate(over="ignore"):
        diagonal = math.hypot(*np.ptp(mesh.points, axis=0).tolist())
    if not SMALLEST <= diagonal <= LARGEST:
        where = f"{mesh.source}: " if mesh.source else ""
        raise InputError(
            f"{where}the bounding box's diagonal is {diagonal:.3g};"
            f" allowed is {SMALLEST:g} to {LARGEST:g}: choose another unit of length"
        )
