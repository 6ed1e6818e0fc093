"""What couples two vertices in a finite volume scheme, region by region, from the circumcenters themselves."""

import itertools

import numpy as np


def centers(corners):
    """Circumcenters (k, 3) of simplices with corners (k, n, 3), n = 3 or 4, in their own plane or space."""
    sides = corners[:, 1:] - corners[:, :1]
    gram = np.einsum("kix,kjx->kij", sides, sides)
    weights = np.linalg.solve(gram, 0.5 * np.einsum("kii->ki", gram)[..., None])[..., 0]
    return corners[:, 0] + np.einsum("ki,kix->kx", weights, sides)


def couples(mesh):
    """{(region, u, v): signed area} of the dual face that each region has across each of its edges."""
    found = {}
    points = mesh.points
    middle = centers(points[mesh.tets])
    for i, j in itertools.combinations(range(4), 2):
        others = [k for k in range(4) if k not in (i, j)]
        u, v = mesh.tets[:, i], mesh.tets[:, j]
        edge = points[v] - points[u]
        edge /= np.linalg.norm(edge, axis=1)[:, None]
        half = 0.5 * (points[u] + points[v])
        total = np.zeros(len(mesh.tets))
        for one, other in (others, others[::-1]):
            facet = centers(np.stack([points[u], points[v], points[mesh.tets[:, one]]], axis=1))
            # The quarter (half, facet, middle) counts as positive where it turns as (edge, corner, other corner) does.
            turn = np.sign(
                np.einsum(
                    "kx,kx->k", edge, np.cross(points[mesh.tets[:, one]] - half, points[mesh.tets[:, other]] - half)
                )
            )
            total += 0.5 * turn * np.einsum("kx,kx->k", edge, np.cross(facet - half, middle - half))
        for region, a, b, area in zip(mesh.regions.tolist(), u.tolist(), v.tolist(), total.tolist(), strict=True):
            key = (region, min(a, b), max(a, b))
            found[key] = found.get(key, 0.0) + area
    return found
