"""What a facet that may not change rules out for the tet behind it, however the inside is meshed.

A tet that contains its circumcenter has a dihedral angle above 90 degrees at the longest edge of each facet that is not
acute: the circumcenter stands above the facet's own, which lies on or beyond that edge.
"""

from collections import Counter
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from wct_plugin.mesh import TetMesh
from wct_plugin.surface import Strata
from wct_plugin.topology import EDGES, FACETS
from wct_plugin.wedges import wedge_angles

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_ROUNDING = 1e-6  # degrees
_SIDES = np.array([[0, 1], [1, 2], [2, 0]])

NOT_ACUTE = "a fixed facet is not acute, so no tet on it is completely well-centered"
NO_ROOM = "a fixed facet needs a dihedral angle above 90° at its longest edge; the boundary leaves less"
NO_ROOM_FOR_TWO = "two fixed facets in a plane need dihedral angles above 90° at one edge; 180° is too little"


def verdicts(mesh: TetMesh, tets: Ints, of: Strata, *, acute: bool) -> list[str]:
    """Per tet of ``tets`` (k,) why no tet on its fixed surface facets can meet the goal, or "" where that is open.

    ``acute``: the goal includes acute facets.
    """
    return [next(filter(None, found.values()), "") for found in _reasons(mesh, tets, of, acute=acute)]


def ruled_out(mesh: TetMesh, of: Strata, *, acute: bool) -> Ints:
    """Rows of ``of.triangles`` on which no tet can meet the goal, on either side, as long as the facet stays."""
    names = list(map(tuple, np.sort(of.triangles, axis=1).tolist()))
    on_surface = of.stratum[mesh.tets].astype(bool).sum(axis=1) >= 3
    open_to_some: set[tuple[int, ...]] = set()
    beside: set[tuple[int, ...]] = set()
    for found in _reasons(mesh, np.flatnonzero(on_surface), of, acute=acute):
        beside.update(found)
        open_to_some.update(facet for facet, why in found.items() if not why)
    return np.array([k for k, name in enumerate(names) if name in beside - open_to_some], dtype=np.int64)


def _reasons(mesh: TetMesh, tets: Ints, of: Strata, *, acute: bool) -> list[dict[tuple[int, ...], str]]:
    """Per tet, for each of its surface facets that is not acute: why no tet on that side of it can meet the goal."""
    longest = _longest_edges(mesh.points, of.triangles)
    ends, sheets = np.unique(np.sort(of.triangles[:, _SIDES].reshape(-1, 2), axis=1), axis=0, return_counts=True)
    simple = set(map(tuple, ends[sheets == 2].tolist()))
    needing = Counter(longest.values())
    wedges = wedge_angles(mesh, tets)
    out = []
    for tet, wedge in zip(mesh.tets[tets], wedges, strict=True):
        room = {tuple(sorted(pair)): float(angle) for pair, angle in zip(tet[EDGES].tolist(), wedge, strict=True)}
        found = {}
        for row in tet[FACETS].tolist():
            facet = tuple(sorted(row))
            if facet not in longest:
                continue
            edge = longest[facet]
            if acute:
                found[facet] = NOT_ACUTE
            elif room[edge] <= 90.0 + _ROUNDING:
                found[facet] = NO_ROOM
            elif abs(room[edge] - 180.0) <= _ROUNDING and needing[edge] == 2 and edge in simple:
                found[facet] = NO_ROOM_FOR_TWO
            else:
                found[facet] = ""
        out.append(found)
    return out


def _longest_edges(points: Floats, triangles: Ints) -> dict[tuple[int, ...], tuple[int, ...]]:
    """The edge opposite an angle of 90 degrees or more, of each triangle that has one, exactly; all indices ascend."""
    corners = points[triangles]
    left, right = np.roll(corners, -1, axis=1) - corners, np.roll(corners, -2, axis=1) - corners
    dot = np.einsum("tij,tij->ti", left, right)
    doubt = 1e-12 * np.linalg.norm(left, axis=2) * np.linalg.norm(right, axis=2)
    out = {}
    for row, k in zip(*np.nonzero(dot <= doubt), strict=True):
        apex, one, two = np.roll(triangles[row], -k).tolist()
        if dot[row, k] < -doubt[row, k] or _exact_dot(points[apex], points[one], points[two]) <= 0:
            out[tuple(sorted((apex, one, two)))] = tuple(sorted((one, two)))
    return out


def _exact_dot(apex: Floats, one: Floats, two: Floats) -> Fraction:
    a, b, c = ([Fraction(x) for x in point.tolist()] for point in (apex, one, two))
    return sum(((y - x) * (z - x) for x, y, z in zip(a, b, c, strict=True)), Fraction(0))
