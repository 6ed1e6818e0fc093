"""``filters.generate_tetrahedralization``: from a surface to tetrahedra."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from wct_plugin.adapters import ftetwild, tetgen
from wct_plugin.measure.planar import check_not_planar
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline.stage import FilterStage, OfDiagonal, Options
from wct_plugin.progress import Progress, ProgressCallback
from wct_plugin.types import Metrics

#: The options that only one mesher has; the others are for both.
_OWN = {
    "ftetwild": ("epsilon", "stop_energy", "num_opt_iter"),
    "tetgen": ("radius_edge", "min_dihedral", "keep_boundary", "memory_limit"),
}


class TetrahedralizationOptions(Options):
    """What a mesher is asked for; lengths are fractions of the surface's bounding-box diagonal."""

    mesher: Literal["ftetwild", "tetgen"] = Field(
        "ftetwild", description="fTetWild heals the surface and stays near it; TetGen needs a sound one and keeps it"
    )
    edge_length: Annotated[float, OfDiagonal] = Field(
        0.05, gt=0, le=1, description="Target edge length, as a fraction of the diagonal; TetGen: of the largest tet"
    )
    epsilon: Annotated[float, OfDiagonal] = Field(
        5e-4,
        gt=0,
        le=0.1,
        description="fTetWild: greatest distance of the boundary from the surface, as a fraction of the diagonal",
    )
    stop_energy: float = Field(
        10.0, ge=3, description="fTetWild: stop when the worst AMIPS energy falls below (3 is a regular tet)"
    )
    num_opt_iter: int = Field(80, ge=1, description="fTetWild: greatest number of its optimisation passes")
    radius_edge: float = Field(
        1.4, ge=1, description="TetGen: greatest ratio of circumradius to shortest edge; it may not end below 1.2"
    )
    min_dihedral: float = Field(
        10.0, ge=0, le=60, description="TetGen: smallest dihedral angle in degrees; it may not end above 20"
    )
    keep_boundary: bool = Field(False, description="TetGen: split no triangle of the surface")
    timeout: float | None = Field(None, gt=0, description="Seconds after which the mesher is ended (default: none)")
    memory_limit: float | None = Field(None, gt=0, description="TetGen: memory it may take, in MB")

    @model_validator(mode="after")
    def _refuse_the_other_meshers(self) -> "TetrahedralizationOptions":
        for mesher, names in _OWN.items():
            given = [name for name in names if name in self.model_fields_set]
            if mesher != self.mesher and given:
                raise ValueError(f"option {given[0]!r} is for mesher {mesher!r}, not for {self.mesher!r}")
        return self

    @model_serializer(mode="wrap")
    def _without_the_other_meshers(self, inner: SerializerFunctionWrapHandler) -> dict[str, Any]:
        others = {name for mesher, names in _OWN.items() if mesher != self.mesher for name in names}
        return {name: value for name, value in inner(self).items() if name not in others}


class GenerateTetrahedralization(FilterStage[TetrahedralizationOptions]):
    """Fill a surface with tetrahedra by fTetWild or TetGen; the surface travels on as the mesh's reference.

    fTetWild is not reproducible: two runs give two meshes. It heals gaps and self-intersections within ``epsilon``.
    TetGen keeps the surface exactly, facet tags included, and makes regions of the volumes it divides; it needs a
    closed surface that does not intersect itself. A closed inner surface that faces inward is left hollow by both.
    """

    name = "generate_tetrahedralization"
    takes = SurfaceMesh
    gives = TetMesh
    declaration = TetrahedralizationOptions
    example: ClassVar[dict[str, Any]] = {"edge_length": 0.1}

    def run(self, mesh: SurfaceMesh, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        check_not_planar(mesh)
        options = self.options.model_dump(exclude={"mesher"})
        mesher = "TetGen" if self.options.mesher == "tetgen" else "fTetWild"

        def heard(standing: str) -> None:
            progress(Progress(f"{mesher}: {standing}" if standing else mesher, 0.0))

        heard("")
        adapter = tetgen if self.options.mesher == "tetgen" else ftetwild
        tets = adapter.tetrahedralize(mesh, **options, heard=heard)
        made = {"mesher": f"{mesher} {adapter.version()}", "tets": len(tets.tets), "points": len(tets.points)}
        return tets, made
