"""What :func:`wct_plugin.meshing.well_center.well_center` is asked for."""

from dataclasses import dataclass
from typing import Literal

from wct_plugin.meshing.boundary_choice import Boundary
from wct_plugin.meshing.coincident import Merge
from wct_plugin.meshing.edge_length import EdgeLength

#: The largest tolerance, as a fraction of the diagonal: more would be another body.
LARGEST_TOLERANCE = 0.1


@dataclass(frozen=True, eq=False)
class WellCenterOptions:
    """What may change, how near the surface must stay, and how hard to try."""

    goal: Literal["delaunay", "one-sided", "3wc", "cwc"] = "cwc"
    """delaunay: no vertex inside a tet's sphere; one-sided: all signed duals of every region positive; 3wc: every tet
    contains its circumcenter; cwc: every triangle too"""
    boundary: Boundary = "move"
    """move: resampled; keep: vertices stay, facets may flip or split; fixed: facets stay; or one of them per group of
    facets, set or tag, * for the rest"""
    tolerance: float | None = None
    """Greatest distance from the reference, both ways, as a fraction of the diagonal (None: 1e-3, or the sag of the
    reference's own facets if larger)"""
    local_tolerance: bool = True  #: locally at most a tenth of the wall, gap or radius there, at least a quarter
    edge_length: EdgeLength = None  #: in the mesh's unit; one per point, or per region or group (None: the input's own)
    surface_edges: float = 1.25  #: how long edges of the surface may be on average, in the input's own there
    crease_angle: float = 40.0  #: boundary edges that bend more than this are creases, in degrees
    planes: Literal["exact", "input"] = "exact"  #: whether what is plane but for a file's rounding becomes plane
    merge: Merge = "auto"  #: which points that coincide exactly are joined
    max_tets: int | None = None  #: most tets of the new mesh (None: two million, or 20 times those that came if more)
    margin: float = 0.02  #: clearance aimed at: smallest h/R and smallest cosine
    effort: int = 1  #: multiplies the work after which the search ends
    seed: int = 0  #: of the random choices
    allow_released: bool = False  #: accept that soft creases become ordinary surface
    periodic: bool | None = None  #: sides that are translates match again (None: where the file says so)
    force: bool = False  #: make the mesh anew although it meets the goal
