"""Why a goal is out of reach under given options: which vertices, edges, facets and tets rule it out, and how.

Every reason is a theorem with its proof in the module that looks for it, and every hypothesis is checked exactly on the
coordinates as they are stored:

- :mod:`.fixed_facets`: surface facets that stay, however the inside is meshed;
- :mod:`.fixed_vertices`: vertices, or directions along straight creases, that stay, in a fixed connectivity;
- :mod:`.interior_links`: too few edges at an inner vertex, in a fixed connectivity;
- :mod:`.surface_links`: facets round a vertex of a flat patch or a straight crease, in a fixed connectivity.

They assume a valid mesh. What they do not name may be out of reach all the same.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import Strata
from wct_plugin.obstructions import fixed_facets, fixed_vertices, interior_links, surface_links
from wct_plugin.obstructions.reason import Reason
from wct_plugin.obstructions.stars import Stars
from wct_plugin.types import Bools

Goal = Literal["3wc", "2wc", "cwc"]
Boundary = Literal["fixed", "keep", "move", "slide"]
Connectivity = Literal["fixed", "free"]

__all__ = ["RECONNECT", "Boundary", "Connectivity", "Goal", "Reason", "find_reasons"]

RECONNECT = "filters.meshing_well_centered"


def find_reasons(
    mesh: TetMesh,
    of: Strata,
    bad: NDArray[np.int64],
    *,
    goal: Goal,
    boundary: Boundary,
    connectivity: Connectivity,
    fixed: Bools | None = None,
) -> list[Reason]:
    """All reasons found why tets cannot meet ``goal``, each with tets of which at least one never does.

    ``bad`` (k,) are the tets that miss it now. ``boundary`` as in the filters: facets stay (fixed), vertices stay
    (keep), they slide on their own patch or crease (slide) or are replaced (move). ``fixed`` (t,): which triangles of
    the surface stay whatever the others may do.
    """
    if connectivity == "free":
        acute, frees = goal != "3wc", "boundary=keep or move"
        if boundary == "fixed":
            return fixed_facets.reasons(mesh, of, acute=acute, frees=frees)
        return [] if fixed is None else fixed_facets.reasons(mesh, of, fixed, acute=acute, frees=f"{frees} there")
    if boundary == "slide":
        stay, frees = of.stratum == 3, RECONNECT
    else:
        stay, frees = of.stratum > 0, f"boundary=slide, or {RECONNECT}"
    stars = Stars(mesh.tets, len(mesh.points))
    near = np.zeros(len(mesh.points), dtype=bool)
    near[mesh.tets[bad]] = True
    found = fixed_vertices.reasons(mesh, of, stay, bad, goal=goal, frees=frees)
    if boundary != "slide" and goal == "3wc":
        found += fixed_facets.reasons(mesh, of, acute=False, frees=frees)
    found += interior_links.reasons(mesh, stars, near, goal=goal, frees=RECONNECT)
    if goal != "3wc":
        found += surface_links.reasons(mesh, of, stars, stay, near, frees=RECONNECT)
    return found
