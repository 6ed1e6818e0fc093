"""Colours as other libraries hold them, four columns, and as meshes do, an array each."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.adapters.meshlab.carry import COLOUR


def split(colours: NDArray[Any]) -> dict[str, NDArray[np.uint8]]:
    """``red``, ``green``, ``blue``, ``alpha`` of a table (n, 4) of bytes."""
    return dict(zip(COLOUR, np.ascontiguousarray(colours.T.astype(np.uint8)), strict=True))


def joined(data: Mapping[str, NDArray[Any]]) -> NDArray[np.uint8] | None:
    """The table (n, 4) of bytes; None unless all but ``alpha`` are there, as bytes."""
    columns = [data.get(name) for name in COLOUR]
    *colour, alpha = columns
    if any(one is None or one.dtype != np.uint8 or one.ndim != 1 for one in colour):
        return None
    full = [one for one in colour if one is not None]
    return np.column_stack([*full, np.full(len(full[0]), 255, np.uint8) if alpha is None else alpha]).astype(np.uint8)
