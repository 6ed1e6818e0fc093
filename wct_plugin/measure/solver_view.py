"""What finite volume solvers make of a mesh, region by region: their couples, their volumes, their skewed facets.

A **couple** is what a vertex-centered (box, Voronoi) scheme ties two vertices of an edge together with, in one region:
the signed area of the circumcentric dual face that the region has across the edge, over its length. A negative one is
an anti-diffusion; LaGriT reports them as negative coupling coefficients when it writes a mesh for FEHM, TOUGH or
PFLOTRAN. Each region is added up by itself, as it has a coefficient of its own.

**Unsigned over signed volume.** DEVSIM adds up the dual's parts without their signs. Per tet, with the circumcenter's
height h over a facet and the facet's angle gamma opposite an edge of length l, the parts at the edge's two ends have
the volume l^2 cot(gamma) h / 12 (see :mod:`wct_plugin.measure.duals`); with signs all add up to the volume. The ratio
of sum |l^2 cot(gamma) h| / 12 to it is what DEVSIM's ``NodeVolume`` comes to, and by about as much conductances and
capacitances are too large. It is 1 if and only if no part is negative, as in completely well-centered meshes.

**Non-orthogonality.** What cell-centered schemes correct for: the angle between a facet's normal and the line between
the centroids of its two tets. As in OpenFOAM's ``checkMesh`` (``polyMeshTools::faceOrthogonality``) the mean is the
angle whose cosine is the mean of the cosines. Between circumcenters the line is normal to the facet by construction,
so that the angle is 0 where the dual edge is positive.

**Stray circumcenters** are outside their region, see :mod:`wct_plugin.measure.stray_circumcenters`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from wct_plugin.core import _core
from wct_plugin.measure import compiled_quality, duals
from wct_plugin.measure.stray_circumcenters import stray_circumcenters
from wct_plugin.mesh import TetMesh, region_parts, unit_scaling
from wct_plugin.types import Floats, Ints

#: What is said of a region, as :meth:`RegionView.shown` says it.
QUANTITIES = (
    "negative couples",
    "unsigned / signed dual volume",
    "non-orthogonality, mean",
    "non-orthogonality, max",
    "circumcenters outside",
)
#: Column names of :meth:`SolverView.rows`.
HEAD = ("region", *QUANTITIES)


@dataclass(frozen=True)
class RegionView:
    """What a solver sees of one region, or of all of them."""

    couples: int  #: edges, once per region that they are in
    negative_couples: int  #: below zero by more than rounding and ties
    unsigned_over_signed: float  #: volume of the dual's parts without signs over the volume
    max_non_orthogonality: float  #: over the facets inside, in degrees
    mean_non_orthogonality: float  #: likewise; 0 where there is no facet inside
    stray_circumcenters: int  #: tets whose circumcenter is outside the region

    def shown(self) -> tuple[str, ...]:
        """The values of :data:`QUANTITIES`; the ratio is 1.000 only where it is 1 but for rounding."""
        ratio = self.unsigned_over_signed
        return (
            f"{self.negative_couples} of {self.couples}",
            f"{ratio if ratio < 1.0 + 1e-9 else max(ratio, 1.001):.3f}" if math.isfinite(ratio) else "-",
            f"{self.mean_non_orthogonality:.1f}°",
            f"{self.max_non_orthogonality:.1f}°",
            str(self.stray_circumcenters),
        )


@dataclass(frozen=True)
class SolverView:
    """Every region, and all: counts added up, the facets between regions among those that are not orthogonal."""

    regions: Mapping[int, RegionView]  #: by tag
    total: RegionView

    def to_dict(self) -> dict[str, object]:
        """Plain numbers, the regions by their tags."""
        return {"regions": {str(tag): vars(one) for tag, one in self.regions.items()}, "total": vars(self.total)}

    def rows(self, most: int = 20) -> list[tuple[str, ...]]:
        """A row per region, and one of all where there are several.

        Of more than ``most`` regions those with the largest ratio of unsigned to signed dual volume.
        """
        worst = sorted(self.regions, key=lambda tag: -self.regions[tag].unsigned_over_signed)[:most]
        rows = [(str(tag), *self.regions[tag].shown()) for tag in sorted(worst)]
        return [*rows, ("all", *self.total.shown())] if len(self.regions) > 1 else rows


def view(mesh: TetMesh, of: duals.Duals | None = None) -> SolverView:
    """Measure what solvers see of the regions of ``mesh``; pass its duals ``of`` where they are there already."""
    tags, of_tet = np.unique(mesh.regions, return_inverse=True)

    def summed(of: Ints, values: Floats | None = None) -> Floats:
        """(r,) per region and then, last, of all."""
        each = np.bincount(of, values, len(tags)).astype(np.float64)
        return np.append(each, each.sum())

    parts = region_parts.apart(mesh)
    of_point = np.zeros(len(parts.points), dtype=np.int64)
    of_point[parts.tets] = of_tet[:, None]
    of_edge = of_point[parts.topology.edges[:, 0]]
    _, negative = duals.negative(parts, of if of and parts is mesh else duals.compute_duals(parts))
    points = unit_scaling.normalized(mesh.points)
    unsigned, signed = _core.unsigned_volumes(points, mesh.tets), compiled_quality.volumes(points, mesh.tets)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = summed(of_tet, unsigned) / summed(of_tet, signed)
    pairs = mesh.topology.interior_pairs
    cosines = _core.orthogonality(points, mesh.tets, pairs)
    columns = (
        summed(of_edge).astype(np.int64),
        summed(of_edge[negative]).astype(np.int64),
        ratios,
        *_least_and_mean(cosines, of_tet[pairs[:, ::2]], len(tags)),
        summed(of_tet[stray_circumcenters(parts)]).astype(np.int64),
    )
    *regions, total = (RegionView(*row) for row in zip(*(column.tolist() for column in columns), strict=True))
    return SolverView(dict(zip(tags.tolist(), regions, strict=True)), total)


def _least_and_mean(cosines: Floats, sides: Ints, count: int) -> tuple[Floats, Floats]:
    """(r,) the angles of the least and the mean cosine of the facets inside each region, and then, last, of all."""
    inside = sides[:, 0] == sides[:, 1]
    bins = np.append(sides[inside, 0], np.full(len(cosines), count))
    values = np.append(cosines[inside], cosines)
    least = np.ones(count + 1)
    np.minimum.at(least, bins, values)
    number, sums = np.bincount(bins, minlength=count + 1), np.bincount(bins, values, count + 1)
    means = np.divide(sums, number, out=np.ones(count + 1), where=number > 0)
    largest, mean = (np.degrees(np.arccos(np.clip(each, -1.0, 1.0))) for each in (least, means))
    return largest, mean
