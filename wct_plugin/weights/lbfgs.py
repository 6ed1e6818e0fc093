"""Minimising a smooth function of many variables: limited-memory BFGS, with the same bits whatever the thread count.

After Nocedal and Wright, *Numerical Optimization*, 2006, algorithm 7.4. SciPy's own sums by BLAS, whose order of
summation depends on how many threads there are.
"""

from collections import deque
from collections.abc import Callable

import numpy as np

from wct_plugin.types import Floats

#: Steps remembered.
_MEMORY = 10
#: Share of the decrease that the slope promises with which a step is content.
_ENOUGH = 1e-4
#: How often a step is halved before the search ends.
_HALVINGS = 20
#: Cosine between a step and the change of the gradient below which the step says nothing about curvature.
_CURVED = 1e-8


def minimise(function: Callable[[Floats], tuple[float, Floats]], start: Floats, iterations: int) -> Floats:
    """The best of ``iterations`` steps from ``start``; ``function`` gives its value and gradient.

    The first step is the negative gradient: variables are best scaled for second derivatives near 1.
    """
    x = start
    value, gradient = function(x)
    memory: deque[tuple[Floats, Floats, float]] = deque(maxlen=_MEMORY)
    for _ in range(iterations):
        direction = _direction(gradient, memory)
        slope = _dot(direction, gradient)
        length = 1.0
        for _ in range(_HALVINGS):
            step = length * direction
            new_value, new_gradient = function(x + step)
            if new_value <= value + _ENOUGH * length * slope:
                break
            length /= 2.0
        else:
            break
        change = new_gradient - gradient
        curvature = _dot(step, change)
        if curvature > _CURVED * np.sqrt(_dot(step, step) * _dot(change, change)):
            memory.append((step, change, curvature))
        x, value, gradient = x + step, new_value, new_gradient
    return x


def _direction(gradient: Floats, memory: deque[tuple[Floats, Floats, float]]) -> Floats:
    """Minus the remembered inverse Hessian times the gradient."""
    direction = -gradient
    shares = []
    for step, change, curvature in reversed(memory):
        share = _dot(step, direction) / curvature
        direction = direction - share * change
        shares.append(share)
    if memory:
        _, change, curvature = memory[-1]
        direction *= curvature / _dot(change, change)
    for (step, change, curvature), share in zip(memory, reversed(shares), strict=True):
        direction += (share - _dot(change, direction) / curvature) * step
    return direction


def _dot(a: Floats, b: Floats) -> float:
    return float(np.einsum("i,i->", a, b))  # not BLAS
