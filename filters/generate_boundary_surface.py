"""``filters.generate_boundary_surface``: the boundary of a tet mesh, with the quality of the tets behind it."""

import warnings
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wct_plugin.errors import WctWarning
from wct_plugin.measure import compiled_quality
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.topology import FACETS
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import ProgressCallback
from wct_plugin.types import Floats, Ints, Metrics


class BoundarySurfaceOptions(Options):
    """What is taken and what is measured."""

    interfaces: bool = Field(False, description="Take the facets between regions, too, each once")
    quality: Literal["min_h_over_R", "max_face_angle", "max_dihedral_angle"] = Field(
        "min_h_over_R", description="Which measure of the tet behind a facet becomes its quality; angles in degrees"
    )


class GenerateBoundarySurface(FilterStage[BoundarySurfaceOptions]):
    """Give the boundary of a tet mesh, each triangle with the quality of the tet behind it, for MeshLab to colour.

    In a PLY file the array ``quality`` is what MeshLab calls quality per face. An interface's tet is the worse of its
    two, and the triangle faces out of it. Tags and data of facets, data of points and of the tet behind are carried;
    where a facet's array and a tet's share a name, the facet's counts.
    """

    name = "generate_boundary_surface"
    takes = TetMesh
    gives = SurfaceMesh
    declaration = BoundarySurfaceOptions

    def run(self, mesh: TetMesh, progress: ProgressCallback) -> tuple[SurfaceMesh, Metrics]:  # noqa: D102
        values, badness = _measured(mesh, self.options.quality)
        sides = mesh.topology.boundary_half_facets
        if self.options.interfaces:
            first, second = np.split(mesh.topology.interface_pairs, 2, axis=1)
            second_worse = badness[second[:, :1]] > badness[first[:, :1]]
            sides = np.concatenate([sides, np.where(second_worse, second, first)])
        tet = sides[:, 0]
        triangles = mesh.tets[sides[:, :1], FACETS[sides[:, 1]]]
        used, corners = np.unique(triangles, return_inverse=True)
        tagged = np.sort(mesh.facets.vertices, axis=1)
        facet = find_rows(tagged, np.sort(triangles, axis=1), len(mesh.points))
        facet_data, lost = _facet_data(mesh.facets, facet)
        lost += _lost(mesh, facet)
        if lost:
            warnings.warn(f"the boundary's surface cannot carry {', '.join(lost)}", WctWarning, stacklevel=3)
        surface = SurfaceMesh(
            mesh.points[used],
            corners.reshape(-1, 3),
            np.append(mesh.facets.tags, 0)[facet],
            {name: array[used] for name, array in mesh.point_data.items()},
            {name: array[tet] for name, array in mesh.cell_data.items()} | facet_data | {"quality": values[tet]},
            mesh.source,
        )
        worst = float(values[tet[badness[tet].argmax()]])
        return surface, {"points": len(used), "triangles": len(triangles), "worst_quality": worst}


def _measured(mesh: TetMesh, name: str) -> tuple[Floats, Floats]:
    """(m,) the measure of each tet, and how bad that is."""
    measured = compiled_quality.measure(mesh)
    if name == "min_h_over_R":
        return measured.min_height, -measured.min_height
    angle: Floats = getattr(measured, name)
    return angle, angle


def _facet_data(facets: Cells, facet: Ints) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Arrays per triangle, NaN where it is not tagged, and those that have no such value."""
    bare = facet < 0
    data, lost = {}, []
    for name, values in facets.data.items():
        if values.dtype.kind == "f":
            data[name] = np.concatenate([values, np.full_like(values, np.nan, shape=(1, *values.shape[1:]))])[facet]
        elif bare.any():
            lost.append(f"triangle data {name!r}")
        else:
            data[name] = values[facet]
    return {} if bare.all() else data, lost


def _lost(mesh: TetMesh, facet: Ints) -> list[str]:
    inside = len(mesh.facets) - len(np.unique(facet[facet >= 0]))
    counts = {"tagged facets inside": inside, "tagged edges": len(mesh.edges), "tagged vertices": len(mesh.nodes)}
    sets = {"triangle set": mesh.facets.sets, "point set": mesh.point_sets}
    return [f"{count} {what}" for what, count in counts.items() if count] + [
        f"{what} {name!r}" for what, named in sets.items() for name in named
    ]
