"""The unit of length a mesh is worked on in: a power of two, so that changing it changes no digit.

What makes a tet well-centered has no unit, but on the way to it up to eight lengths are multiplied, which neither 1e-60
nor 1e60 survives. In a unit in which the bounding box's diagonal is from 1.5 to 3, as the unit cube's, they all fit.
Two meshes that differ by a power of two are then one and the same, and so is all that becomes of them.
"""

import math
from dataclasses import replace
from typing import TypeVar

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.mesh.mesh import SurfaceMesh, TetMesh
from wct_plugin.types import Floats

Scalable = TypeVar("Scalable", TetMesh, SurfaceMesh)

#: Diagonals of bounding boxes between which floating-point numbers hold volumes, also those of small tets, and their
#: inverses.
SMALLEST, LARGEST = 1e-90, 1e90
#: How many times as large as a mesh its reference may be, and the other way.
APART = 1e20


def exponent(points: Floats) -> int:
    """Of the power of two in which the diagonal of the points' bounding box is at least 1.5, less than 3; 0 without."""
    diagonal = _diagonal(points) if len(points) else 0.0
    return math.frexp(diagonal / 1.5)[1] - 1 if diagonal > 0.0 else 0


def normalized(points: Floats) -> Floats:
    """The points in the unit of :func:`exponent`."""
    return rescaled(points, -exponent(points))


def rescaled(lengths: Floats, by: int) -> Floats:
    """The lengths times 2 ** ``by``."""
    out: Floats = np.ldexp(lengths, by)
    return out


def scaled(mesh: Scalable, by: int) -> Scalable:
    """The mesh, its reference and all else that has coordinates times 2 ** ``by``; data stay as they are."""
    if by == 0:
        return mesh
    points = rescaled(mesh.points, by)
    if isinstance(mesh, SurfaceMesh):
        return replace(mesh, points=points)
    return mesh.altered(
        points=points,
        reference=mesh.reference and scaled(mesh.reference, by),
        others=mesh.others and replace(mesh.others, points=rescaled(mesh.others.points, by)),
        second_order=mesh.second_order and mesh.second_order.scaled(by),
    )


def check(mesh: TetMesh) -> None:
    """Raise :class:`InputError` for a mesh too small or too large for its volumes to be numbers."""
    diagonal = _diagonal(mesh.points)
    if not SMALLEST <= diagonal <= LARGEST:
        raise InputError(
            f"{mesh.source or 'the mesh'}: the bounding box's diagonal is {diagonal:.3g};"
            f" allowed is {SMALLEST:g} to {LARGEST:g}: choose another unit of length"
        )


def check_reference(surface: SurfaceMesh, mesh: TetMesh) -> None:
    """Raise :class:`InputError` for a surface so much smaller or larger that no unit of length suits both."""
    own, other = _diagonal(surface.points[np.unique(surface.triangles)]), _diagonal(mesh.points)
    if not other / APART <= own <= other * APART:
        raise InputError(
            f"{surface.source or 'the reference'}: the bounding box's diagonal is {own:.3g}, that of the mesh"
            f" {other:.3g}; allowed is a factor of {APART:g} between them"
        )


def _diagonal(points: Floats) -> float:
    """As of the meshes, but neither under- nor overflowing where its square does."""
    with np.errstate(over="ignore"):
        return math.hypot(*np.ptp(points, axis=0).tolist())
