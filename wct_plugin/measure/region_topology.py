"""What a region is like as a space: pieces, Euler characteristic, and whether its surface is a manifold."""

from typing import TypedDict

import numpy as np

from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import EDGES
from wct_plugin.mesh.triangle_surfaces import pinched, surface_edges
from wct_plugin.types import Ints


class RegionTopology(TypedDict):
    """Of one region, with what its tets have in common with others or itself only at edges and vertices."""

    components: int  #: pieces that hang together over facets
    euler_characteristic: int  #: vertices - edges + facets - tets
    joined_edges: int  #: edges of its surface with other than two of its facets
    pinched_vertices: int  #: vertices where several sheets of its surface touch that share no edge


def measure_region_topology(mesh: TetMesh) -> dict[str, RegionTopology]:
    """Each region's, by its tag."""
    topology, regions = mesh.topology, mesh.regions
    pairs = topology.interface_pairs
    half_facets = np.concatenate([topology.boundary_half_facets, pairs[:, :2], pairs[:, 2:]])
    out: dict[str, RegionTopology] = {}
    for tag in np.unique(regions):
        rows = np.flatnonzero(regions == tag)
        surface = topology.triangles_of(half_facets[regions[half_facets[:, 0]] == tag])
        sizes = surface_edges(surface, len(mesh.points))[3]
        joined, pinches = int((sizes != 2).sum()), int(pinched(surface, len(mesh.points)).sum())
        if joined or pinches:
            inner = topology.interior_pairs
            shared = int(((regions[inner[:, 0]] == tag) & (regions[inner[:, 2]] == tag)).sum())
            characteristic = _euler_characteristic(mesh.tets[rows], shared)
        else:
            # Round a vertex that tets fill in space lies a sphere or, on the surface, a disk. So this is a manifold,
            # and its characteristic half that of its boundary (its double, an odd-dimensional closed manifold, has 0).
            characteristic = (len(np.unique(surface)) - len(sizes) + len(surface)) // 2
        out[str(tag)] = {
            "components": len(np.unique(topology.pieces[rows])),
            "euler_characteristic": characteristic,
            "joined_edges": joined,
            "pinched_vertices": pinches,
        }
    return out


def changes(old: dict[str, RegionTopology], new: dict[str, RegionTopology]) -> list[tuple[str, str, int, int]]:
    """Region, measure, before and after, where a region has become another space.

    Edges and vertices that join more than two sheets may be more or fewer where there were some: a joint made of other
    edges is the same joint.
    """
    out: list[tuple[str, str, int, int]] = []
    for tag, before in old.items():
        after = new.get(tag)
        if after is None:
            out.append((tag, "components", before["components"], 0))
            continue
        measures = (
            ("components", before["components"], after["components"]),
            ("euler_characteristic", before["euler_characteristic"], after["euler_characteristic"]),
        )
        joints = (
            ("joined_edges", before["joined_edges"], after["joined_edges"]),
            ("pinched_vertices", before["pinched_vertices"], after["pinched_vertices"]),
        )
        out += [(tag, name, was, now) for name, was, now in measures if was != now]
        out += [(tag, name, was, now) for name, was, now in joints if bool(was) != bool(now)]
    return out


def _euler_characteristic(tets: Ints, shared: int) -> int:
    """Of tets (m, 4), ``shared`` facets of which belong to two of them."""
    count = int(tets.max()) + 1
    used = np.zeros(count, dtype=bool)
    used[tets] = True
    ends = tets[:, EDGES].reshape(-1, 2)
    keys = ends.min(axis=1) * count + ends.max(axis=1)
    keys.sort()  # a table of hashes, as np.unique makes it, takes far longer
    edges = 1 + int((keys[1:] != keys[:-1]).sum())
    return int(used.sum()) - edges + (4 * len(tets) - shared) - len(tets)
