"""Random arrangements, and random changes of one."""

import numpy as np

from cubes.symmetry import CORNERS, Arrangement, Floats, operations, seated, subgroups

KINDS = {"shake": 0.3, "reseat": 0.12, "drop": 0.14, "merge": 0.12, "add": 0.12, "replace": 0.1, "restratify": 0.1}
APART = 0.13  # new points keep this distance from the others, less where there is no room


def _random_point(rng: np.random.Generator, level: int) -> Floats:
    """A point inside the cube, on a face or on an edge."""
    point = rng.uniform(-0.45, 0.45, 3) * (0.85 if level == 0 else 1.0)
    axes = rng.permutation(3)[:level]
    point[axes] = rng.choice([-0.5, 0.5], size=level)
    return np.asarray(point)


def _distance(seats: list[Floats], group: int, point: Floats) -> float:
    """From an orbit's points to each other and to all other points."""
    ops = operations()[list(subgroups()[group])]
    images = ops @ point
    own = np.linalg.norm(images - point, axis=1)
    others = np.vstack([CORNERS, *(ops @ seat for seat in seats)])
    return float(min(own[own > 1e-6].min(initial=9.0), np.linalg.norm(others - point, axis=1).min()))


def _inserted(rng: np.random.Generator, seats: list[Floats], group: int, level: int) -> bool:
    """Append a random orbit at this level where there is room."""
    for attempt in range(60):
        # on a mirror or an axis as often as anywhere: small orbits are what few tets are made of
        point = seated(group, _random_point(rng, level), reach=float(rng.choice([0.0, 0.3, 0.8])))
        if (np.abs(point) == 0.5).sum() == level and _distance(seats, group, point) > APART * (1 - attempt / 90):
            seats.append(point)
            return True
    return False


def random_arrangement(rng: np.random.Generator, group: int, most: int) -> Arrangement:
    """At most so many points, most of them on faces and edges."""
    seats: list[Floats] = []
    arrangement = Arrangement(group, np.zeros((0, 3)))
    weights = rng.dirichlet([2.0, 3.0, 2.0])
    for _ in range(most):
        if not _inserted(rng, seats, group, int(rng.choice(3, p=weights))):
            break
        grown = Arrangement(group, np.array(seats))
        if 8 + grown.sizes.sum() > most:
            seats.pop()
            break
        arrangement = grown
    return arrangement


def _layout(marks: list[bool]) -> list[tuple[float, float]]:
    """Points in a unit square whose triangles with its corners and the midpoints of the marked sides are acute.

    The sides in turn: bottom, right, top, left. Fewest known points; sides that do not allow acute angles get four.
    """
    points: dict[tuple[bool, ...], list[tuple[float, float]]] = {
        (True, False, True, False): [(0.3, 0.5), (0.7, 0.5)],
        (True, True, False, False): [(0.33, 0.4), (0.7, 0.3), (0.6, 0.67)],
        (True, True, True, False): [(0.7, 0.7), (0.7, 0.3), (0.32, 0.5)],
        (True, True, True, True): [(0.295, 0.295), (0.65, 0.35), (0.705, 0.705), (0.35, 0.65)],
    }
    for turns in range(4):
        if found := points.get(tuple(marks)):
            for _ in range(turns):
                found = [(1 - y, x) for x, y in found]
            return found
        marks = [*marks[1:], marks[0]]
    return points[True, True, True, True]


def layered_arrangement(rng: np.random.Generator, group: int, inside: int) -> Arrangement:
    """Midpoints of some edges of the cube, on its faces what makes these acute, and at most so many points inside."""
    ops = operations()[list(subgroups()[group])]
    seats: list[Floats] = []

    def add(point: Floats) -> None:
        loose = np.where(np.abs(point) == 0.5, point, point + rng.normal(size=3) * 0.02)
        seat = seated(group, loose, reach=0.12)
        if _distance(seats, group, seat) > 0.1:
            seats.append(seat)

    marked: Floats = np.zeros((0, 3))
    while len(marked) < 6:
        middle = _random_point(rng, 2)
        middle[np.abs(middle) != 0.5] = 0.0
        marked = np.unique(np.round(np.vstack([marked, ops @ middle]), 6) + 0.0, axis=0)
    for point in marked:
        add(point)
    for axis in rng.permutation(3):
        for side in (-0.5, 0.5):
            u, v = (k for k in range(3) if k != axis)
            middles = np.zeros((4, 3))
            middles[:, axis] = side
            middles[[0, 2], v] = -0.5, 0.5
            middles[[1, 3], u] = 0.5, -0.5
            for x, y in _layout([bool((np.abs(marked - middle).max(1) < 0.1).any()) for middle in middles]):
                point = np.zeros(3)
                point[[axis, u, v]] = side, x - 0.5, y - 0.5
                add(point)
    for _ in range(inside):
        _inserted(rng, seats, group, 0)
    return Arrangement(group, np.array(seats))


def _without_one(rng: np.random.Generator, seats: list[Floats]) -> int:
    """Drop an orbit, sooner inside than on the surface; its level, -1 where there is none."""
    levels = [int((np.abs(seat) == 0.5).sum()) for seat in seats]
    chosen = [i for i, level in enumerate(levels) if level == 0 or rng.random() < 0.35]
    if not chosen:
        return -1
    i = int(rng.choice(chosen))
    seats.pop(i)
    return levels[i]


def _merged(rng: np.random.Generator, seats: list[Floats], group: int) -> bool:
    """Put one orbit in the place of two near each other: between them, on the planes of either, both or the common."""
    if len(seats) < 2:
        return False
    first = seats.pop(int(rng.integers(len(seats))))
    images = np.array(seats) @ operations()[list(subgroups()[group])].transpose(0, 2, 1)
    gaps = np.linalg.norm(images - first, axis=2).min(0)
    which = int(rng.choice(np.argsort(gaps)[:4]))
    second = images[np.linalg.norm(images[:, which] - first, axis=1).argmin(), which]
    seats.pop(which)
    on = np.abs(first) == 0.5, np.abs(second) == 0.5
    planes = (on[0], on[1], on[0] | on[1], on[0] & on[1])[int(rng.integers(4))]
    middle = (first + second) / 2
    inside = np.where(np.abs(middle) == 0.5, 0.9 * middle, middle)
    point = seated(group, np.where(planes, np.where(on[0], first, second), inside), reach=0.1)
    if (np.abs(point) == 0.5).all() or _distance(seats, group, point) < 0.05:
        return False
    seats.append(point)
    return True


def _restratified(rng: np.random.Generator, seats: list[Floats], group: int) -> bool:
    """Push an orbit onto the nearest plane of the cube, or pull it off one."""
    if not seats:
        return False
    point = seats.pop(int(rng.integers(len(seats)))).copy()
    planes = np.abs(point) == 0.5
    if rng.random() < 0.5 and not planes.all():
        axis = int(np.argmax(np.where(planes, -1, np.abs(point))))
        if planes.sum() == 2 or abs(point[axis]) < 0.15:
            return False
        point[axis] = np.copysign(0.5, point[axis])
    elif planes.any():
        point[int(rng.choice(np.flatnonzero(planes)))] *= 0.7
    point = seated(group, point)
    if _distance(seats, group, point) < 0.05:
        return False
    seats.append(point)
    return True


def _shaken(rng: np.random.Generator, arrangement: Arrangement, size: float, share: float = 1.0) -> Arrangement:
    """All parameters, or a share of them, moved at random."""
    x = arrangement.parameters
    return arrangement.at(x + rng.normal(size=len(x)) * size * (rng.random(len(x)) < share))


def changed(rng: np.random.Generator, arrangement: Arrangement) -> Arrangement | None:
    """A random neighbour: points shaken, or an orbit moved, added, dropped, merged, pressed onto a face or lifted."""
    kind = rng.choice(list(KINDS), p=list(KINDS.values()))
    seats, group = list(arrangement.seats), arrangement.group
    if kind == "shake":
        size = float(rng.choice([0.004, 0.01, 0.02, 0.04, 0.07]))
        return _shaken(rng, arrangement, size, share=float(rng.choice([0.3, 1.0])))
    if kind == "merge" and not _merged(rng, seats, group):
        return None
    level = -1
    if kind in ("reseat", "drop", "replace"):
        level = _without_one(rng, seats)
        if level < 0:
            return None
    if kind in ("reseat", "add", "replace"):
        if kind != "reseat":
            level = int(rng.choice(3, p=[0.7, 0.22, 0.08]))
        if not _inserted(rng, seats, group, level):
            return None
    if kind == "restratify" and not _restratified(rng, seats, group):
        return None
    return _shaken(rng, Arrangement(group, np.array(seats)), 0.006) if seats else None
