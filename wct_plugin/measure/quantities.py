"""A volume, area or length before and after a mesh was made anew."""

from typing import TypedDict

import numpy as np


class Quantity(TypedDict):
    """How much of something there was and is; ``change`` is a fraction of before."""

    before: float
    after: float
    change: float


def quantity(before: float, after: float) -> Quantity:
    """Both with the change; infinite where there was nothing before."""
    change = after / before - 1.0 if before else (0.0 if after == before else np.inf)
    return {"before": before, "after": after, "change": float(change)}
