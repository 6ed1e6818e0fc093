"""Edge lengths given per region or group of facets, as one length per point of the mesh."""

from collections.abc import Mapping

import numpy as np

from wct_plugin.errors import OptionError
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.index_arrays import averaged, masks
from wct_plugin.meshing import per_group
from wct_plugin.types import Bools, Floats, Ints

#: Edge length per cell of a body-centered cubic lattice, and how often lengths are averaged with their neighbours', as
#: the core has it.
_EDGE_PER_CELL = 1.05
AVERAGED = 4


def lengths_of_groups(wanted: Mapping[str, float], mesh: TetMesh) -> Floats:
    """(n,) the length wanted at each point: the smallest of those of the groups that the point belongs to.

    What is said of the rest, or else the mesh's own length there, holds at points of tets that no named region has, but
    for those of named groups of facets. Raises :class:`OptionError` for a name that the mesh has not.
    """
    regions = _groups(mesh, mesh.regions, mesh.tet_sets, 3)
    facets = _groups(mesh, mesh.facets.tags, mesh.facets.sets, 2)
    lengths = np.full(len(mesh.points), np.inf)
    named = np.zeros(len(mesh.tets), dtype=bool)
    on_group = np.zeros(len(mesh.points), dtype=bool)
    for name, length in wanted.items():
        if name == per_group.REST:
            continue
        if name in regions:
            named |= regions[name]
            points = mesh.tets[regions[name]].ravel()
        elif name in facets:
            points = mesh.facets.vertices[facets[name]].ravel()
            on_group[points] = True
        else:
            known = ", ".join(map(repr, dict.fromkeys([*regions, *facets])))
            raise OptionError(
                f"option 'edge_length' names {name!r}, which is no region or group of facets of"
                f" {mesh.source or 'the mesh'} (there: {known})"
            )
        lengths[points] = np.minimum(lengths[points], length)
    rest = np.zeros(len(mesh.points), dtype=bool)
    rest[mesh.tets[~named]] = True
    rest &= ~on_group
    others = wanted[per_group.REST] if per_group.REST in wanted else own_lengths(mesh)
    return np.where(rest, np.minimum(lengths, others), lengths)


def own_lengths(mesh: TetMesh) -> Floats:
    """(n,) edge of the lattice that has as many tets per volume as there are round each point, smoothed."""
    a, b, c, d = np.moveaxis(mesh.points[mesh.tets], 1, 0)
    volume = np.abs(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)) / 6.0
    corners, count = mesh.tets.ravel(), len(mesh.points)
    around = np.bincount(corners, np.repeat(volume, 4), count) / np.bincount(corners, minlength=count)
    lengths = np.log(_EDGE_PER_CELL * np.cbrt(12.0 * around))
    i, k = mesh.topology.edges.T
    found: Floats = np.exp(averaged(lengths, i, k, AVERAGED))
    return found


def _groups(mesh: TetMesh, tags: Ints, sets: Mapping[str, Ints], dimension: int) -> dict[str, Bools]:
    """Members of each group of cells of that dimension, by its name, a set's name or its tag as text."""
    tagged = {str(tag): tags == tag for tag in np.unique(tags).tolist()}
    named = {name: tags == tag for name, (tag, of) in mesh.names.items() if of == dimension}
    return {**tagged, **masks(sets, len(tags)), **named}
