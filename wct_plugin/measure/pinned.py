"""What of a mesh its own tagged cells hold: vertices in their place, edges on their curve, facets inside a region."""

from collections.abc import Mapping
from typing import TypedDict

import numpy as np

from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import tagged_inside


class Pinned(TypedDict):
    """How many there are of each."""

    vertices: int
    edges: int
    facets: int


def measure_pinned(mesh: TetMesh) -> Pinned:
    """Tagged vertices, tagged edges, and tagged facets with the same region on both sides."""
    return {
        "vertices": len(np.unique(mesh.nodes.vertices)),
        "edges": len(np.unique(np.sort(mesh.edges.vertices, axis=1), axis=0)),
        "facets": len(tagged_inside(mesh)[0]) if len(mesh.facets) else 0,
    }


def describe(found: Mapping[str, int]) -> str:
    """One line, or none where nothing is held."""
    said = {
        "vertices": ("vertex cell stays in its place", "vertex cells stay in their place"),
        "edges": ("line cell stays an edge", "line cells stay edges"),
        "facets": ("triangle inside a region stays a sheet", "triangles inside a region stay sheets"),
    }
    parts = [f"{found[what]} {words[found[what] > 1]}" for what, words in said.items() if found[what]]
    return f"held as the input lists them: {', '.join(parts)}" if parts else ""
