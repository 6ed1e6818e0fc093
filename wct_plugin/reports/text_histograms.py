"""Histograms of reports in characters, for a terminal."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wct_plugin.reports.report import BINS, TITLES, Report

_BLOCKS = " ▏▎▍▌▋▊▉█"


def text_histograms(reports: Sequence[Report], width: int = 40) -> list[tuple[str, list[str]]]:
    """Title and lines of each histogram, the reports side by side, each bar up to ``width`` characters long."""
    return [
        (
            TITLES[name],
            text_histogram(edges, [one.histograms[name] for one in reports], "°" if "angle" in name else "", width),
        )
        for name, edges in BINS.items()
    ]


def text_histogram(
    edges: NDArray[np.float64], counts: Sequence[NDArray[np.int64]], unit: str = "", width: int = 40
) -> list[str]:
    """One line per bin, from the first to the last that holds anything: lower end, and for each a bar and its count.

    ``edges`` (b + 1,), each of ``counts`` (b,); bars are in eighths of a character, the longest of each ``width`` long,
    and anything above zero shows.
    """
    filled = np.flatnonzero(np.any(counts, axis=0))
    if not len(filled):
        return []
    rows = range(int(filled[0]), int(filled[-1]) + 1)
    digits = 0 if all(float(edge).is_integer() for edge in edges) else 2
    labels = [f"{edges[k]:.{digits}f}{unit}" for k in rows]
    margin = max(map(len, labels))
    columns = [_column(one, rows, width) for one in counts]
    return [" ".join((f"{label:>{margin}}", *cells)).rstrip() for label, *cells in zip(labels, *columns, strict=True)]


def _column(counts: NDArray[np.int64], rows: range, width: int) -> list[str]:
    most = max(int(counts.max()), 1)
    digits = len(str(most))
    eighths = [math.ceil(8 * width * int(counts[k]) / most) for k in rows]
    bars = [_BLOCKS[-1] * (size // 8) + (_BLOCKS[size % 8] if size % 8 else "") for size in eighths]
    return [f"{bar:<{width}} {int(counts[k]):<{digits}}" for bar, k in zip(bars, rows, strict=True)]
