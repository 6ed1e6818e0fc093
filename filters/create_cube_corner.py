"""``filters.create_cube_corner``: the corner of a cube, cut into well-centered tetrahedra."""

from pydantic import Field

from wct_plugin.creation import bundled_meshes, metrics
from wct_plugin.creation.face_groups import with_faces
from wct_plugin.mesh import TetMesh
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import ProgressCallback
from wct_plugin.types import Metrics


class CubeCornerOptions(Options):
    """How large."""

    size: float = Field(1.0, gt=0, description="Length of the three edges at the right-angled corner")


class CreateCubeCorner(FilterStage[CubeCornerOptions]):
    """Make the corner of a cube, cut off by the plane through its neighbours, of 34 completely well-centered tets.

    No tet with three mutually orthogonal faces contains its circumcenter, so that the corner itself needs the most
    work in any well-centered mesh of a box. This one looks the same from each of its three legs. The
    facets of the faces are tagged: ``x_min``, ``y_min``, ``z_min``, and ``face_1`` for the cut.
    """

    name = "create_cube_corner"
    takes = None
    gives = TetMesh
    declaration = CubeCornerOptions

    def run(self, mesh: None, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        points, tets = bundled_meshes.load("cube_corner")
        made = with_faces(TetMesh(points * self.options.size, tets, mends=False))
        return made, metrics.metrics(made)
