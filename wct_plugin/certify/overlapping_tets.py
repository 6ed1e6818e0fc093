"""Whether tets of a mesh overlap, decided exactly: the least that a mesh must not do to be called valid.

:mod:`wct_plugin.certify.overlaps` proves more, that tets meet face to face as well; where it does, they do not overlap,
and that is all there is to do for nearly every mesh. The two sides of a crack, or bodies in contact, do not meet face
to face and yet need not overlap. There, points in the same place are merged first, which closes all that matches. What
is left is decided tet by tet: two tets do not overlap where a plane keeps them apart, and if any does, then one along a
face of either, or one along an edge of each.

It is enough to try the tets at the boundary. Let N(x) be the number of tets around a point x on no facet. Where N grows
from one to two, it does so across the facet of a tet that lies on the side of the two. If that facet is a boundary one,
a tet at the boundary overlaps another one. If not, both its tets lie on that side, and overlap each other.
"""

from collections.abc import Callable, Iterator
from functools import partial
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from wct_plugin.certify.box_pairs import overlapping
from wct_plugin.certify.overlaps import Overlaps, overlaps
from wct_plugin.errors import InputError
from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import Polynomial, exact_signs
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import EDGES, FACETS
from wct_plugin.types import Bools, Floats, Ints

#: Pairs of tets that are looked at together: one that overlaps ends the search.
_BLOCK = 4096
#: What was found in meshes that are still in use; a mesh never changes.
_known: "WeakKeyDictionary[TetMesh, tuple[int, int] | None]" = WeakKeyDictionary()


def overlap(mesh: TetMesh) -> tuple[int, int] | None:
    """Two tets of ``mesh`` whose insides have a point in common; None where there are no such tets.

    Raises :class:`wct_plugin.errors.InputError` where three or more tets share a facet.
    """
    if mesh not in _known:
        _known[mesh] = _search(mesh)
    return _known[mesh]


def _search(mesh: TetMesh) -> tuple[int, int] | None:
    found = overlaps(mesh)
    if _sound(found):
        return None
    if len(found.one_sided):
        return _pair(found.one_sided[0])
    if not len(found.crossing):
        return _pair(found.covered[0])
    if _sound_when_merged(mesh):
        return None
    return _first(mesh, found.crossing) or _first(mesh, _near_the_boundary(mesh))


def _sound(found: Overlaps) -> bool:
    return not (len(found.one_sided) or len(found.crossing) or len(found.covered))


def _sound_when_merged(mesh: TetMesh) -> bool:
    """Whether tets meet face to face once points in the same place are one."""
    points, place = np.unique(mesh.points, axis=0, return_inverse=True)
    try:
        return _sound(overlaps(TetMesh(points, place.reshape(-1)[mesh.tets])))
    except InputError:  # three tets at a facet, or two on the same four points
        return False


def _near_the_boundary(mesh: TetMesh) -> Ints:
    """(k, 2) tets at the boundary and those whose boxes overlap theirs, but for neighbours across a facet."""
    corners = mesh.points[mesh.tets]
    low, high = corners.min(axis=1), corners.max(axis=1)
    border = np.unique(mesh.topology.boundary_half_facets[:, 0])
    pairs = overlapping(low[border], high[border], low, high)
    pairs[:, 0] = border[pairs[:, 0]]
    one, other = pairs.T
    apart = ((high[one] <= low[other]) | (high[other] <= low[one])).any(axis=1)
    common = (mesh.tets[one][:, :, None] == mesh.tets[other][:, None, :]).sum(axis=(1, 2))
    near: Ints = pairs[~apart & (common < 3)]
    return near


def _first(mesh: TetMesh, pairs: Ints) -> tuple[int, int] | None:
    """The first of these pairs that overlap."""
    for start in range(0, len(pairs), _BLOCK):
        part = pairs[start : start + _BLOCK]
        one, other = mesh.tets[part[:, 0]], mesh.tets[part[:, 1]]
        left = np.arange(len(part))
        for keeps_apart in _planes(mesh.points):
            if not len(left):
                break
            left = left[~keeps_apart(one[left], other[left])]
        if len(left):
            return _pair(part[left[0]])
    return None


def _planes(points: Floats) -> Iterator[Callable[[Ints, Ints], Bools]]:
    """The tests, each of which says of tets (k, 4) and (k, 4) which pairs one kind of plane keeps apart."""
    for facet in FACETS:
        yield partial(_beyond_facet, points, facet=facet)
        yield partial(_beyond_facet_of_other, points, facet=facet)
    for edge in EDGES:
        for another in EDGES:
            yield partial(_apart_along, points, edge=edge, another=another)


def _beyond_facet(points: Floats, one: Ints, other: Ints, facet: Ints) -> Bools:
    """(k,) whether the plane of a facet of the one tet has no point of the other on the side of the one."""
    beyond = np.ones(len(one), dtype=bool)
    for k in range(4):
        rows = np.flatnonzero(beyond)
        beyond[rows] = _signs(predicates.volume, points, one[rows][:, facet], other[rows, k], 3) >= 0
    return beyond


def _beyond_facet_of_other(points: Floats, one: Ints, other: Ints, facet: Ints) -> Bools:
    return _beyond_facet(points, other, one, facet)


def _apart_along(points: Floats, one: Ints, other: Ints, edge: Ints, another: Ints) -> Bools:
    """(k,) whether a plane along an edge of the one tet and an edge of the other keeps the tets apart."""
    lines = np.column_stack([one[:, edge], other[:, another]])
    off = [k for k in range(4) if k not in edge]
    ends = np.concatenate([one[:, off], other], axis=1)
    sides = _signs(predicates.along_edges, points, np.tile(lines, (6, 1)), ends.T.ravel(), 2).reshape(6, -1)
    here, there = sides[:2], sides[2:]
    low, high = np.min(here, axis=0), np.max(here, axis=0)
    below, above = np.min(there, axis=0), np.max(there, axis=0)
    parallel = (low == 0) & (high == 0)  # edges in one direction span no plane
    apart: Bools = ~parallel & (((high <= 0) & (below >= 0)) | ((low >= 0) & (above <= 0)))
    return apart


def _signs(polynomial: Polynomial, points: Floats, base: Ints, last: Ints, plane: int) -> NDArray[np.int8]:
    """(k,) for cells of a ``base`` and a ``last`` point; zero where that is one of the first ``plane`` of the base."""
    found = np.zeros(len(last), dtype=np.int8)
    rows = np.flatnonzero((base[:, :plane] != last[:, None]).all(axis=1))
    found[rows] = exact_signs(polynomial, points, np.column_stack([base[rows], last[rows]])).values[:, 0]
    return found


def _pair(row: Ints) -> tuple[int, int]:
    return int(row[0]), int(row[1])
