"""``filters.create_cube``: the cube, cut into well-centered tetrahedra."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from wct_plugin.creation import bundled_meshes, metrics
from wct_plugin.creation.face_groups import with_faces
from wct_plugin.mesh import TetMesh
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import ProgressCallback
from wct_plugin.types import Metrics

_Variant = Literal["194", "194_paper", "194_best", "104", "87", "84", "33", "32", "30"]
CubeVariant = Annotated[_Variant, BeforeValidator(str)]


class CubeOptions(Options):
    """Which mesh of the cube, and how large."""

    variant: CubeVariant = Field(
        "194",
        description="Number of tets. 194: its faces match each other; 194_paper: on the paper's surface; 194_best: best"
        " quality; 104; 87: the fewest with clearance; 84: the fewest known; 33, 32, 30: 3-well-centered only",
    )
    size: float = Field(1.0, gt=0, description="Edge length")


class CreateCube(FilterStage[CubeOptions]):
    """Make a cube of few tets that are all well-centered, completely so in all variants of 84 and more.

    ``194_best`` has better quality than the paper's best cube, of 224 tets; ``32`` than its 3-well-centered one of 146.
    Coordinates have five decimals. The smaller the mesh, the narrower its margin: in h/R and in the
    cosines of the facet angles, that of ``104`` is 0.034, of ``87`` 0.008, of ``84`` 0.0002. The facets of the faces
    are tagged 1 to 6, ``x_min`` to ``z_max``.
    """

    name = "create_cube"
    takes = None
    gives = TetMesh
    declaration = CubeOptions
    example: ClassVar[dict[str, Any]] = {"variant": "84"}

    def run(self, mesh: None, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        points, tets = bundled_meshes.load(f"cube_{self.options.variant}")
        made = with_faces(TetMesh(points * self.options.size, tets, mends=False))
        return made, metrics.metrics(made)
