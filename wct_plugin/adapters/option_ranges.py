"""Checks of a mesher's numbers for those who call its adapter from Python, without a filter's declaration."""

import math

from wct_plugin.errors import OptionError


def check_between(name: str, value: float, high: float) -> None:
    """Raise :class:`OptionError` unless ``value`` is above 0 and at most ``high``."""
    if not 0 < value <= high:  # also false for NaN
        raise OptionError(f"{name} is {value}; allowed is above 0, at most {high:g}")


def check_at_least(name: str, value: float, low: float) -> None:
    """Raise :class:`OptionError` unless ``value`` is finite and at least ``low``."""
    if not low <= value < math.inf:
        raise OptionError(f"{name} is {value}; allowed is at least {low:g}")


def check_limit(name: str, value: float | None, unit: str) -> None:
    """Raise :class:`OptionError` unless ``value`` is above 0 or None."""
    if value is not None and not value > 0:
        raise OptionError(f"{name} is {value}; allowed is a number of {unit} above 0, or None")
