"""``filters.create_tetrahedron_subdivision``: the regular tetrahedron, cut into well-centered ones."""

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from wct_plugin.creation import bundled_meshes, metrics
from wct_plugin.creation.face_groups import with_faces
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import EDGES
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import ProgressCallback
from wct_plugin.types import Floats, Metrics

_CORNERS = np.array([[3.0, 3.0, 3.0], [3.0, -3.0, -3.0], [-3.0, 3.0, -3.0], [-3.0, -3.0, 3.0]])

#: Where each edge of the tetrahedron is cut, as a fraction of it past its middle: edges 01, 02, 03, 12, 13, 23.
_CUTS = {
    "8a": (0, -0.1207, -0.1207, -0.1207, -0.1207, 0),  # four slide towards edge 01
    "8b": (0, 0.1072, -0.1072, -0.1072, 0.1072, 0),  # four slide round the cycle 0 2 1 3
    "8": (-0.05326, -0.24366, -0.24366, 0.04828, 0.04828, 0),
}
#: Four corners, and four tets round the edge between the cuts of 01 and 23; the cut of edge k is vertex 4 + k.
_EIGHT = np.array(
    [[0, 4, 6, 5], [1, 4, 7, 8], [2, 5, 9, 7], [3, 6, 8, 9], [4, 9, 5, 7], [4, 9, 7, 8], [4, 9, 8, 6], [4, 9, 6, 5]]
)


class SubdivisionOptions(Options):
    """Which subdivision, and how large."""

    variant: Annotated[Literal["8a", "8b", "8", "49"], BeforeValidator(str)] = Field(
        "8", description="8a, 8b: the paper's; 8: a better one of theirs; 49: the paper's, its four faces alike"
    )
    size: float | None = Field(
        None, gt=0, description="Edge length (none: 72 ** 0.5, corners at (3, 3, 3), (3, -3, -3) and so on)"
    )


class CreateTetrahedronSubdivision(FilterStage[SubdivisionOptions]):
    """Make a regular tetrahedron of 8 or 49 completely well-centered ones.

    8: the midpoints of four edges slide off so that the octahedron between the cut corners becomes well-centered.
    49: its four faces match each other; better than the paper's in every column it prints. The facets of the faces are
    tagged, ``face_1`` to ``face_4``.
    """

    name = "create_tetrahedron_subdivision"
    takes = None
    gives = TetMesh
    declaration = SubdivisionOptions
    example: ClassVar[dict[str, Any]] = {"variant": "49"}

    def run(self, mesh: None, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        variant = self.options.variant
        points, tets = bundled_meshes.load("tetrahedron_49") if variant == "49" else (_cut(_CUTS[variant]), _EIGHT)
        if self.options.size is not None:
            points = points * (self.options.size / np.linalg.norm(_CORNERS[1] - _CORNERS[0]))
        made = with_faces(TetMesh(points, tets, mends=False))
        return made, metrics.metrics(made)


def _cut(past_middle: tuple[float, ...]) -> Floats:
    """The four corners and a point on each edge."""
    start, end = _CORNERS[EDGES[:, 0]], _CORNERS[EDGES[:, 1]]
    cuts = start + (0.5 + np.array(past_middle))[:, None] * (end - start)
    return np.concatenate([_CORNERS, cuts])
