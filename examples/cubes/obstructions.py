"""Places of a connectivity where no positions are completely well-centered: the best margin there is zero or less."""

from collections import defaultdict
from itertools import combinations

import numpy as np

from cubes.symmetry import Floats, Ints

ANGLES_NEEDED = {1: 5, 2: 3, 3: 2}  # acute angles that fill a full turn, a straight one and a right one


def obstructions(points: Floats, tets: Ints) -> int:
    """How many such places are known of the tets (m, 4) of the cube."""
    facets = {tuple(sorted(facet)) for tet in tets.tolist() for facet in combinations(tet, 3)}
    planes = {(axis, side): np.flatnonzero(points[:, axis] == side) for axis in range(3) for side in (-0.5, 0.5)}
    on = [set() for _ in points]  # type: list[set[tuple[int, float]]]
    for plane, members in planes.items():
        for member in members:
            on[member].add(plane)
    links: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for facet in facets:
        for i in range(3):
            links[facet[i]].append((facet[i - 1], facet[i - 2]))
    return sum(
        _too_few_angles(m, on, links[m])
        + (len(on[m]) == 1 and _trapped_spokes(m, on, links[m], points))
        + (len(on[m]) == 2 and _straight_through(m, on, links[m], points))
        for m in range(len(points))
        if on[m]
    )


def _too_few_angles(m: int, on: list[set[tuple[int, float]]], link: list[tuple[int, int]]) -> int:
    """Angles that the vertex lacks on its faces of the cube, where none may be right or obtuse."""
    need = ANGLES_NEEDED[len(on[m])]
    return sum(max(0, need - sum(plane in on[x] and plane in on[y] for x, y in link)) for plane in on[m])


def _trapped_spokes(m: int, on: list[set[tuple[int, float]]], link: list[tuple[int, int]], points: Floats) -> int:
    """Neighbours off the face of m whose common neighbours with m in the face surround m: not all angles are acute."""
    (plane,) = on[m]
    u, v = (axis for axis in range(3) if axis != plane[0])
    around: dict[int, list[float]] = defaultdict(list)
    for pair in link:
        for x, y in (pair, pair[::-1]):
            if plane not in on[x] and plane in on[y]:
                around[x].append(float(np.arctan2(points[y, u] - points[m, u], points[y, v] - points[m, v])))
    trapped = 0
    for angles in around.values():
        if len(angles) >= 3:
            turn = np.sort(angles)
            trapped += bool(np.diff(np.append(turn, turn[0] + 2 * np.pi)).max() < np.pi - 1e-6)
    return trapped


def _straight_through(m: int, on: list[set[tuple[int, float]]], link: list[tuple[int, int]], points: Floats) -> bool:
    """Whether facets around m, on an edge of the cube, pass the half turn from one side of m on the edge to the other.

    Acute angles at m between a, its neighbour on the edge, and x bound x to one half space; facet by facet the bounds
    hand on as far as b on the other side, which then has to be on both sides of m.
    """
    first, second = sorted(on[m])
    (axis,) = {0, 1, 2} - {first[0], second[0]}
    line = [i for i in range(len(points)) if on[m] <= on[i]]
    below = [i for i in line if points[i, axis] < points[m, axis]]
    above = [i for i in line if points[i, axis] > points[m, axis]]
    a = max(below, key=lambda i: float(points[i, axis]))
    b = min(above, key=lambda i: float(points[i, axis]))

    def hands_on(x: int, y: int) -> bool:
        only = [(first in on[i], second in on[i]) for i in (x, y)]
        return x == a or y == b or only in ([(True, False), (False, True)], [(False, True), (True, False)])

    ways: dict[int, list[int]] = defaultdict(list)
    for pair in link:
        for x, y in (pair, pair[::-1]):
            if hands_on(x, y):
                ways[x].append(y)
    reached, front = {a}, [a]
    while front:
        for y in ways[front.pop()]:
            if y not in reached:
                reached.add(y)
                front.append(y)
    return b in reached
