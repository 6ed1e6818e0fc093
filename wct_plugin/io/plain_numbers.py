"""Texts of nothing but numbers, as an array."""

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError


def parse(text: bytes, dtype: Any = np.float64) -> NDArray[Any]:
    """The numbers of the text. Raises :class:`InputError` where something else stands among them."""
    with warnings.catch_warnings():
        warnings.filterwarnings("error", category=DeprecationWarning)  # NumPy only deprecates what is no number
        try:
            return np.fromstring(text.decode("ascii"), dtype, sep=" ") if text.strip() else np.empty(0, dtype)
        except (DeprecationWarning, UnicodeDecodeError, ValueError):
            wanted = "whole numbers" if np.dtype(dtype).kind in "iu" else "numbers"
            raise InputError(f"has something among its {wanted} that is none: {_culprit(text, dtype)!r}") from None


def _culprit(text: bytes, dtype: Any) -> str:
    """The first word that is no number, for the message."""
    convert = int if np.dtype(dtype).kind in "iu" else float
    for word in text.split():
        try:
            convert(word)
        except ValueError:
            return word.decode("ascii", "replace")[:40]
    return ""
