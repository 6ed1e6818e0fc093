"""Small meshes for the tests, built by hand or by SciPy's Delaunay; plain functions without state."""

from collections.abc import Callable
from itertools import permutations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.types import Floats, Ints


def single(points: object) -> TetMesh:
    """One tet on four points."""
    return TetMesh(np.asarray(points, dtype=float), np.arange(4)[None])


def regular_tet(edge: float = 1.0) -> TetMesh:
    """The regular tetrahedron."""
    corners = np.array([[1, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1]])
    return single(corners * (edge / np.sqrt(8.0)))


def kuhn_grid(shape: tuple[int, int, int], keep: Callable[[Floats], NDArray[np.bool_]] | None = None) -> TetMesh:
    """Unit cubes, six tets each along the main diagonal, conforming; ``keep`` selects cubes by their centers (k, 3)."""
    nx, ny, nz = shape
    axes = [np.arange(size + 1) for size in shape]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3).astype(float)
    strides = np.array([(ny + 1) * (nz + 1), nz + 1, 1])
    cells = np.stack(np.meshgrid(*(np.arange(s) for s in (nx, ny, nz)), indexing="ij"), axis=-1).reshape(-1, 3)
    if keep is not None:
        cells = cells[keep(cells + 0.5)]
    corner = cells @ strides
    paths = [np.cumsum([0, *strides[list(order)]]) for order in permutations(range(3))]
    tets = np.concatenate([corner[:, None] + path for path in paths])
    return TetMesh(points, _positive(points, tets))


def fin() -> TetMesh:
    """A slab of 5 x 4 unit cubes with a wall of 4 x 3 on it, one cube thick."""
    grid = kuhn_grid((5, 4, 4), lambda centers: (centers[:, 2] < 1) | (np.abs(centers[:, 0] - 2.5) < 0.6))
    return TetMesh(grid.points, grid.tets)  # without the grid's other points


def kuhn_cube(n: int) -> TetMesh:
    """The unit cube in 6 n^3 tets."""
    grid = kuhn_grid((n, n, n))
    return TetMesh(grid.points / n, grid.tets)


def jittered_cube(n: int, seed: int = 0, amount: float = 0.25) -> TetMesh:
    """The unit cube, Delaunay of a grid whose interior points are shifted by up to ``amount`` cells."""
    rng = np.random.default_rng(seed)
    points = np.stack(np.meshgrid(*[np.arange(n + 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    shift = rng.uniform(-amount, amount, points.shape)
    shift[(points == 0) | (points == n)] = 0.0  # faces stay flat, edges straight, corners sharp
    return delaunay((points + shift) / n)


def shaken_cube(n: int, seed: int = 0, amount: float = 0.25) -> TetMesh:
    """The unit cube's Kuhn grid, all points shifted by up to ``amount`` cells: not Delaunay, many duals negative."""
    mesh = kuhn_cube(n)
    shift = np.random.default_rng(seed).uniform(-amount / n, amount / n, mesh.points.shape)
    return TetMesh(mesh.points + shift, mesh.tets)


def delaunay(points: Floats, flattest: float = 1e-9) -> TetMesh:
    """Delaunay of points, without tets flatter than ``flattest`` (volume over cube of longest edge) on the hull."""
    tets = Delaunay(points).simplices.astype(np.int64)
    edges = points[tets[:, 1:]] - points[tets[:, :1]]
    size = np.abs(np.linalg.det(edges)) / np.linalg.norm(edges, axis=2).max(axis=1) ** 3
    return TetMesh(points, _positive(points, tets[size > flattest]))


def fibonacci_sphere(count: int) -> Floats:
    """``count`` well spread points on the unit sphere (count, 3)."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    angle = np.pi * (1.0 + np.sqrt(5.0)) * k
    ring = np.sqrt(1.0 - z * z)
    return np.column_stack([ring * np.cos(angle), ring * np.sin(angle), z])


def ball(n: int) -> TetMesh:
    """The unit ball with cells of about 1/n: Fibonacci points on the sphere, a jittered grid inside."""
    rng = np.random.default_rng(n)
    grid = np.stack(np.meshgrid(*[np.arange(-n, n + 1) / n] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    grid = grid + rng.uniform(-0.15 / n, 0.15 / n, grid.shape)
    inside = grid[np.linalg.norm(grid, axis=1) < 1.0 - 0.7 / n]
    return delaunay(np.vstack([fibonacci_sphere(12 * n * n), inside]), flattest=1e-6)


def interleaved_ball(seed: int) -> TetMesh:
    """A ball in a ball whose regions take turns in the order of the tets."""
    mesh = ball(6)
    inner = np.linalg.norm(mesh.points[mesh.tets].mean(axis=1) - mesh.points.mean(axis=0), axis=1) < 0.6
    order = np.random.default_rng(seed).permutation(len(mesh.tets))
    return TetMesh(mesh.points, mesh.tets[order], inner[order].astype(np.int64))


def geodesic_ball(n: int, seed: int = 0) -> TetMesh:
    """The unit ball with an acute surface, an icosahedron's faces divided n by n; a jittered BCC lattice inside."""
    from scipy.spatial import ConvexHull

    golden = (1.0 + np.sqrt(5.0)) / 2.0
    signs = [(a, b) for a in (-1.0, 1.0) for b in (-golden, golden)]
    corners = np.array([np.roll([0.0, a, b], k) for a, b in signs for k in range(3)])
    weights = np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]) / n
    divided = (weights @ corners[ConvexHull(corners).simplices]).reshape(-1, 3)
    divided /= np.linalg.norm(divided, axis=1, keepdims=True)
    surface = np.unique(divided.round(12), axis=0)  # points on the icosahedron's edges come from both of its faces
    cell = 1.5 / n
    lattice = np.stack(np.meshgrid(*[np.arange(-n, n + 1) * cell] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    lattice = np.vstack([lattice, lattice + cell / 2.0])
    inside = lattice[np.linalg.norm(lattice, axis=1) < 1.0 - 0.6 * cell]
    inside = inside + np.random.default_rng(seed).uniform(-0.1 * cell, 0.1 * cell, inside.shape)
    return delaunay(np.vstack([surface, inside]), flattest=1e-6)


def sphere_surface(count: int, radius: float = 1.0) -> SurfaceMesh:
    """The convex hull of ``count`` well spread points on a sphere, outward."""
    from scipy.spatial import ConvexHull

    points = fibonacci_sphere(count)
    triangles = ConvexHull(points).simplices.astype(np.int64)
    corners = points[triangles]
    inward = np.linalg.det(corners) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return SurfaceMesh(radius * points, triangles)


def square(z: float = 0.0, n: int = 1, size: float = 1.0) -> SurfaceMesh:
    """A flat square of 2 n^2 triangles."""
    line = np.linspace(0.0, size, n + 1)
    points = np.stack(np.meshgrid(line, line, [z], indexing="ij"), axis=-1).reshape(-1, 3)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    halves = np.array([[0, n + 1, n + 2], [0, n + 2, 1]])
    return SurfaceMesh(points, (corner[:, None, None] + halves).reshape(-1, 3))


def two_region_cube(n: int) -> TetMesh:
    """The unit cube, region 1 below z = 1/2 and region 2 above (n even)."""
    mesh = kuhn_cube(n)
    above = mesh.points[mesh.tets].mean(axis=1)[:, 2] > 0.5
    return TetMesh(mesh.points, mesh.tets, regions=1 + above.astype(np.int64))


def l_shape(n: int) -> TetMesh:
    """Two by two cubes of n^3 cells each, without one: an L of thickness n."""
    grid = kuhn_grid((2 * n, 2 * n, n), lambda centers: (centers[:, 0] < n) | (centers[:, 1] < n))
    return TetMesh(grid.points / n, grid.tets)


def bcc(n: int) -> TetMesh:
    """Sommerville's tets: the BCC tiling of n^3 unit cells, only the tets whose circumcenter lies in the box.

    Every interior facet is shared; the hull is jagged. Each tet joins two neighbouring cube corners and two
    neighbouring cube centers.
    """
    corners = np.stack(np.meshgrid(*[np.arange(n + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    centers = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    number = {tuple(2 * p): k for k, p in enumerate(corners)}
    number |= {tuple(2 * p + 1): len(corners) + k for k, p in enumerate(centers)}
    tets = []
    for center in centers * 2 + 1:
        for axis in range(3):
            step = 2 * np.eye(3, dtype=int)[axis]
            other = tuple(center + step)
            if other not in number:
                continue
            side = [np.roll([0, y, z], axis) for y, z in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
            ring = [number[tuple(center + step // 2 + s)] for s in side]
            ends = [number[tuple(center)], number[other]]
            tets += [[*ends, ring[k], ring[(k + 1) % 4]] for k in range(4)]
    points = np.vstack([corners, centers + 0.5]).astype(float)
    used = np.unique(tets)
    place = np.full(len(points), -1)
    place[used] = np.arange(len(used))
    return TetMesh(points[used], _positive(points[used], place[np.array(tets)]))


def cylinder(n: int = 12, layers: int = 4) -> TetMesh:
    """Radius 1, height 2: prisms around the axis, split conformingly; ``n`` sectors, ``layers`` layers, one ring."""
    angle = 2.0 * np.pi * np.arange(n) / n
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    flat = np.vstack([[0.0, 0.0], ring])
    heights = np.linspace(0.0, 2.0, layers + 1)
    points = np.vstack([np.column_stack([flat, np.full(len(flat), z)]) for z in heights])
    tets = []
    for layer in range(layers):
        low = layer * (n + 1)
        for k in range(n):
            wedge = np.sort([0, 1 + k, 1 + (k + 1) % n]) + low
            a, b, c = wedge
            d, e, f = wedge + n + 1
            tets += [[a, b, c, f], [a, b, e, f], [a, d, e, f]]
    return TetMesh(points, _positive(points, np.array(tets)))


def rotation(seed: int) -> Floats:
    """A random rotation matrix (3, 3), determinant 1."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    q[:, 0] *= np.sign(np.linalg.det(q))
    return q


def _positive(points: Floats, tets: Ints) -> Ints:
    edges = points[tets[:, 1:]] - points[tets[:, :1]]
    flip = np.linalg.det(edges) < 0
    out = np.array(tets, dtype=np.int64)
    out[flip] = out[flip][:, [0, 1, 3, 2]]
    return out
