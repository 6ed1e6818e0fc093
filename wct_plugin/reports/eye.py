"""Where a mesh is looked at from: upright, its longer side in front."""

from dataclasses import dataclass

import numpy as np

from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.triangle_surfaces import normals
from wct_plugin.types import Floats

#: Columns of points turned so that the third is up, for either axis that files use as up.
_TURNED = {"z": ((0, 1, 2), (1.0, 1.0, 1.0)), "y": ((0, 2, 1), (1.0, -1.0, 1.0))}
#: What stands on a flat base has at least so much of its outline's area in facets at the bottom that look down.
_BASE = 0.1
#: The bottom: so much of the height. Looking down: the cosine to the vertical is at least so much.
_BOTTOM, _DOWN = 0.02, 0.9
#: What has no base and is longer along y than along x and z by so much stands on y.
_TALL = 1.3


@dataclass(frozen=True, eq=False)
class Eye:
    """A parallel projection. ``axes`` (3, 3): rows right, up and towards the eye."""

    axes: Floats
    upward: str  #: y or z

    @classmethod
    def of(cls, mesh: TetMesh, behind: bool = False) -> "Eye":
        """From above, or from below and behind, so that the two show every side; the longer side in front."""
        upward = _upward(mesh)
        order, signs = _TURNED[upward]
        extent = np.ptp(mesh.points, axis=0)[list(order)]
        turn = np.radians((30.0 if extent[1] > 1.1 * extent[0] else -60.0) + 180.0 * behind)
        tilt = np.radians(-25.0 if behind else 25.0)
        away = np.array([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)])
        right = np.array([-np.sin(turn), np.cos(turn), 0.0])
        turned = np.stack([right, np.cross(away, right), away])
        axes = np.empty((3, 3))
        axes[:, order] = turned * np.array(signs)
        return cls(axes, upward)

    def see(self, points: Floats) -> Floats:
        """Points in the picture's axes."""
        return points @ self.axes.T


def _upward(mesh: TetMesh) -> str:
    """The axis that is up: z, unless the mesh stands on a flat base or is tall along y and not along z.

    Files do not say which it is; engineers' have z up, scans and models for pictures y.
    """
    if _base(mesh, 2) >= _BASE:
        return "z"
    if _base(mesh, 1) >= _BASE:
        return "y"
    extent = np.ptp(mesh.points, axis=0)
    return "y" if extent[1] > _TALL * max(extent[0], extent[2]) else "z"


def _base(mesh: TetMesh, axis: int) -> float:
    """Area of the facets at the bottom that look down along an axis, as a share of the box's area there."""
    low, extent = mesh.points.min(axis=0), np.ptp(mesh.points, axis=0)
    points = (mesh.points - low) / np.maximum(extent, 1e-300)  # areas are shares of the box
    normal = normals(points, mesh.topology.boundary)
    length = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    down = (points[mesh.topology.boundary, axis].max(axis=1) < _BOTTOM) & (-normal[:, axis] > _DOWN * length)
    return float(-normal[down, axis].sum()) / 2.0
