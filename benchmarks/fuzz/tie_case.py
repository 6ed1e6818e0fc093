"""A case of a near tie: a small mesh whose numbers floating point cannot tell from zero.

Right angles, cospherical points, circumcenters on facets, off by nothing or by some units in the last place.
"""

import itertools
import json
import random
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, QhullError

from benchmarks.fuzz.judge import exact, ties

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
#: Meshes that reports and filters take are larger than this and smaller than its inverse; flags take all.
UNIT = 1e-85


def _corner(draw: random.Random) -> Floats:
    """Three right angles, a path with four, or right angles between facets; sides of different lengths."""
    a, b, c = (float(draw.randint(1, 6)) for _ in range(3))
    return np.array(
        draw.choice(
            (
                [[0, 0, 0], [a, 0, 0], [0, b, 0], [0, 0, c]],
                [[0, 0, 0], [a, 0, 0], [a, b, 0], [a, b, c]],
                [[0, 0, 0], [2 * a, 0, 0], [a, b, 0], [a, 0, c]],
                [[0, 0, 0], [2, 0, 0], [1, 1, 1], [1, -1, 1]],
            )
        ),
        dtype=float,
    )


def _equator(draw: random.Random) -> Floats:
    """A facet through the center of the sphere, and a vertex to either side, by Pythagorean triples."""
    rim = [(3, 4), (-3, 4), (4, -3), (-4, -3), (-5, 0), (0, 5), (5, 0), (0, -5), (4, 3), (-4, 3)]
    ends = [(0, 0, 5), (0, 3, 4), (0, -3, 4), (3, 0, 4), (-4, 0, 3), (0, 0, -5), (0, 3, -4), (4, 0, -3)]
    flat = [(x, y, 0) for x, y in draw.sample(rim, 3)]
    return np.array([*flat, *draw.sample(ends, draw.randint(1, 2))], dtype=float)


def _sphere(draw: random.Random) -> Floats:
    """Points of a lattice at the same distance from a middle one, which may be among them."""
    square = draw.choice((9, 17, 26, 33, 41, 50))
    reach = range(-7, 8)
    points = [p for p in itertools.product(reach, reach, reach) if sum(x * x for x in p) == square]
    return np.array(draw.sample(points, draw.randint(4, 9)) + draw.choice(([], [(0, 0, 0)])), dtype=float)


def _lattice(draw: random.Random) -> Floats:
    points = list(itertools.product(range(3), repeat=3))
    return np.array(draw.sample(points, draw.randint(4, 10)), dtype=float) * draw.choice((1.0, 0.1, 1 / 3))


def _centered(draw: random.Random) -> Floats:
    """Two cells of the body-centered lattice: well-centered, with right angles between facets."""
    corners = [(2 * x, 2 * y, 2 * z) for x, y, z in itertools.product(range(3), range(2), range(2))]
    return np.array([*corners, (1, 1, 1), (3, 1, 1)], dtype=float) * draw.choice((1.0, 0.1))


_KINDS = (_corner, _equator, _sphere, _lattice, _centered)


def _turned(draw: random.Random, points: Floats) -> Floats:
    """By a matrix of integers, which keeps all angles exactly, or by one that rounds."""
    a, b, c, d = (draw.randint(-3, 3) for _ in range(4))
    if not a and not b and not c and not d:
        return points
    turn = np.array([
        [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
        [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
        [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
    ], dtype=float)  # fmt: skip
    return points @ (turn if draw.random() < 0.6 else turn / (a * a + b * b + c * c + d * d)).T


def make(seed: int, number: int) -> tuple[Floats, Ints]:
    """Points and positive tets, at least one of them."""
    draw = random.Random(f"tie {seed} {number}")
    while True:
        points = draw.choice(_KINDS)(draw)
        try:
            tets = Delaunay(points).simplices.astype(np.int64) if len(points) > 4 else np.arange(4)[None]
        except QhullError:
            continue
        if draw.random() < 0.6:
            points = _turned(draw, points)
        if draw.random() < 0.3:
            points = points + draw.choice((1.0, 7.0, 2.0**20, 1e5, 0.1))
        nudged = np.array([[draw.random() < 0.3 for _ in range(3)] for _ in points])
        if draw.random() < 0.7:
            step = draw.choice((1, 1, 1, 2, 30))
            points = points + nudged * np.spacing(points) * [
                [draw.randint(-step, step) for _ in range(3)] for _ in points
            ]
        if draw.random() < 0.4:
            points = points * 2.0 ** draw.choice((-1000, -300, -280, -60, 60, 280, 300, 1000, draw.randint(-300, 300)))
        tets = _positive(points, tets)
        if len(tets):
            used, inverse = np.unique(tets, return_inverse=True)
            return points[used], inverse.reshape(-1, 4)


def _positive(points: Floats, tets: Ints) -> Ints:
    """The tets that are not flat, each turned to be positive, decided by fractions."""
    signs = [exact.volume6(exact.as_fractions(points[tet])) for tet in tets]
    kept = [tet if sign > 0 else tet[[0, 1, 3, 2]] for tet, sign in zip(tets, signs, strict=True) if sign]
    return np.array(kept, dtype=np.int64).reshape(-1, 4)


def is_ordinary(points: Floats) -> bool:
    """Whether reports and filters take a mesh, by its unit of length."""
    return bool(UNIT < np.abs(np.ptp(points / 2, axis=0)).max() < 1 / UNIT)


def judged(points: Floats, tets: Ints) -> list[str]:
    """What the package says of a mesh, in numbers, flags, reports, JSON and certificate, beside what is exactly so."""
    import wct_plugin as wct
    from wct_plugin.certify.certificate import certify
    from wct_plugin.measure import quality
    from wct_plugin.reports.report import make_report

    mesh = wct.TetMesh(points, tets)
    true = ties.told(points, mesh.tets)
    measured = quality.measure(mesh)
    flags = {"3wc": measured.well_centered_3, "2wc": measured.well_centered_2, "acute": measured.acute}
    lengths = (measured.min_height > 0, measured.max_face_angle < 90, measured.max_dihedral_angle < 90)
    faults = ties.faults_of_flags("flag", flags, true)
    faults += ties.faults_of_flags("by its measure, flag", dict(zip(flags, lengths, strict=True)), true)
    if not is_ordinary(points):
        return faults + ties.faults_of_certificate(_as_json(certify(mesh)), true)
    marked, _ = wct.apply_filter("compute_scalar_by_well_centeredness", mesh)
    faults += ties.faults_of_flags("array", {name: marked.cell_data[f"is_{name}"] for name in flags}, true)
    report = _as_json(make_report(mesh, exact=True))
    return faults + ties.faults_of_counts(report, true) + ties.faults_of_certificate(report["certificate"], true)


def _as_json(told: Any) -> dict[str, Any]:
    """What comes out where it is written as JSON and read again."""
    read: dict[str, Any] = json.loads(json.dumps(told.to_dict(), allow_nan=False))
    return read
