"""Small random meshes, most of them nasty in one way: what a case of a command begins with."""

import itertools
import random
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, QhullError

from benchmarks.fuzz.outer_facets import FACETS, boundary_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass
class Made:
    """A mesh as arrays; nothing of it has been checked by who is to be tested."""

    kind: str
    points: Floats
    tets: Ints
    regions: Ints
    facets: Ints = field(default_factory=lambda: np.empty((0, 3), dtype=np.int64))
    facet_tags: Ints = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    edges: Ints = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    box: bool = False  #: made of boxes along the axes, whose sides are plane

    def write(self, path: Path) -> None:
        """Write it by meshio; regions and tags are physical tags as gmsh has them."""
        blocks = [("tetra", self.tets, self.regions), ("triangle", self.facets, self.facet_tags)]
        blocks.append(("line", self.edges, np.arange(len(self.edges)) + 50))
        blocks = [block for block in blocks if len(block[1])]
        tags = [block[2].astype(np.int64) for block in blocks]
        cell_data: dict[str, Any] = {"gmsh:physical": tags}
        if path.suffix == ".msh":
            cell_data["gmsh:geometrical"] = tags
        if path.suffix == ".mesh":
            cell_data = {"medit:ref": tags}
        mesh = meshio.Mesh(self.points, [block[:2] for block in blocks], cell_data=cell_data)
        meshio.write(path, mesh, **({"file_format": "gmsh22", "binary": False} if path.suffix == ".msh" else {}))


def _positive(points: Floats, tets: Ints) -> Ints:
    sides = points[tets[:, 1:]] - points[tets[:, :1]]
    turned: Ints = np.where((np.linalg.det(sides) > 0)[:, None], tets, tets[:, [0, 1, 3, 2]])
    return turned


def _used(points: Floats, tets: Ints) -> tuple[Floats, Ints]:
    used, inverse = np.unique(tets, return_inverse=True)
    return points[used], inverse.reshape(-1, 4)


def _cloud(draw: random.Random, rng: np.random.Generator) -> tuple[Floats, Ints]:
    """Delaunay's tets of random points; flattened, on a sphere, or clustered, slivers come by themselves."""
    points = rng.normal(size=(draw.randint(4, 35), 3))
    way = draw.randrange(5)
    if way == 0:
        points[:, 2] *= 10.0 ** -draw.uniform(0, 8)
    elif way == 1:
        points /= np.linalg.norm(points, axis=1)[:, None]
        points[0] = 0
    elif way == 2:
        points = np.round(points * draw.choice((1, 2, 4))) / 4
        points = np.unique(points, axis=0)
    elif way == 3:
        points[len(points) // 2 :] *= 10.0 ** -draw.uniform(1, 6)
    try:
        tets = Delaunay(points).simplices.astype(np.int64)
    except QhullError:
        points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        tets = np.array([[0, 1, 2, 3]])
    corners = points[tets]
    volumes = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1]))
    flat = volumes <= draw.choice((1e-3, 1e-9, 1e-14, 0.0)) * volumes.max()
    return _used(points, _positive(points, tets[~flat]))


def _grid(draw: random.Random, rng: np.random.Generator) -> tuple[Floats, Ints]:
    """Boxes of six tets each, some left out: cavities, bodies that share an edge or a point; steps uneven or thin."""
    shape = [draw.choice((1, 1, 2, 2, 3)) for _ in range(3)]
    steps = [
        np.concatenate([[0.0], np.cumsum([draw.choice((1, 1, 1, 0.5, 2)) for _ in range(count)])]) for count in shape
    ]
    if draw.random() < 0.2:  # layers
        steps[2] = np.concatenate([[0.0], np.cumsum(10.0 ** -rng.uniform(0, 4, shape[2]))])
    points = np.array(list(itertools.product(*steps)))
    keep = [cell for cell in itertools.product(*map(range, shape)) if draw.random() > draw.choice((0, 0, 0.3))]
    tets = []
    for cell in keep or [(0, 0, 0)]:
        for order in itertools.permutations(range(3)):
            at, tet = list(cell), []
            for axis in (*order, None):
                tet.append((at[0] * (shape[1] + 1) + at[1]) * (shape[2] + 1) + at[2])
                if axis is not None:
                    at[axis] += 1
            tets.append(tet)
    return _used(points, _positive(points, np.array(tets)))


def _near_ties(draw: random.Random, rng: np.random.Generator) -> tuple[Floats, Ints]:
    """Points off a lattice by a few units in the last place: circumcenters lie almost on facets."""
    points, tets = _grid(draw, rng)
    points = points + rng.integers(-3, 4, points.shape) * draw.choice((2.0**-52, 2.0**-40, 1e-9))
    return points, tets


def _shaken(draw: random.Random, rng: np.random.Generator) -> tuple[Floats, Ints]:
    points, tets = _grid(draw, rng)
    moved = points + rng.normal(size=points.shape) * draw.choice((0.02, 0.1, 0.2))
    corners = moved[tets]
    return moved, tets[np.linalg.det(corners[:, 1:] - corners[:, :1]) > 1e-6] if draw.random() < 0.7 else tets


def _bodies(draw: random.Random, rng: np.random.Generator) -> tuple[Floats, Ints]:
    """Several bodies that lie apart, touch with points of their own, or share points."""
    parts, tets, offset, at = [], [], 0, 0.0
    for _ in range(draw.randint(2, 4)):
        points, cells = draw.choice((_grid, _cloud))(draw, rng)
        points = points - points.min(axis=0)
        points[:, 0] += at
        at = points[:, 0].max() + draw.choice((0.0, 0.0, 1.0, 1e-9, 1e-3))
        parts.append(points)
        tets.append(cells + offset)
        offset += len(points)
    points, cells = np.concatenate(parts), np.concatenate(tets)
    if draw.random() < 0.5:  # equal points become one
        points, inverse = np.unique(points, axis=0, return_inverse=True)
        cells = inverse.reshape(-1)[cells]
    return points, cells


_KINDS = {"cloud": _cloud, "grid": _grid, "near ties": _near_ties, "shaken": _shaken, "bodies": _bodies}


def _regions(draw: random.Random, points: Floats, tets: Ints) -> Ints:
    match draw.randrange(5):
        case 0:
            normal = np.array([draw.gauss(0, 1) for _ in range(3)])
            behind: Ints = (points[tets].mean(axis=1) @ normal > points.mean(axis=0) @ normal).astype(np.int64)
            return 1 + behind
        case 1:
            return np.array([draw.choice((1, 2, 3)) for _ in tets])
        case 2:
            return np.array([draw.choice((-5, 0, 2**31, 7)) for _ in tets])
    return np.full(len(tets), draw.choice((0, 1, 5)))


def _tag(draw: random.Random, made: Made) -> None:
    """Tag facets of the boundary, sheets inside, and wires."""
    faces = [boundary_of(made.tets)] if draw.random() < 0.6 else []
    if faces and draw.random() < 0.4:
        faces[0] = faces[0][[draw.random() < 0.6 for _ in faces[0]]]
    if draw.random() < 0.25:  # any facets at all
        faces.append(
            np.array(
                [[tet[k] for k in draw.choice(FACETS.tolist())] for tet in made.tets.tolist() if draw.random() < 0.2]
            )
        )
    faces = [one for one in faces if len(one)]
    if faces:
        every = np.concatenate(faces)
        _, first = np.unique(np.sort(every, axis=1), axis=0, return_index=True)
        made.facets = every[np.sort(first)]
        most = draw.choice((0, 1, 3))
        made.facet_tags = np.array([11 + draw.randint(0, most) for _ in made.facets])
    if draw.random() < 0.15:
        made.edges = np.array([draw.sample(tet, 2) for tet in made.tets.tolist()[:3]])


def make(draw: random.Random) -> Made:
    """A random mesh; its unit, place and turn are random too."""
    rng = np.random.default_rng(draw.getrandbits(64))
    kind = draw.choice(list(_KINDS))
    points, tets = _KINDS[kind](draw, rng)
    made = Made(kind, points, tets, _regions(draw, points, tets), box=kind == "grid")
    _tag(draw, made)
    if draw.random() < 0.15:
        made.points = made.points + 10.0 ** draw.uniform(0, 9)
        made.box = False
    if draw.random() < 0.25:
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        made.points, made.box = made.points @ (turn * np.linalg.det(turn)).T, False
    if draw.random() < 0.15:
        made.points = made.points * 2.0 ** draw.randint(-300, 300)
    elif draw.random() < 0.1:
        made.points = made.points * 2.0 ** draw.randint(-1070, 1020)
    return made
