"""Weights by descent over the whole mesh at once: where the linear programmes of :mod:`.linear_programs` start.

A linear programme over a hundred thousand tets takes minutes. A few hundred gradients of a smooth function take
seconds, and leave little to do for programmes in a few places.
"""

from collections.abc import Callable, Iterator

import numpy as np

from wct_plugin.types import Floats
from wct_plugin.weights.lbfgs import minimise
from wct_plugin.weights.rows import CLEARANCE, Rows, contained, lowest

#: The value and the derivative by each row.
Regret = Callable[[Floats], tuple[float, Floats]]

#: What rows aim at, the miss at which a tet is given up, both in local lengths, and how many steps of descent.
STAGES = (
    (0.02, np.inf, 120),
    (0.01, 0.1, 120),
    (0.005, 0.03, 200),
    (0.003, 0.01, 200),
    (0.002, 0.003, 120),
    (0.001, 0.001, 80),
)
#: Rounds of widening the margins, and steps in each.
ROUNDS = 3
_STEPS = 50
#: Rows below this, in local lengths, are dear while margins are widened: they may not become negative.
_DEAR = 1e-3
#: How dear at first, against what a row lacks to the aim; times the second in each round after one that failed.
_PRICE = 100.0
_RISE = 10.0
#: Share of a step below which a vertex stays.
_LEAST = 1e-3


def relax(rows: Rows, weights: Floats) -> Iterator[Floats]:
    """Weights for which ever fewer tets miss, one array per stage.

    Minimised is the sum over tets of s / (1 + s / forgiven^2), with s the sum of squares of what its rows lack to the
    aim (Geman and McClure's estimator). It counts what misses by little in full and what misses by far once, so that
    what cannot be met is left to few tets; ``forgiven`` falls by stages, from where the function is convex (Blake and
    Zisserman, *Visual Reconstruction*, 1987). What dual lengths lack counts in full, by its square.
    """
    for aim, forgiven, steps in STAGES:

        def regret(values: Floats, aim: float = aim, forgiven: float = forgiven) -> tuple[float, Floats]:
            lack = np.maximum(aim - values, 0.0).reshape(-1, 4)
            squares = np.einsum("mf,mf->m", lack, lack)
            share = 1.0 / (1.0 + squares / forgiven**2)
            short = np.maximum(aim - rows.duals @ values, 0.0)
            slope = (lack * share[:, None] ** 2).ravel() + rows.duals.T @ short
            return 0.5 * float((squares * share).sum() + (short**2).sum()), -slope

        lack = np.maximum(aim - lowest(rows.at(weights)), 0.0)
        steepness = np.repeat((1.0 + (lack / forgiven) ** 2) ** -2, 4)
        weights = _descend(rows, weights, regret, steepness, steps)
        yield weights


def widen(rows: Rows, weights: Floats, aim: float) -> Iterator[Floats]:
    """Weights that keep the tets that contain their orthocenter and give them more margin, one array per round.

    Minimised is the sum of squares of what their rows lack to the ``aim``, with a price on rows and dual lengths near
    zero. Where a tet would fall below the clearance all the same, or one that misses would get worse, its vertices go
    only a part of the way, and its rows are dearer in the next round.
    """
    price = np.full(len(rows.constant), _PRICE)
    for _ in range(ROUNDS):
        before = rows.at(weights)
        kept = np.repeat(contained(before), 4)
        goal = np.where(kept, aim, -np.inf)
        dear = np.minimum(before, np.where(kept, _DEAR, CLEARANCE))

        lengths = np.minimum(rows.duals @ before, _DEAR)

        def regret(
            values: Floats, goal: Floats = goal, dear: Floats = dear, lengths: Floats = lengths
        ) -> tuple[float, Floats]:
            lack, missed = np.maximum(goal - values, 0.0), np.maximum(dear - values, 0.0)
            worse = np.maximum(lengths - rows.duals @ values, 0.0)
            value = 0.5 * float((lack**2 + price * missed**2).sum() + _PRICE * (worse**2).sum())
            return value, -(lack + price * missed + _PRICE * (rows.duals.T @ worse))

        step = _descend(rows, weights, regret, np.where(before < aim, 1.0, 0.1), _STEPS) - weights
        floors = np.where(contained(before), np.minimum(lowest(before), CLEARANCE), np.minimum(lowest(before), 0.0))
        share = np.ones(len(weights))
        fallen = first = lowest(rows.at(weights + step)) < floors
        while fallen.any():
            vertices = np.unique(rows.tets[fallen])
            share[vertices] = np.where(share[vertices] < _LEAST, 0.0, share[vertices] / 2.0)
            fallen = lowest(rows.at(weights + share * step)) < floors
        price[np.repeat(first, 4)] *= _RISE
        weights = weights + share * step
        yield weights


def _descend(rows: Rows, weights: Floats, regret: Regret, steepness: Floats, steps: int) -> Floats:
    """Weights of less regret; ``steepness``: about what its second derivative by each row is."""
    squares = rows.matrix.copy()
    squares.data **= 2
    scale = 1.0 / np.sqrt(np.maximum(squares.T @ steepness, np.finfo(float).tiny))

    def function(x: Floats) -> tuple[float, Floats]:
        value, slope = regret(rows.at(x * scale))
        return value, (rows.matrix.T @ slope) * scale

    found: Floats = minimise(function, weights / scale, steps) * scale
    return found
