"""``filters.create_tetrahedron``: one tetrahedron, the paper's examples among them."""

from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from wct_plugin.creation import metrics
from wct_plugin.creation.face_groups import with_faces
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import EDGES
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import ProgressCallback
from wct_plugin.types import Metrics

#: The paper's six figures on the unit sphere, by whether they are dihedral acute, 2- and 3-well-centered (y) or not
#: (n); the second of Sommerville's, which tiles space; and the regular one.
_CORNERS = {
    "regular": [(1, 1, 1), (1, -1, -1), (-1, -1, 1), (-1, 1, -1)],
    "sommerville": [(-1, -2, 0), (1, 0, -2), (-1, 2, 0), (1, 0, 2)],
    "y2y3y": [(0.6, -0.64, -0.48), (0.48, 0.8, -0.36), (-0.96, 0, -0.28), (0, 0, 1)],
    "n2y3y": [(0, 0.96, -0.28), (-0.744, -0.64, -0.192), (0.856, -0.48, -0.192), (-0.48, 0.192, 0.856)],
    "n2n3n": [(0.224, -0.768, -0.6), (0.8, 0, -0.6), (0.224, 0.768, -0.6), (-0.28, 0, 0.96)],
    "y2y3n": [(0.36, -0.8, -0.48), (0.768, 0.28, -0.576), (-0.6, 0.64, -0.48), (0.576, 0.168, 0.8)],
    "n2y3n": [(-0.152, 0.864, -0.48), (-0.64, -0.6, -0.48), (0.6, -0.64, -0.48), (-0.192, -0.64, 0.744)],
    "n2n3y": [(0, -0.6, -0.8), (0.64, -0.024, -0.768), (-0.64, -0.024, -0.768), (0, 0.352, 0.936)],
}


class TetrahedronOptions(Options):
    """Which tetrahedron, and how large."""

    name: Literal["regular", "sommerville", "y2y3y", "n2y3y", "n2n3n", "y2y3n", "n2y3n", "n2n3y"] = Field(
        "regular",
        description="regular; sommerville tiles space; the paper's others: acute, 2WC, 3WC, each y or n",
    )
    size: float | None = Field(
        None, gt=0, description="Length of the longest edge (none: the paper's coordinates; regular: 8 ** 0.5)"
    )


class CreateTetrahedron(FilterStage[TetrahedronOptions]):
    """Make one tetrahedron: the regular one, Sommerville's, or one of the six figures of the paper.

    The figures are named by what they show: dihedral acute, 2-well-centered (``2``), 3-well-centered (``3``), each
    with y or n; ``n2y3y`` is completely well-centered and not acute. Its facets are tagged, ``face_1`` to ``face_4``;
    one that faces along an axis is ``x_min``, ...
    """

    name = "create_tetrahedron"
    takes = None
    gives = TetMesh
    declaration = TetrahedronOptions
    example: ClassVar[dict[str, Any]] = {"name": "sommerville"}

    def run(self, mesh: None, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        points = np.array(_CORNERS[self.options.name], dtype=np.float64)
        if self.options.size is not None:
            edges = points[EDGES[:, 1]] - points[EDGES[:, 0]]
            points *= self.options.size / np.linalg.norm(edges, axis=1).max()
        made = with_faces(TetMesh(points, np.array([[0, 1, 2, 3]]), mends=False))
        return made, metrics.metrics(made)
