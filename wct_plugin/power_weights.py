"""Weights for which every tet contains its orthocenter, by sparse linear programmes: where positions alone fail.

The orthocenter's height over a facet is linear in the weights (:mod:`wct_plugin.power`), and so is the dual length of
an interior facet, the sum of the two heights over it. All are divided by the tet's root mean square edge length. Three
programmes, all over all rows ``heights + slopes @ weights`` at once:

feasibility: minimise the sum over rows of cost * max(0, CLEARANCE - row). Costs are 1 at first, then lower where a
    row has missed by much, so that what cannot be met is left to few tets instead of a little to many.
mending: the same around one missed tet at a time with a cost per tet, kept where fewer tets miss afterwards.
margin: maximise the smallest row of the tets that contain their orthocenter, up to the margin aimed at, then with that
    one kept the sum of all, each counted up to the aim. No row of the other tets gets worse.

HiGHS solves them for a few hundred vertices at a time, all other weights as they are, which is many times faster than
at once and never makes the objective worse; sweeps with other cuts mend what the cuts between the blocks left.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csc_array, csr_array, eye_array, hstack, vstack

from wct_plugin import power, quality
from wct_plugin.errors import WctError
from wct_plugin.mesh import TetMesh
from wct_plugin.topology import EDGES

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Height over local length that counts as inside while weights are sought: above rounding, below anything of use.
CLEARANCE = 1e-4
#: A row as high as this has met the clearance; the rest is rounding of the simplex method.
_MET = 0.99 * CLEARANCE
#: What HiGHS may miss a row by, ten times.
_SLACK = 1e-6
#: How fast a height may grow with a weight, in a tet of size 1: in flatter ones rounding decides what HiGHS finds.
_STEEPEST = 1e5
#: Vertices of a block; the time of the simplex method grows faster than their number.
_BLOCK = 600
_MARGIN_BLOCK = 250
#: How far from a miss weights are changed to mend it.
_RINGS = 2
#: Where each sweep's first cut lies, as a share of the vertices: feasibility, then margin.
_FEASIBILITY_CUTS = (0.5, 0.3, 0.7, 0.4)
_MARGIN_CUTS = (0.5, 0.35)
#: A miss, in local lengths, at which a row's cost is halved.
_FORGIVEN = 0.01
#: Around how many tets at most misses are mended, each by this many programmes at most.
_MENDED = 200
_ROUNDS = 4
#: A tet's miss, in local lengths, at which its cost is halved in mending.
_NEAR = 1e-3


@dataclass(frozen=True, eq=False)
class PowerWeights:
    """What was found."""

    weights: Floats  #: (n,) of the unit of length squared, the smallest one 0
    #: (m, 4) the orthocenters' over the facets, over the tet's root mean square edge length; NaN in slivers too flat
    heights: Floats

    @property
    def margins(self) -> Floats:
        """(m,) the smallest of a tet's four heights; positive where it contains its orthocenter."""
        margins: Floats = self.heights.min(axis=1)
        return margins


@dataclass(frozen=True, eq=False)
class _Rows:
    """What should be positive, ``constant + matrix @ weights``: four rows per tet, then one per interior facet."""

    constant: Floats  # (r,)
    matrix: csc_array  # (r, n)
    tets: int

    def at(self, weights: Floats) -> Floats:
        values: Floats = self.constant + self.matrix @ weights
        return values

    def near(self, missed: NDArray[np.bool_]) -> Ints:
        """The vertices of the rows ``missed`` (r,) and those at most :data:`_RINGS` rows away."""
        pattern = csr_array((np.ones(self.matrix.nnz), self.matrix.indices, self.matrix.indptr), self.matrix.T.shape)
        reached = pattern @ missed
        for _ in range(_RINGS):
            reached = pattern @ (pattern.T @ reached > 0)
        return np.flatnonzero(reached)

    def contained(self, values: Floats) -> NDArray[np.bool_]:
        """(m,) whether each tet's four rows have at least half the clearance, so that rounding is no matter."""
        lowest = values[: 4 * self.tets].reshape(-1, 4).min(axis=1)
        return np.asarray(lowest > CLEARANCE / 2)


def power_weights(mesh: TetMesh, aim: float, progress: Callable[[float, int], bool]) -> PowerWeights:
    """Weights that make as many tets as possible contain their orthocenter, then with as much margin as possible.

    ``aim``: margin, in local lengths, beyond which more is worth nothing; it is 0.204 in the regular tet. ``progress``
    is told the share done and how many tets are still without their orthocenter; when it gives False, the weights so
    far are kept. Raises :class:`WctError` where HiGHS fails.
    """
    rows, unit = _make_rows(mesh)
    weights = np.zeros(len(mesh.points))
    total = len(_FEASIBILITY_CUTS) + len(_MARGIN_CUTS)
    cost = np.ones(len(rows.constant))
    for sweep, cut in enumerate(_FEASIBILITY_CUTS + _MARGIN_CUTS):
        seeks_margin = sweep >= len(_FEASIBILITY_CUTS)
        values = rows.at(weights)
        kept = np.append(np.repeat(rows.contained(values), 4), np.zeros(len(values) - 4 * rows.tets, dtype=bool))
        movable = np.arange(len(weights)) if seeks_margin else rows.near(values < _MET)
        blocks = list(_blocks(mesh.points, movable, cut, _MARGIN_BLOCK if seeks_margin else _BLOCK))
        for count, block in enumerate(blocks):
            bad = int((~rows.contained(values)).sum())
            if not progress((sweep + count / len(blocks)) / total, bad):
                return _result(mesh, weights * unit)
            part = rows.matrix[:, block].tocsr()
            near = np.flatnonzero(np.diff(part.indptr))
            part, here = part[near], values[near]
            if seeks_margin:
                step = _widen(part, here, kept[near], aim)
            elif (here < _MET).any():
                step = _fewest_misses(part, CLEARANCE - here, cost[near])
            else:
                continue
            weights[block] += step
            values[near] += part @ step
        missed = np.maximum(CLEARANCE - rows.at(weights), 0.0)
        cost = _FORGIVEN / (_FORGIVEN + missed)
        if sweep == len(_FEASIBILITY_CUTS) - 1:
            weights = _mend(mesh.tets, rows, weights)
    return _result(mesh, weights * unit)


def _mend(tets: Ints, rows: _Rows, weights: Floats) -> Floats:
    """Weights for which fewer tets miss, from programmes around one that does at a time, those that miss least first.

    A cost per tet, not per row, that is the inverse of what it missed by in the programme before, leads to few misses
    (Candes, Wakin and Boyd, *Enhancing sparsity by reweighted l1 minimization*, 2008). The tet in the middle has the
    full cost at first, those that miss around it little: where only one of them can be helped, it is no matter which,
    but often helping the one is what it takes to help two.
    """
    weights, matrix = weights.copy(), rows.matrix[: 4 * rows.tets].tocsr()
    constant = rows.constant[: 4 * rows.tets]
    lowest = (constant + matrix @ weights).reshape(-1, 4).min(axis=1)
    missing = np.flatnonzero(lowest <= CLEARANCE / 2)
    for tet in missing[np.argsort(-lowest[missing], kind="stable")][:_MENDED]:
        if lowest[tet] > CLEARANCE / 2:
            continue  # by now
        near = np.zeros(len(weights), dtype=bool)
        near[tets[tet]] = True
        for _ in range(_RINGS):
            near[tets[near[tets].any(axis=1)]] = True
        cells = np.flatnonzero(near[tets].any(axis=1))
        free = np.flatnonzero(near)
        at = (4 * cells[:, None] + np.arange(4)).ravel()
        part = matrix[at][:, free]
        values = constant[at] + matrix[at] @ weights
        fewest = int((lowest[cells] <= CLEARANCE / 2).sum())
        missed = np.maximum(CLEARANCE - lowest[cells], 0.0)
        missed[cells == tet] = 0.0
        for _ in range(_ROUNDS):
            step = _fewest_misses(part, CLEARANCE - values, np.repeat(_NEAR / (_NEAR + missed), 4))
            reached = (values + part @ step).reshape(-1, 4).min(axis=1)
            count = int((reached <= CLEARANCE / 2).sum())
            if count < fewest:
                fewest = count
                weights[free] += step
                values += part @ step
                lowest[cells] = reached
            before, missed = missed, np.maximum(CLEARANCE - reached, 0.0)
            if np.allclose(missed, before, rtol=0.0, atol=_SLACK):
                break
    return weights


def _result(mesh: TetMesh, weights: Floats) -> PowerWeights:
    weights = weights - weights.min()
    heights, errors = quality.heights(mesh.points, mesh.tets)
    shifted, errors = power.shift_heights(mesh.points, mesh.tets, heights, errors, weights)
    known = np.isfinite(errors)
    return PowerWeights(weights, np.where(known, shifted, np.nan) / _local_length(mesh)[:, None])


def _local_length(mesh: TetMesh) -> Floats:
    """(m,) root mean square length of each tet's six edges."""
    edges = mesh.points[mesh.tets[:, EDGES[:, 1]]] - mesh.points[mesh.tets[:, EDGES[:, 0]]]
    length: Floats = np.sqrt(np.einsum("mek,mek->m", edges, edges) / len(EDGES))
    return length


def _make_rows(mesh: TetMesh) -> tuple[_Rows, float]:
    """The rows, for weights in multiples of the second value, which keeps their coefficients near 1."""
    count, length = len(mesh.tets), _local_length(mesh)
    unit = float(np.median(length)) ** 2
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        slopes = power.slopes(mesh.points, mesh.tets) * (unit / length)[:, None, None]
        heights, errors = (of / length[:, None] for of in quality.heights(mesh.points, mesh.tets))
    # Of a tet that is too flat nothing is asked: rows that are constant and always met.
    steepness = np.abs(slopes).max(axis=(1, 2)) * length**2 / unit
    flat: NDArray[np.bool_] = ~((steepness < _STEEPEST) & np.isfinite(errors).all(axis=1))
    heights[flat], slopes[flat] = 1.0, 0.0
    heights, slopes = heights.ravel(), slopes.ravel()
    columns = np.repeat(mesh.tets, 4, axis=0).ravel()
    of_tets = csr_array((slopes, columns, np.arange(0, 16 * count + 1, 4)), shape=(4 * count, len(mesh.points)))
    pairs = mesh.topology.interior_pairs
    sides = pairs[:, [0, 2]] * 4 + pairs[:, [1, 3]]
    shares = length[pairs[:, [0, 2]]]
    shares /= shares.sum(axis=1, keepdims=True)
    starts = np.arange(0, 2 * len(pairs) + 1, 2)
    both = csr_array((shares.ravel(), sides.ravel(), starts), shape=(len(pairs), 4 * count))
    matrix = vstack([of_tets, both @ of_tets]).tocsc()
    return _Rows(np.concatenate([heights, both @ heights]), matrix, count), unit


def _blocks(points: Floats, movable: Ints, cut: float, most: int) -> Iterator[Ints]:
    """The vertices ``movable`` in blocks, cut across where they reach farthest: first at ``cut``, then into halves."""

    def split(part: Ints, share: float) -> Iterator[Ints]:
        if len(part) <= most:
            yield part
            return
        axis = np.argmax(np.ptp(points[part], axis=0))
        part = part[np.argsort(points[part, axis], kind="stable")]
        middle = int(share * len(part))
        yield from split(part[:middle], 0.5)
        yield from split(part[middle:], 0.5)

    yield from split(movable, cut)


def _fewest_misses(matrix: csr_array, needed: Floats, cost: Floats) -> Floats:
    """The x with the least sum of cost * max(0, needed - matrix @ x), from the dual: few equations, boxed variables."""
    return _solve_dual(-needed, matrix.T, np.zeros(matrix.shape[1]), np.column_stack([np.zeros(len(cost)), cost]))


def _widen(matrix: csr_array, values: Floats, kept: NDArray[np.bool_], aim: float) -> Floats:
    """The x that first lifts the smallest of the ``kept`` rows of ``values + matrix @ x``, then the sum of them."""
    floors = np.minimum(values, CLEARANCE)  # of the rows not kept: no worse than now
    if not kept.any():
        return np.zeros(matrix.shape[1])
    # max t: matrix x - t >= -values where kept, matrix x >= floors - values elsewhere, t <= aim.
    lift = csr_array(np.append(kept.astype(float), 1.0)[None])
    system = vstack([hstack([matrix.T, csr_array((matrix.shape[1], 1))]), lift])
    cost = np.append(np.where(kept, values, values - floors), aim)
    right = np.append(np.zeros(matrix.shape[1]), 1.0)
    solution = _solve_dual(cost, system, right, np.array([0.0, np.inf]))[:-1]
    reached = float((values + matrix @ solution)[kept].min())
    floors = np.where(kept, min(reached, aim), floors) - _SLACK
    # min sum of max(0, aim - row) over the kept rows, each at least at its floor: two dual variables per kept row.
    soft = eye_array(len(values), format="csr")[kept]
    system = hstack([matrix.T, (soft @ matrix).T])
    cost = np.concatenate([values - floors, values[kept] - aim])
    bounds = np.array([[0.0, np.inf]] * len(values) + [[0.0, 1.0]] * int(kept.sum()))
    return _solve_dual(cost, system, np.zeros(matrix.shape[1]), bounds)


def _solve_dual(cost: Floats, system: csr_array, right: Floats, bounds: Floats) -> Floats:
    """Minimise cost @ y with system @ y = right and y in ``bounds``; gives minus the equations' multipliers."""
    found = linprog(cost, A_eq=system, b_eq=right, bounds=bounds, method="highs-ds")
    if found.x is None:
        raise WctError(f"the linear programme for {system.shape[0]} weights failed: {found.message}")
    multipliers: Floats = -found.eqlin.marginals
    return multipliers
