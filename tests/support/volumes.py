"""Volumes of tets and of regions, from the coordinates alone."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def tet_volumes(mesh: Any) -> NDArray[np.float64]:
    """(m,) the signed volume of each tet."""
    corners = mesh.points[mesh.tets]
    return np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6


def region_volumes(mesh: Any, values: Any = None) -> dict[int, float]:
    """The volume of each region, or of the tets of each of the ``values`` (m,)."""
    size, tags = tet_volumes(mesh), mesh.regions if values is None else values
    return {int(tag): float(size[tags == tag].sum()) for tag in np.unique(tags)}
