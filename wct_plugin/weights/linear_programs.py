"""Weights for which every tet contains its orthocenter, by sparse linear programmes: where positions alone fail.

The orthocenter's height over a facet is linear in the weights (:mod:`wct_plugin.measure.orthocenters`);
:mod:`wct_plugin.weights.rows` has them as rows. Four steps:

relaxing: descent over the whole mesh, for few tets that miss (:mod:`wct_plugin.weights.relaxation`).
mending: programmes around one missed tet at a time, kept where fewer tets miss afterwards.
widening: descent over the whole mesh, for margin.
lifting: programmes around one tet at a time, from the smallest margin up: maximise it and those about it that are no
    smaller, up to the margin aimed at, then with that one kept the sum of all, each counted up to the aim.

HiGHS solves the programmes, for some hundred vertices at a time, all other weights as they are. There is a limit to
how many: the time grows with the mesh only for the descent.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csr_array, eye_array, hstack, vstack

from wct_plugin.errors import WctError
from wct_plugin.measure import compiled_quality, orthocenters
from wct_plugin.mesh import TetMesh
from wct_plugin.types import Floats
from wct_plugin.weights.relaxation import ROUNDS, STAGES, relax, widen
from wct_plugin.weights.rows import CLEARANCE, Rows, contained, local_length, lowest, make_rows, rows_of

#: What HiGHS may miss a row by, ten times.
_SLACK = 1e-6
#: How far from a tet weights are changed to mend it.
_RINGS = 2
#: Around how many tets at most misses are mended, each by this many programmes at most.
_MENDED = 400
_TRIALS = 2
#: A tet's miss, in local lengths, at which its cost is halved in mending.
_NEAR = 1e-3
#: How many programmes at most lift margins, how many rings far at most, and what share of the aim is a small gain.
_LIFTED = 100
_FARTHEST = 3
_LITTLE = 0.01


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


def power_weights(mesh: TetMesh, aim: float, progress: Callable[[float, int], bool]) -> PowerWeights:
    """Weights that make as many tets as possible contain their orthocenter, then with as much margin as possible.

    ``aim``: margin, in local lengths, beyond which more is worth nothing; it is 0.204 in the regular tet. ``progress``
    is told the share done and how many tets are still without their orthocenter; when it gives False, the weights so
    far are kept. Raises :class:`WctError` where HiGHS fails.
    """
    rows = make_rows(mesh)
    for done, weights in _search(rows, aim):
        if not progress(done, int((~contained(rows.at(weights))).sum())):
            break
    return _result(mesh, weights * rows.unit)


def _search(rows: Rows, aim: float) -> Iterator[tuple[float, Floats]]:
    """The share done and the weights then, at first none."""
    weights = np.zeros(rows.matrix.shape[1])
    yield 0.0, weights
    steps: tuple[tuple[int, Callable[[Floats], Iterator[Floats]]], ...] = (
        (len(STAGES), lambda weights: relax(rows, weights)),
        (_MENDED, lambda weights: _mend(rows, weights)),
        (ROUNDS, lambda weights: widen(rows, weights, aim)),
        (_LIFTED, lambda weights: _lift(rows, weights, aim)),
    )
    for step, (most, better) in enumerate(steps):
        for count, found in enumerate(better(weights), 1):
            weights = found
            yield (step + count / most) / len(steps), weights


def _mend(rows: Rows, weights: Floats) -> Iterator[Floats]:
    """Weights for which fewer tets miss, from programmes around one that does at a time, those that miss least first.

    A cost per tet, not per row, that is the inverse of what it missed by in the programme before, leads to few misses
    (Candes, Wakin and Boyd, *Enhancing sparsity by reweighted l1 minimization*, 2008). The tet in the middle has the
    full cost at first, those that miss around it little: where only one of them can be helped, it is no matter which,
    but often helping the one is what it takes to help two. Dual lengths have the full cost.
    """
    weights, values = weights.copy(), rows.at(weights)
    margins = lowest(values)
    missing = np.flatnonzero(~contained(values))
    for tet in missing[np.argsort(-margins[missing], kind="stable")][:_MENDED]:
        if contained(values[4 * tet : 4 * tet + 4])[0]:
            continue  # by now
        free, cells = rows.near(tet, _RINGS)
        at = rows_of(cells)
        here = values[at]
        part, duals = rows.part(at, free)
        lengths = duals @ values
        fewest = int((~contained(here)).sum())
        missed = np.maximum(CLEARANCE - lowest(here), 0.0)
        missed[cells == tet] = 0.0
        for _ in range(_TRIALS):
            cost = np.append(np.repeat(_NEAR / (_NEAR + missed), 4), np.ones(len(lengths)))
            step = _fewest_misses(part, CLEARANCE - np.append(here, lengths), cost)
            change = part @ step
            reached = here + change[: len(at)]
            count = int((~contained(reached)).sum())
            if count < fewest:
                fewest, here = count, reached
                lengths = lengths + change[len(at) :]
                weights[free] += step
            missed = np.maximum(CLEARANCE - lowest(reached), 0.0)
        values[at] = here
        yield weights


def _lift(rows: Rows, weights: Floats, aim: float) -> Iterator[Floats]:
    """Weights with larger margins, from programmes around the tet with the smallest that is not settled, in turn.

    No row or dual length falls below the margin of the tet in the middle, or farther below it. Where that tet gains
    little, the next programme around it reaches a ring farther, up to the last, which settles it.
    """
    weights, values = weights.copy(), rows.at(weights)
    settled = ~contained(values)
    reach = np.ones(len(settled), dtype=np.int64)
    for _ in range(_LIFTED):
        margins = np.where(settled, np.inf, lowest(values))
        tet = int(np.argmin(margins))
        smallest = margins[tet]
        if not smallest < aim:
            return
        free, cells = rows.near(tet, int(reach[tet]))
        at = rows_of(cells)
        here = values[at]
        part, duals = rows.part(at, free)
        lengths = duals @ values
        raised = contained(here) & (lowest(here) >= smallest)
        both = np.append(here, lengths)
        sought = np.append(np.repeat(raised, 4), np.zeros(len(lengths), dtype=bool))
        step = _widen(part, both, sought, np.minimum(both, smallest), aim)
        reached = here + (part @ step)[: len(at)]
        if (contained(reached) >= contained(here)).all() and lowest(reached)[raised].min() > smallest:
            weights[free] += step
            values[at] = reached
        if lowest(values[4 * tet : 4 * tet + 4])[0] < smallest + _LITTLE * aim:
            settled[tet] = reach[tet] == _FARTHEST
            reach[tet] += 1
        yield weights


def _result(mesh: TetMesh, weights: Floats) -> PowerWeights:
    weights = weights - weights.min()
    heights, errors = compiled_quality.heights(mesh.points, mesh.tets)
    shifted, errors = orthocenters.shift_heights(mesh.points, mesh.tets, heights, errors, weights)
    known = np.isfinite(errors)
    return PowerWeights(weights, np.where(known, shifted, np.nan) / local_length(mesh)[:, None])


def _fewest_misses(matrix: csr_array, needed: Floats, cost: Floats) -> Floats:
    """The x with the least sum of cost * max(0, needed - matrix @ x), from the dual: few equations, boxed variables."""
    return _solve_dual(-needed, matrix.T, np.zeros(matrix.shape[1]), np.column_stack([np.zeros(len(cost)), cost]))


def _widen(matrix: csr_array, values: Floats, raised: NDArray[np.bool_], floors: Floats, aim: float) -> Floats:
    """The x that first lifts the smallest of the ``raised`` rows of ``values + matrix @ x``, then the sum of them.

    No row goes below its one of the ``floors``.
    """
    # max t: matrix x - t >= -values where raised, matrix x >= floors - values elsewhere, t <= aim.
    lift = csr_array(np.append(raised.astype(float), 1.0)[None])
    system = vstack([hstack([matrix.T, csr_array((matrix.shape[1], 1))]), lift])
    cost = np.append(np.where(raised, values, values - floors), aim)
    right = np.append(np.zeros(matrix.shape[1]), 1.0)
    solution = _solve_dual(cost, system, right, np.array([0.0, np.inf]))[:-1]
    reached = float((values + matrix @ solution)[raised].min())
    floors = np.where(raised, min(reached, aim), floors) - _SLACK
    # min sum of max(0, aim - row) over the raised rows, each at least at its floor: two dual variables per raised row.
    soft = eye_array(len(values), format="csr")[raised]
    system = hstack([matrix.T, (soft @ matrix).T])
    cost = np.concatenate([values - floors, values[raised] - aim])
    bounds = np.array([[0.0, np.inf]] * len(values) + [[0.0, 1.0]] * int(raised.sum()))
    return _solve_dual(cost, system, np.zeros(matrix.shape[1]), bounds)


def _solve_dual(cost: Floats, system: csr_array, right: Floats, bounds: Floats) -> Floats:
    """Minimise cost @ y with system @ y = right and y in ``bounds``; gives minus the equations' multipliers."""
    found = linprog(cost, A_eq=system, b_eq=right, bounds=bounds, method="highs-ds")
    if found.x is None:
        raise WctError(f"the linear programme for {system.shape[0]} weights failed: {found.message}")
    multipliers: Floats = -found.eqlin.marginals
    return multipliers
