"""Power distances: orthocenters of weighted vertices, as shifts of the circumcenters they are without weights.

A point's power distance from vertex i is |x - x_i|^2 - w_i; a tet's orthocenter, a facet's and an edge's is the point
of it that has the same from all its vertices. All are linear in the weights: the tet's is the circumcenter minus half
the gradient of the weights' linear interpolant, the facet's likewise within its plane.
"""

import numpy as np

from wct_plugin.mesh import unit_scaling
from wct_plugin.mesh.topology import FACETS, OPPOSITE_EDGES
from wct_plugin.types import Floats, Ints

_EPS = 32.0 * 2.0**-53


def slopes(points: Floats, tets: Ints) -> Floats:
    """(m, 4, 4) how the orthocenter's height over facet f grows with the weight of vertex i, at [:, f, i].

    -1/2 grad(lambda_i) . n_f, with n_f the facet's inward unit normal. Rows sum to zero: weights that are all equal
    change nothing.
    """
    unit = unit_scaling.exponent(points)
    corners = unit_scaling.rescaled(points, -unit)[tets]
    facets = corners[:, FACETS]
    outward = np.cross(facets[:, :, 1] - facets[:, :, 0], facets[:, :, 2] - facets[:, :, 0])
    det = np.einsum("mk,mk->m", corners[:, 1] - corners[:, 0], -outward[:, 1])
    areas = np.linalg.norm(outward, axis=2)
    table = outward @ outward.transpose(0, 2, 1) / (-2.0 * det[:, None, None] * areas[:, :, None])
    return unit_scaling.rescaled(table, -unit)


def shift_heights(
    points: Floats, tets: Ints, heights: Floats, errors: Floats, weights: Floats
) -> tuple[Floats, Floats]:
    """The orthocenters' heights (m, 4) and their bounds from the circumcenters' ``heights`` and ``errors`` (m, 4)."""
    given = weights[tets] - weights[tets].mean(axis=1, keepdims=True)  # a constant changes nothing, but would round
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        table = slopes(points, tets)
        size = np.einsum("mfi,mi->mf", np.abs(table), np.abs(given))
        return heights + np.einsum("mfi,mi->mf", table, given), errors + _EPS * size


def shift_cotangents(tets: Ints, cotangents: Floats, squares: Floats, weights: Floats) -> Floats:
    """(m, 12) twice the height of a facet's orthocenter over an edge of it, over the edge's length.

    Without weights that is the cotangent of the facet's angle opposite the edge, ``cotangents`` (m, 12); ``squares``
    (m, 6) are the edges' lengths squared. Columns as in :func:`wct_plugin.measure.quality.face_angles`.
    """
    out = cotangents.copy()
    for facet, corners in enumerate(FACETS):
        for place in range(3):
            one, two = (place + 1) % 3, (place + 2) % 3
            apex, a, b = weights[tets[:, corners[[place, one, two]]]].T
            pull = cotangents[:, 3 * facet + two] * (apex - a) + cotangents[:, 3 * facet + one] * (apex - b)
            out[:, 3 * facet + place] -= pull / squares[:, OPPOSITE_EDGES[3 * facet + place]]
    return out
