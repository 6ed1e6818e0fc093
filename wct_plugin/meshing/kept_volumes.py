"""How well a search kept the volumes of regions: of results that are equal otherwise the best is taken by that."""

import numpy as np

from wct_plugin.core.results import SearchResult
from wct_plugin.measure import compiled_quality
from wct_plugin.measure.conserved import CHANGE
from wct_plugin.meshing.followed_surface import region_volumes
from wct_plugin.meshing.reference import Reference


def volume_missed(found: SearchResult, on: Reference) -> float:
    """By what share of it the volume of the worst region has changed beyond what is allowed; 0 where none has.

    0 too where the surface ``on`` encloses none, as one with holes may.
    """
    wanted = region_volumes(on)
    if wanted is None:
        return 0.0
    volumes = compiled_quality.volumes(found.mesh.points, found.mesh.tets)
    has = np.bincount(found.mesh.regions, volumes, minlength=len(wanted))
    return float(np.max(np.abs(has / wanted - 1.0) - CHANGE, initial=0.0))
