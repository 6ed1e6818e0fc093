"""The symmetry groups of the cube, and point sets that have them."""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import permutations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.types import Floats

Ints = NDArray[Any]

NEAR = 1e-6
CORNERS: Floats = np.array(list(product((-0.5, 0.5), repeat=3)))


@lru_cache(maxsize=1)
def operations() -> Floats:
    """All 48 symmetries of the cube, (48, 3, 3), the identity first."""
    matrices = []
    for axes in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            matrix = np.zeros((3, 3))
            matrix[range(3), axes] = signs
            matrices.append(matrix)
    return np.array(matrices)


@lru_cache(maxsize=1)
def subgroups() -> tuple[tuple[int, ...], ...]:
    """One of each class of conjugate subgroups made by up to two elements, as indices of operations, smallest first."""
    ops = operations()
    weights = 3 ** np.arange(9)
    code = {int(c): i for i, c in enumerate((ops.reshape(48, 9) + 1) @ weights)}
    table = ((np.einsum("aij,bjk->abik", ops, ops).reshape(48, 48, 9) + 1) @ weights).astype(int)
    times = np.vectorize(code.__getitem__)(table)
    inverse = times.argmin(axis=1)  # the identity is number 0

    def generated(a: int, b: int) -> frozenset[int]:
        group = {0, a, b}
        while True:
            members = sorted(group)
            larger = set(times[np.ix_(members, members)].ravel().tolist())
            if larger == group:
                return frozenset(group)
            group = larger

    def conjugate(group: frozenset[int], by: int) -> frozenset[int]:
        return frozenset(int(times[times[by, one], inverse[by]]) for one in group)

    classes: dict[frozenset[int], tuple[int, ...]] = {}
    for a in range(48):
        for b in range(a, 48):
            group = generated(a, b)
            if group not in classes:
                first = min(tuple(sorted(conjugate(group, by))) for by in range(48))
                classes.update({conjugate(group, by): first for by in range(48)})
    return tuple(sorted(set(classes.values()), key=lambda group: (len(group), group)))


@dataclass(frozen=True)
class Arrangement:
    """Points of the cube, with its corners, that a group maps to themselves, one given for each orbit.

    A point on a face or an edge of the cube stays there, and one on a mirror or an axis of the group stays there:
    the points depend linearly on as few parameters as that leaves.
    """

    group: int
    """Which of :func:`subgroups`."""
    seats: Floats
    """(o, 3) a point of each orbit, none at a corner."""

    @cached_property
    def elements(self) -> Floats:
        """The group's operations, (m, 3, 3)."""
        return operations()[list(subgroups()[self.group])]

    @cached_property
    def levels(self) -> Ints:
        """On how many planes of the cube each orbit lies: 0 inside, 1 on a face, 2 on an edge."""
        return np.asarray((np.abs(self.seats) == 0.5).sum(1))

    @cached_property
    def _parts(self) -> tuple[Floats, Floats, Floats]:
        """Rest (n, 3), linear map (n, 3, k) and parameters (k,) of the points."""
        ops, seats = self.elements, self.seats
        images = np.einsum("gij,oj->ogi", ops, seats)
        fixed = (np.abs(images - seats[:, None]) < NEAR).all(2)
        mean = np.einsum("og,gij->oij", fixed / fixed.sum(1, keepdims=True), ops)
        inside = (np.abs(seats) != 0.5).astype(float)
        mean *= inside[:, :, None] * inside[:, None, :]
        sizes, axes = np.linalg.eigh(mean)
        free = sizes > 0.5
        same = (np.abs(images[:, :, None] - images[:, None]) < NEAR).all(3)
        orbit, element = np.nonzero(~np.tril(same, -1).any(2))
        blocks = ops[element] @ axes[orbit]
        linear = np.zeros((len(orbit), 3, 3 * len(seats)))
        for axis in range(3):
            linear[np.arange(len(orbit)), :, 3 * orbit + axis] = blocks[:, :, axis]
        linear = linear[:, :, free.ravel()]
        parameters = np.einsum("oij,oi->oj", axes, seats)[free]
        pinned = np.where(inside > 0, 0.0, seats)
        rest = np.einsum("nij,nj->ni", ops[element], pinned[orbit])
        return np.vstack([CORNERS, rest]), np.concatenate([np.zeros((8, 3, linear.shape[2])), linear]), parameters

    @property
    def parameters(self) -> Floats:
        """(k,) where the points are now."""
        return self._parts[2]

    @property
    def linear(self) -> Floats:
        """(n, 3, k) how the points follow the parameters."""
        return self._parts[1]

    def points(self, parameters: Floats | None = None) -> Floats:
        """All points, (n, 3), the cube's corners first."""
        rest, linear, now = self._parts
        return rest + linear @ (now if parameters is None else parameters)

    @cached_property
    def sizes(self) -> Ints:
        """Points of each orbit, (o,)."""
        images = np.einsum("gij,oj->ogi", self.elements, self.seats)
        same = (np.abs(images[:, :, None] - images[:, None]) < NEAR).all(3)
        return np.asarray((~np.tril(same, -1).any(2)).sum(1))

    def at(self, parameters: Floats) -> "Arrangement":
        """The same orbits elsewhere."""
        starts = 8 + np.concatenate([[0], np.cumsum(self.sizes)[:-1]])
        return Arrangement(self.group, self.points(parameters)[starts.astype(int)])

    def released(self) -> "Arrangement":
        """The same points without symmetry."""
        return Arrangement(0, self.points()[8:])


def seated(group: int, point: Floats, reach: float = 0.0) -> Floats:
    """The point itself, or, where operations of the group move it by less than reach, the place they keep."""
    ops = operations()[list(subgroups()[group])]
    images = ops @ point
    planes = np.abs(point) == 0.5
    near = (np.linalg.norm(images - point, axis=1) <= max(reach, NEAR)) & (images == point)[:, planes].all(1)
    return np.where(planes, point, images[near].mean(0))
