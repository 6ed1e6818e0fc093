"""One mesh that has everything a mesh can have, and surfaces."""

import itertools

import numpy as np

from wct_plugin.exact import predicates
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh


def _cube(count: int) -> tuple[np.ndarray, np.ndarray]:
    """A unit cube of count³ cells of six tets each, its points shaken so that no coordinate is a round number."""
    steps = np.arange(count + 1) / count
    points = np.array(list(itertools.product(steps, steps, steps)))
    points += np.random.default_rng(0).normal(scale=1e-3, size=points.shape)
    tets = []
    for corner in itertools.product(range(count), repeat=3):
        for order in itertools.permutations(range(3)):
            at, tet = list(corner), []
            for axis in (*order, None):
                tet.append((at[0] * (count + 1) + at[1]) * (count + 1) + at[2])
                if axis is not None:
                    at[axis] += 1
            tets.append(tet)
    tets = np.array(tets)
    negative = predicates.orientation(points, tets) < 0
    tets[negative] = tets[negative][:, [0, 1, 3, 2]]
    return points, tets


def plain_mesh() -> TetMesh:
    return TetMesh(*_cube(2))


def full_mesh(plain: TetMesh) -> TetMesh:
    random = np.random.default_rng(1)
    facets, count = plain.topology.boundary, len(plain.tets)
    return TetMesh(
        plain.points,
        plain.tets,
        np.arange(count) % 2 + 3,
        facets=Cells(
            facets,
            np.arange(len(facets)) % 3 + 7,
            {"flux": random.normal(size=len(facets)), "heat": random.normal(size=len(facets))},
            {"inlet": np.array([1, 4, 5])},
        ),
        edges=Cells(facets[:5, :2], np.arange(5) + 20),
        nodes=Cells(np.array([[3], [5], [11]]), np.array([1, 2, 1])),
        point_data={"u": random.normal(size=(len(plain.points), 3)), "id": np.arange(len(plain.points))},
        cell_data={
            "heat": random.normal(size=count),
            "a name <&\"é'": np.arange(count, dtype=np.int32) + 1,
            "uv": random.normal(size=(count, 2)).astype(np.float32),
        },
        point_sets={"fixed": np.array([0, 2, 3])},
        tet_sets={"core": np.array([2, 9])},
        names={"steel": (3, 3), "air": (4, 3), "the wall": (7, 2)},
    )


def full_surface(plain: TetMesh) -> SurfaceMesh:
    skin = plain.boundary_surface()
    return SurfaceMesh(
        skin.points,
        skin.triangles,
        np.arange(len(skin.triangles)) % 4,
        point_data={"quality": np.linspace(0, 1, len(skin.points)), "flag": np.arange(len(skin.points)) % 2 == 0},
        cell_data={"quality": np.linspace(0, 1, len(skin.triangles)), "id": np.arange(len(skin.triangles)) << 20},
    )
