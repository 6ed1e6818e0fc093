"""How well a search kept the volumes of regions: of results that are equal otherwise the best is taken by that."""

import numpy as np

from wct_plugin.core.results import SearchResult
from wct_plugin.measure.conserved import CHANGE
from wct_plugin.meshing.followed_surface import enclosed_volumes
from wct_plugin.meshing.reference import Reference


def volume_missed(found: SearchResult, on: Reference) -> float:
    """By what share of it the volume of the worst region has changed beyond what is allowed; 0 where none has.

    0 too where the surface ``on`` encloses none, as one with holes may.
    """
    wanted = np.array(list(enclosed_volumes(on).values()))
    if not (wanted > 0.0).all():
        return 0.0
    corners = found.mesh.points[found.mesh.tets]
    a, b, c = np.moveaxis(corners[:, 1:] - corners[:, :1], 1, 0)
    volumes = np.einsum("ij,ij->i", np.cross(a, b), c) / 6.0
    has = np.bincount(found.mesh.regions, volumes, minlength=len(wanted))
    return float(np.max(np.abs(has / wanted - 1.0) - CHANGE, initial=0.0))
