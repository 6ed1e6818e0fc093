"""Minima known in closed form."""

import numpy as np
import pytest

from wct_plugin.weights.lbfgs import minimise


def rosenbrock(x):
    """A thousandth of it: second derivatives near 1."""
    one, two = x
    value = (1 - one) ** 2 + 100 * (two - one**2) ** 2
    return value / 1e3, np.array([-2 * (1 - one) - 400 * one * (two - one**2), 200 * (two - one**2)]) / 1e3


def test_a_curved_valley():
    assert minimise(rosenbrock, np.array([-1.2, 1.0]), 100) == pytest.approx([1.0, 1.0], abs=1e-5)


def test_a_quadratic_takes_far_fewer_steps_than_steepest_descent():
    """Condition 1000 and 200 variables: steepest descent needs thousands of steps, this a few times its memory."""
    steepness = np.geomspace(1e-3, 1.0, 200)
    goal = np.cos(np.arange(200.0))

    def function(x):
        return 0.5 * float((steepness * (x - goal) ** 2).sum()), steepness * (x - goal)

    assert np.abs(minimise(function, np.zeros(200), 150) - goal).max() < 1e-2


def test_never_worse_where_the_function_has_no_minimum_or_a_kink():
    for function in (lambda x: (-float(x.sum()), -np.ones(3)), lambda x: (float(np.abs(x).sum()), np.sign(x))):
        start = np.array([0.3, -0.2, 0.7])
        values = [function(minimise(function, start, steps))[0] for steps in range(6)]
        assert values == sorted(values, reverse=True)
        assert values[-1] < values[0] == function(start)[0]


def test_at_a_minimum_nothing_moves():
    start = np.array([1.0, 1.0])
    assert np.array_equal(minimise(rosenbrock, start, 5), start)
