"""The boundary in patches: by the names and tags of the tagged facets on it."""

from collections.abc import Mapping

import numpy as np

from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.named_groups import names_of
from wct_plugin.types import Ints

#: What the boundary is called where no facet is tagged, and what is left of it where some are.
WHOLE, REST = "boundary", "defaultFaces"


def find_patches(mesh: TetMesh) -> tuple[dict[str, Ints], list[str]]:
    """Rows of ``topology.boundary`` by the name of the patch, each in one; and what of the groups is lost by this."""
    boundary = mesh.topology.boundary
    row = find_rows(np.sort(boundary, axis=1), np.sort(mesh.facets.vertices, axis=1), len(mesh.points))
    groups = names_of(mesh.facets.tags, mesh.names, 2, mesh.facets.sets)
    free = np.ones(len(boundary), dtype=bool)
    patches: dict[str, Ints] = {}
    lost = []
    for name, members in groups.items():
        rows = np.unique(row[members])
        inside, rows = int((row[members] < 0).sum()), rows[rows >= 0]
        taken = int((~free[rows]).sum())
        if inside:
            lost.append(f"{inside} facets of group {name!r} that are not on the boundary")
        if taken:
            lost.append(f"{taken} facets of group {name!r} that are in another patch")
        if free[rows].any():
            patches[name] = rows[free[rows]]
            free[rows] = False
    if free.any():
        patches[REST if patches else WHOLE] = np.flatnonzero(free)
    return patches, lost


def region_names(mesh: TetMesh) -> Mapping[int, str]:
    """A name for each region tag: its own, or ``region_TAG``."""
    named = {tag: name for name, (tag, dimension) in reversed([*mesh.names.items()]) if dimension == 3}
    return {tag: named.get(tag, f"region_{tag}") for tag in np.unique(mesh.regions).tolist()}
