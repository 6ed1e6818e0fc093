"""What the colours of a report's pictures and of its 3D view stand for.

A scale is given by its anchors: a value and the sRGB there, linear between. Two anchors at one value are a step; the
value itself is below it. All that misses is darker than all that does not, whatever the eye or the printer.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wct_plugin.types import Floats

Rgb = tuple[float, float, float]
Stops = Sequence[tuple[float, Rgb]]

_DARKEST, _DARK, _PALE, _LIGHT = (0.42, 0.13, 0.01), (0.86, 0.31, 0.03), (0.88, 0.94, 0.98), (0.62, 0.79, 0.91)

#: Of the smallest h/R of a tet.
HEIGHT: Stops = ((-1.0, _DARKEST), (0.0, _DARK), (0.0, _PALE), (1.0 / 3.0, _LIGHT))
#: Of the largest face angle of a tet, in degrees.
ANGLE: Stops = ((60.0, _LIGHT), (90.0, _PALE), (90.0, _DARK), (180.0, _DARKEST))
#: A tet that contains its circumcenter and has an obtuse triangle.
OBTUSE: Rgb = (0.48, 0.32, 0.67)
#: Of regions, one after the other; they differ for colour-blind eyes too.
REGIONS: Sequence[Rgb] = (
    (0.34, 0.71, 0.91), (0.90, 0.62, 0.0), (0.0, 0.62, 0.45), (0.80, 0.47, 0.65), (0.94, 0.89, 0.26), (0.0, 0.45, 0.70),
    (0.84, 0.37, 0.0), (0.60, 0.60, 0.60),
)  # fmt: skip


def deviation(most: float, tolerance: float | None) -> Stops:
    """Of distances up to ``most``; what is beyond the tolerance stands out, if there is one."""
    if tolerance is None or most <= tolerance:
        return ((0.0, _PALE), (tolerance or most, (0.15, 0.40, 0.65)))
    return ((0.0, _PALE), (tolerance, (0.35, 0.58, 0.80)), (tolerance, _DARK), (most, _DARKEST))


def colours(values: Floats, stops: Stops = HEIGHT) -> Floats:
    """(k, 3) the colour of each value (k,), the first one's where it is not a number."""
    at = np.array([value for value, _ in stops])
    at[1:][np.diff(at) == 0.0] = np.nextafter(at[1:][np.diff(at) == 0.0], np.inf)
    rgb = np.array([colour for _, colour in stops])
    values = np.nan_to_num(values, nan=stops[0][0])
    out: Floats = np.stack([np.interp(values, at, rgb[:, k]) for k in range(3)], axis=1)
    return out


def hexadecimal(colour: Rgb | NDArray[np.float64]) -> str:
    """A colour as pages have it."""
    return "#" + "".join(f"{round(255 * float(part)):02x}" for part in colour)
