"""The faces of what is made from nothing, as named groups of facets: where boundary conditions go."""

from dataclasses import replace

import numpy as np

from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.triangle_surfaces import normals
from wct_plugin.types import Floats, Ints

#: Names of the groups of facets that face along an axis, in the order of their tags, from 1.
SIDES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
#: Cosine of the angle between facets that face the same way: coordinates are rounded.
_SAME = np.cos(np.radians(0.1))


def with_faces(mesh: TetMesh, *, ragged_ends: bool = False) -> TetMesh:
    """The mesh with each facet of its boundary in the group of those that face the same way.

    Along the axes these are ``x_min`` to ``z_max``; others are ``face_1``, ``face_2``, ... With ``ragged_ends`` all
    that face along no axis are in ``x_min`` or ``x_max``, whichever they face.
    """
    triangles = mesh.topology.boundary
    facing = normals(mesh.points / mesh.diagonal, triangles)
    facing /= np.linalg.norm(facing, axis=1, keepdims=True)
    tags = _along_axes(facing)
    if ragged_ends:
        tags = np.where(tags == 0, np.where(facing[:, 0] < 0, 1, 2), tags)
    names = {SIDES[tag - 1]: (tag, 2) for tag in np.unique(tags[tags != 0]).tolist()}
    number = 0
    while not tags.all():
        alike = (tags == 0) & (facing @ facing[np.argmax(tags == 0)] > _SAME)
        number += 1
        tags[alike] = len(SIDES) + number
        names[f"face_{number}"] = (len(SIDES) + number, 2)
    return replace(mesh, facets=Cells(triangles, tags), names={**mesh.names, **names})


def _along_axes(facing: Floats) -> Ints:
    """(k,) the tag of each facet that faces along an axis, 0 for the others."""
    axes = np.repeat(np.eye(3), 2, axis=0) * np.tile([[-1.0], [1.0]], (3, 1))
    cosines = facing @ axes.T
    return np.where(cosines.max(axis=1) > _SAME, 1 + cosines.argmax(axis=1), 0)
