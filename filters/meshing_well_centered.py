"""``filters.meshing_well_centered``: resample, reconnect and move until every tet is well-centered."""

import warnings
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, field_validator

from wct_plugin import _core
from wct_plugin.adapters import meshio
from wct_plugin.deviation import deviation
from wct_plugin.errors import WctWarning
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.reference import Reference, bounds, gap, given_surface, own_boundary
from wct_plugin.stage import Filter, Metrics, Options, Progress, ProgressCallback
from wct_plugin.transfer import Resampled, carry

Ints = NDArray[np.int64]

#: Facets are held to this share of the tolerance at sample points, so that they keep it between them; vertices may sit
#: farther out, or the chords between them would take volume away.
_HELD = 0.86
_SHELL = 0.97
#: Sweeps and tries at effort 1.
_PASSES = 12
_KICKS = 4000


class MeshingOptions(Options):
    """What may change, how near the surface must stay, and how hard to try."""

    model_config = ConfigDict(arbitrary_types_allowed=True)

    goal: Literal["3wc", "cwc"] = Field(
        "cwc", description="3wc: every tet contains its circumcenter; cwc: every triangle too"
    )
    boundary: Literal["move", "keep", "fixed"] = Field(
        "move", description="move: resampled; keep: vertices stay, facets may flip or split; fixed: facets stay"
    )
    tolerance: float | None = Field(
        None,
        gt=0,
        le=0.1,
        description="Greatest distance from the reference, both ways, as a fraction of the diagonal"
        " (none: 1e-3, or the sag of the reference's own facets if larger)",
    )
    reference: SurfaceMesh | str | None = Field(
        None, description="Surface to stay near, or its file (none: the surface read at the start, or the own boundary)"
    )
    edge_length: float | None = Field(None, gt=0, description="Edge length in the mesh's unit (none: the input's own)")
    crease_angle: float = Field(
        40.0, gt=0, lt=180, description="Boundary edges that bend more than this are creases, in degrees"
    )
    margin: float = Field(0.02, ge=0, le=0.1, description="Clearance aimed at: smallest h/R and smallest cosine")
    effort: int = Field(1, ge=1, le=100, description="Multiplies the greatest number of tries")
    seed: int = Field(0, ge=0, description="Of the random choices")

    @field_validator("reference", mode="before")
    @classmethod
    def _surface_or_name(cls, value: Any) -> Any:
        if value is None or isinstance(value, str | SurfaceMesh):
            return value
        raise ValueError("must be a SurfaceMesh or the name of a surface file")


class MeshingWellCentered(Filter[MeshingOptions]):
    """Resample, reconnect and move until every tet contains its circumcenter; the surface stays within a tolerance.

    A lattice-like start (graded body-centered cubic inside, evenly spaced on patches and creases, relaxed) is repaired
    by local search: flips, edge removal, collapse, split, insertion and relocation round every tet that falls short.
    Regions and their interfaces, creases, corners and tagged facets and edges are kept, point data interpolated.
    With ``boundary`` keep or fixed, or where tagged facets lie inside a region, the search starts from the mesh itself.
    """

    name = "meshing_well_centered"
    takes = TetMesh
    gives = TetMesh
    declaration = MeshingOptions

    def run(self, mesh: TetMesh, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        options = self.options
        surface = meshio.read(options.reference) if isinstance(options.reference, str) else options.reference
        surface = surface or mesh.reference
        own = own_boundary(mesh, options.crease_angle)
        plain = len(own.regions) == 1 and not (len(mesh.facets) or len(mesh.edges) or len(mesh.nodes))
        moves = options.boundary == "move"
        reference = (
            given_surface(surface, mesh, options.crease_angle)
            if isinstance(surface, SurfaceMesh) and plain and moves
            else own
        )
        tolerance = (options.tolerance or reference.auto_tolerance()) * reference.diagonal
        held = tolerance
        if reference is not own and not bounds(reference, own):
            # The mesh's own boundary stands in for it, and what lies between the two comes off the tolerance.
            held -= gap(own, reference, tolerance)
            reference = own
        sheets = len(own.strata.triangles) > len(mesh.topology.boundary) + len(mesh.topology.interfaces)
        listen = _Listener(progress)
        start = None
        if moves and not sheets:
            start = self._resample(mesh, reference, held, listen)
        if start is None:
            reference = own
            start = _from_mesh(mesh, own, options.boundary)
        found = _core.search_well_centered(
            **start,
            surface_points=reference.points,
            surface_triangles=reference.strata.triangles,
            surface_patch=reference.strata.patch,
            surface_segments=reference.strata.segments,
            surface_curve=reference.strata.curve,
            tolerance=_HELD * held,
            shell=_SHELL * held,
            acute=options.goal == "cwc",
            margin=options.margin,
            flip_surface=options.boundary != "fixed",
            split_surface=options.boundary != "fixed",
            passes=_PASSES,
            kicks=_KICKS * options.effort,
            seed=options.seed,
            progress=listen.search,
        )
        resampled = Resampled(
            found["points"],
            found["tets"],
            reference.regions[found["regions"]],
            found["facets"],
            found["facet_patch"],
            found["creases"],
            found["crease_curve"],
        )
        better = carry(mesh, own.strata, resampled)
        if isinstance(surface, SurfaceMesh):
            better = replace(better, reference=surface)
        target = surface if isinstance(surface, SurfaceMesh) else mesh.boundary_surface()
        apart = deviation(better.boundary_surface(), target).max
        if apart > tolerance:
            warnings.warn(
                f"the boundary is {apart / reference.diagonal:.2e} of the diagonal from the reference; "
                f"the tolerance is {tolerance / reference.diagonal:.2e}",
                WctWarning,
                stacklevel=2,
            )
        metrics = {
            "bad": found["bad"],
            "deviation": apart / reference.diagonal,
            "tets": len(better.tets),
            "passes": found["passes"],
            "kicks": found["kicks"],
            "evaluations": found["evaluations"],
            "tolerance": tolerance / reference.diagonal,
            "stopped": found["stopped"],
        }
        return better, metrics

    def _resample(
        self, mesh: TetMesh, reference: Reference, tolerance: float, listen: "_Listener"
    ) -> dict[str, Any] | None:
        """The relaxed lattice start, or None where it does not represent the domain."""
        options = self.options
        size = None if options.edge_length is None else np.full(len(mesh.points), options.edge_length)
        found = _core.resample(
            reference.points,
            reference.strata.triangles,
            reference.strata.patch,
            reference.strata.segments,
            reference.strata.curve,
            reference.corners,
            reference.sides,
            mesh.points,
            mesh.tets,
            np.searchsorted(reference.regions, mesh.regions),
            tolerance,
            size=size,
            cosines=options.goal == "cwc",
            seed=options.seed + 1,
            progress=listen.resample,
        )
        stratum = found["stratum"]
        # At corners sheets of the input itself may touch.
        if len(found["exposed"]) or (stratum[found["pinched"]] < 3).any():
            return None
        return {
            "points": found["points"],
            "tets": found["tets"],
            "regions": found["region"],
            "stratum": stratum,
            "label": np.where(stratum == 3, -1, found["label"]),
            "size": found["size"],
            "facets": found["facets"],
            "facet_patch": found["facet_patch"],
            "creases": found["creases"],
            "crease_curve": found["crease_curve"],
        }


def _from_mesh(mesh: TetMesh, own: Reference, boundary: str) -> dict[str, Any]:
    """The mesh itself as the search's start; its surface vertices stay unless the boundary moves."""
    edges = mesh.topology.edges
    length = np.linalg.norm(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]], axis=1)
    ends = edges.ravel()
    size = np.bincount(ends, np.repeat(length, 2)) / np.bincount(ends)
    stratum = own.strata.stratum
    return {
        "points": mesh.points,
        "tets": mesh.tets,
        "regions": np.searchsorted(own.regions, mesh.regions),
        "stratum": stratum if boundary == "move" else np.where(stratum > 0, 3, 0).astype(np.int8),
        "label": own.strata.label,
        "size": size,
        "facets": own.strata.triangles,
        "facet_patch": own.strata.patch,
        "creases": own.strata.segments,
        "crease_curve": own.strata.curve,
    }


class _Listener:
    """Passes the core's progress on under one name per phase."""

    def __init__(self, progress: ProgressCallback) -> None:
        self._progress = progress

    def resample(self, done: float, bad: int) -> bool:
        return self._progress(Progress("resampling", done)) is not False

    def search(self, phase: str, done: float, bad: int) -> bool:
        return self._progress(Progress(f"local search: {phase}", done, bad)) is not False
