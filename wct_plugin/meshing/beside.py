"""Tets beside other cells are worked on alone; where they touch these their facets stay, and both are rejoined."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.other_cells import OtherCells, find_contact
from wct_plugin.meshing import per_group
from wct_plugin.meshing.boundary_choice import Boundary
from wct_plugin.types import Ints, Metrics

#: The set of facets that stay, while the tets are alone.
HELD = "beside other cells"


@dataclass(frozen=True, eq=False)
class Alone:
    """The tets of a mesh without the other cells; the facets that stay for these in a set."""

    mesh: TetMesh
    tag: int  #: of the facets that were added for the set; 0 where none were
    whole: TetMesh

    def boundary(self, wanted: Boundary) -> Boundary:
        """What is wanted of the boundary, but for facets beside other cells, which stay."""
        if not self.tag or wanted == "fixed":
            return wanted
        return (dict(wanted) if isinstance(wanted, Mapping) else {per_group.REST: wanted}) | {HELD: "fixed"}

    def metrics(self, found: Metrics) -> Metrics:
        """What was found out, without the tag that facets beside other cells had for themselves."""
        groups = {name: size for name, size in found["groups"].items() if name != str(self.tag) or not self.tag}
        return {**found, "groups": groups}

    def together(self, made: TetMesh) -> TetMesh:
        """The whole mesh with the tets made anew; it itself where they stayed."""
        if made is self.mesh:
            return self.whole
        others = self.whole.others
        if others is None:
            return made
        if not self.tag:  # they touch nowhere
            return replace(made, others=others)
        held = made.facets.vertices[made.facets.sets[HELD]]
        facets = made.facets.select(made.facets.tags != self.tag)
        sets = {name: members for name, members in facets.sets.items() if name != HELD}
        return replace(made, facets=replace(facets, sets=sets), others=_rejoined(others, made, np.unique(held)))


def alone(mesh: TetMesh) -> Alone:
    """The tets of a mesh, to be worked on; with the set :data:`HELD` of facets where they touch other cells."""
    if mesh.others is None:
        return Alone(mesh, 0, mesh)
    bare = replace(mesh, others=None)
    boundary = mesh.topology.boundary
    contact = find_contact(boundary, mesh.others, len(mesh.points)).all
    if not contact.any():
        return Alone(bare, 0, mesh)
    _, first, count = np.unique(
        mesh.points[np.unique(boundary[contact])], axis=0, return_index=True, return_counts=True
    )
    if (count > 1).any():
        at = ", ".join(f"{x:g}" for x in mesh.points[np.unique(boundary[contact])][first[count > 1][0]])
        raise InputError(
            f"{mesh.source or 'the mesh'}: two points of tets beside other cells are both at ({at}); allowed is one:"
            " merge them"
        )
    taken = [tag for tag, dimension in mesh.names.values() if dimension == 2]
    tag = max([0, *taken, int(mesh.facets.tags.max(initial=0))]) + 1
    return Alone(replace(bare, facets=_with_held(mesh.facets, boundary[contact], tag)), tag, mesh)


def _with_held(facets: Cells, held: Ints, tag: int) -> Cells:
    count = len(facets)
    return Cells(
        np.concatenate([facets.vertices, held]),
        np.concatenate([facets.tags, np.full(len(held), tag, dtype=np.int64)]),
        {
            name: np.concatenate([values, np.zeros((len(held), *values.shape[1:]), values.dtype)])
            for name, values in facets.data.items()
        },
        {**facets.sets, HELD: count + np.arange(len(held))},
    )


def _rejoined(others: OtherCells, made: TetMesh, held: Ints) -> OtherCells:
    """The other cells on the points of the new tets; they are where they were, to the bit.

    Arrays and sets of points that the new tets have not are gone from the others' points too, unless they are on the
    points of the others alone.
    """
    ours = np.flatnonzero(others.shared >= 0)
    both = np.concatenate([made.points[held], others.points[ours]])
    place = np.unique(both, axis=0, return_inverse=True)[1].reshape(-1)
    at = np.full(len(both), -1, dtype=np.int64)
    at[place[: len(held)]] = held
    shared = np.full(len(others.points), -1, dtype=np.int64)
    shared[ours] = at[place[len(held) :]]
    return replace(
        others,
        shared=shared,
        point_data={name: values for name, values in others.point_data.items() if name in made.point_data},
        point_sets={
            name: ids
            for name, ids in others.point_sets.items()
            if name in made.point_sets or (others.shared[ids] < 0).all()
        },
    )
