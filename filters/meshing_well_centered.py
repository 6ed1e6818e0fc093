"""``filters.meshing_well_centered``: resample, reconnect and move until every tet is well-centered."""

from dataclasses import fields
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import ConfigDict, Field, field_validator, model_validator
from pydantic.json_schema import SkipJsonSchema

from wct_plugin.errors import OptionError
from wct_plugin.io import read
from wct_plugin.measure.goals import DUAL
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.meshing import boundary_choice, coincident, edge_length
from wct_plugin.meshing.boundary_choice import Boundary
from wct_plugin.meshing.edge_length import EdgeLength
from wct_plugin.meshing.well_center import well_center
from wct_plugin.meshing.well_center_options import LARGEST_TOLERANCE, WellCenterOptions
from wct_plugin.objects.conversions import as_mesh
from wct_plugin.pipeline.stage import FilterStage, OfDiagonal, Options
from wct_plugin.progress import ProgressCallback
from wct_plugin.types import Metrics


class MeshingOptions(Options):
    """What may change, how near the surface must stay, and how hard to try."""

    model_config = ConfigDict(arbitrary_types_allowed=True)

    goal: Literal["delaunay", "one-sided", "3wc", "cwc"] = Field(
        "cwc",
        description="delaunay: no vertex inside a tet's sphere, and of several regions none with a negative couple;"
        " one-sided: all signed duals of every region positive;"
        " 3wc: every tet contains its circumcenter; cwc: every triangle too",
    )
    boundary: Boundary = Field(
        "move",
        description="move: resampled; keep: vertices stay, facets may flip or split; fixed: facets stay; or one of them"
        " per group of facets, set or tag, * for the rest: contact=fixed,*=move",
    )
    tolerance: Annotated[float | None, OfDiagonal] = Field(
        None,
        gt=0,
        le=LARGEST_TOLERANCE,
        description="Greatest distance from the reference, both ways, as a fraction of the diagonal"
        " (none: 1e-3, or the sag of the reference's own facets if larger)",
    )
    local_tolerance: bool = Field(
        True, description="Locally never more than a tenth of the wall, gap or radius there, nor less than a quarter"
    )
    reference: SkipJsonSchema[SurfaceMesh] | str | None = Field(
        None, description="Surface to stay near, or its file (none: the surface read at the start, or the own boundary)"
    )
    edge_length: float | str | dict[str, float] | SkipJsonSchema[np.ndarray] | None = Field(
        None,
        description="Edge length in the mesh's unit: a number > 0, one per point, the name of point data, or one per"
        " region or group of facets, * for the rest: oxide=0.01,*=0.1 (none, or no *: the input's own); shorter where"
        " the tolerance needs it",
    )
    surface_edges: float = Field(
        1.25,
        gt=0,
        description="How long edges of the surface may be on average, in the input's own there; on groups and"
        " interfaces 0.82 of that; of no effect with edge_length",
    )
    crease_angle: float = Field(
        40.0, gt=0, lt=180, description="Boundary edges that bend more than this are creases, in degrees"
    )
    planes: Literal["exact", "input"] = Field(
        "exact",
        description="exact: what is plane but for the rounding of a file becomes plane; input: all stays as it came",
    )
    merge: coincident.Merge = Field(
        "auto",
        description="Points that coincide exactly: auto: facets that do match again, other points stay apart; none: all"
        " stay apart; all: all are joined",
    )
    max_tets: int | None = Field(
        None,
        ge=1,
        description="Most tets that the new mesh may have (none: two million, or 20 times those that came if more)",
    )
    margin: float = Field(0.02, ge=0, le=0.1, description="Clearance aimed at: smallest h/R and smallest cosine")
    effort: int = Field(1, ge=1, le=100, description="Multiplies the work after which the search ends")
    seed: int = Field(0, ge=0, description="Of the random choices")
    allow_released: bool = Field(
        False,
        description="Accept, as on scans, that creases which leave well-centered tets no place become ordinary surface,"
        " and that more of its edges bend",
    )
    periodic: bool | None = Field(
        None,
        description="Sides that are translates of each other, as a periodic cell's are, match again (none: where the"
        " file says that they are periodic)",
    )
    force: bool = Field(False, description="Make the mesh anew although it meets the goal")

    @field_validator("boundary", mode="before")
    @classmethod
    def _per_group(cls, value: Any) -> Any:
        return boundary_choice.parse(value)

    @field_validator("edge_length", mode="before")
    @classmethod
    def _lengths(cls, value: Any) -> EdgeLength:
        return edge_length.parse(value)

    @field_validator("reference", mode="before")
    @classmethod
    def _surface_or_name(cls, value: Any) -> Any:
        if value is None or isinstance(value, str | SurfaceMesh):
            return value
        surface = None if isinstance(value, bool | int | float | dict) else as_mesh(value)
        if isinstance(surface, SurfaceMesh):
            return surface
        raise ValueError("must be a surface or the name of a surface file")

    @model_validator(mode="after")
    def _cheapest(self) -> Self:
        if self.goal in DUAL and self.edge_length is not None:
            raise ValueError(f"edge_length asks for other edges, goal {self.goal} for the cheapest change: drop one")
        if self.goal in DUAL and self.force:
            raise ValueError(f"force asks for a new mesh, goal {self.goal} for the cheapest change: drop one")
        return self


class MeshingWellCentered(FilterStage[MeshingOptions]):
    """Resample, reconnect and move until every tet contains its circumcenter; the surface stays within a tolerance.

    A lattice-like start (graded body-centered cubic inside, evenly spaced on patches and creases, relaxed) is repaired
    by local search: flips, edge removal, collapse, split, insertion and relocation round every tet that falls short.
    Where that is stuck, it goes on for longer, then starts again with shorter edges there, five times at most; if few
    tets are, the rest stays. All that ends after so much work, counted, as takes about 5 s and 5 ms per tet of CPU
    time; ``effort`` multiplies it.
    Regions and their interfaces, creases, corners and tagged facets and edges are kept, point data interpolated.
    Facets of a set RequiredTriangles and edges of a set RequiredEdges, as Medit's files have them, stay to the bit;
    other words of ``boundary`` for RequiredTriangles free its facets.
    Planes, straight creases and corners at them are kept exactly, and those that a file rounded are put right first;
    but for those smaller than 28 tolerances and 3 % of the diagonal: these move within the tolerance, as all that is
    curved does. Of the other creases, those that their angle alone makes and that hold tets back for long become
    ordinary surface within the tolerance, as on scans.
    With ``boundary`` keep or fixed the inside is filled anew between the surface facets, with up to twice the tets;
    where only some groups of facets stay, all else is resampled round them. With ``periodic``, and where the file
    says so, sides that are translates of each other match again, vertex for vertex.
    Where those or facets and edges tagged inside a region rule a new start out, the search starts from the mesh itself.
    Holes of the reference are closed and what of it runs on inside the body is cut off, by MeshLab, and followed where
    that bounds the mesh. Meshes of several regions, with tagged edges or vertices, or with tags that change where the
    reference has no edges follow their own facets instead of it, as do those that it does not bound.
    The goals delaunay and one-sided take the cheapest change instead: vertices of the surface stay with ``boundary``
    move too, but for some in thin layers, which delaunay moves a little within their plane where tets would be flat;
    those inside go where they crowd it, new ones come on it where its own are too far apart.
    A mesh that meets the goal, with its boundary within the tolerance, stays as it is, to the bit, also where it falls
    short of the margin; ``force`` or an edge length makes it anew.
    The metrics say which tets miss the goal, which option would free each, and how well the domain is kept.
    Hexahedra, wedges and pyramids stay as they are, and so do the facets that tets share with them. Tets with mid nodes
    are worked on by their corners; where they are curved the boundary stays near the curved surface.
    The unit of length is no matter: bounding boxes of 1e-90 to 1e90 across are taken, others are refused.
    """

    name = "meshing_well_centered"
    takes = TetMesh
    gives = TetMesh
    measures = True
    declaration = MeshingOptions
    example: ClassVar[dict[str, Any]] = {"tolerance": 2e-3, "goal": "3wc"}

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._surface = _load(self.options.reference)  # now, so that a file of no use is refused before any work

    def run(self, mesh: TetMesh, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        asked = {one.name: getattr(self.options, one.name) for one in fields(WellCenterOptions)}
        return well_center(mesh, WellCenterOptions(**asked), reference=self._surface, progress=progress)


def _load(reference: SurfaceMesh | str | None) -> SurfaceMesh | None:
    if not isinstance(reference, str):
        return reference
    surface = read(reference)
    if isinstance(surface, TetMesh):
        raise OptionError(f"{reference}: the reference must be a surface, here is a tet mesh")
    return surface
