"""``filters.generate_tetrahedralization``: from a surface to tetrahedra."""

from typing import Any, ClassVar

from pydantic import Field

from wct_plugin.adapters import pytetwild
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.stage import Filter, Metrics, Options, Progress, ProgressCallback


class TetrahedralizationOptions(Options):
    """What fTetWild is asked for; lengths are fractions of the surface's bounding-box diagonal."""

    edge_length: float = Field(0.05, gt=0, le=1, description="Target edge length, as a fraction of the diagonal")
    epsilon: float = Field(
        5e-4,
        gt=0,
        le=0.1,
        description="Greatest distance of the boundary from the surface, as a fraction of the diagonal",
    )
    stop_energy: float = Field(
        10.0, ge=3, description="Stop when the worst AMIPS energy falls below (3 is a regular tet)"
    )
    num_opt_iter: int = Field(80, ge=0, description="Greatest number of the mesher's optimisation passes")
    timeout: float | None = Field(None, gt=0, description="Seconds after which the mesher is ended (default: none)")


class GenerateTetrahedralization(Filter[TetrahedralizationOptions]):
    """Fill a surface with tetrahedra by fTetWild; the surface travels on as the mesh's reference.

    fTetWild is not reproducible: two runs give two meshes. It heals gaps and self-intersections within ``epsilon``.
    """

    name = "generate_tetrahedralization"
    takes = SurfaceMesh
    gives = TetMesh
    declaration = TetrahedralizationOptions
    example: ClassVar[dict[str, Any]] = {"edge_length": 0.1}

    def run(self, mesh: SurfaceMesh, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        progress(Progress("fTetWild", 0.0))
        tets = pytetwild.tetrahedralize(mesh, **self.options.model_dump())
        return tets, {"tets": len(tets.tets), "points": len(tets.points)}
