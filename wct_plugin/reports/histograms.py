"""Histograms as SVG that goes into a page: one panel per mesh, one above the other on one scale; a scale of colours."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from wct_plugin.reports.colour_scales import HEIGHT, OBTUSE, Stops, hexadecimal
from wct_plugin.reports.html_elements import Html, details, table

_WIDTH, _LEFT, _RIGHT = 460.0, 52.0, 22.0
_PANEL, _LINE, _GAP, _FOOT = 88.0, 19.0, 12.0, 38.0
#: So many characters fit the width, on a phone's screen too.
_CHARACTERS = 44
#: Words stand over the highest bar.
_ROOM = 1.2
#: Longer words below a bar end there, or they would be cut off at its end.
_SHORT = 5
#: What is not empty is seen.
_LEAST = 1.5


@dataclass(frozen=True)
class Series:
    """One mesh's counts (b,), and what is said of them in a few words."""

    name: str
    counts: NDArray[np.int64]
    note: str

    @property
    def percent(self) -> NDArray[np.float64]:
        """Of its own whole (b,)."""
        out: NDArray[np.float64] = 100.0 * self.counts / max(int(self.counts.sum()), 1)
        return out


@dataclass(frozen=True)
class Axis:
    """What is measured: bin edges (b + 1,), the unit behind a number, what is counted.

    ``line``: a value to mark, with the words to its left and right; ``bad``: the side of it that misses, -1 or 1, 0 for
    neither. ``open_end``: the last bin holds all above it too.
    """

    title: str
    edges: NDArray[np.float64]
    unit: str
    counted: str
    line: float | None = None
    words: tuple[str, str] = ("", "")
    bad: int = 0
    open_end: bool = False

    def say(self, value: float) -> str:
        """A number on the axis."""
        open_end = "≥ " if self.open_end and value == self.edges[-1] else ""
        return f"{open_end}{value:g}{self.unit}"

    def span(self, k: int) -> str:
        """Bin ``k`` in words."""
        low, high = (f"{value:.4g}{self.unit}" for value in self.edges[k : k + 2])
        return f"{low} or more" if self.open_end and k == len(self.edges) - 2 else f"{low} to {high}"

    def misses(self, k: int) -> bool:
        """Whether bin ``k`` is on the bad side."""
        return self.line is not None and self.bad * ((self.edges[k] + self.edges[k + 1]) / 2 - self.line) > 0


def histogram(axis: Axis, series: Sequence[Series]) -> Html:
    """A figure with its numbers folded away below."""
    filled = np.flatnonzero(np.any([one.counts for one in series], axis=0))
    first, last = _shown(axis, int(filled[0]), int(filled[-1]))
    most = _ROOM * max(float(one.percent.max()) for one in series)
    scale = _Scale(float(axis.edges[first]), float(axis.edges[last + 1]), most)
    heads = [_head(one) for one in series]
    name = _LINE * max(map(len, heads)) + 3.0
    panels = [
        _panel(axis, one, head, scale, k * (name + _PANEL + _GAP) + name, range(first, last + 1))
        for k, (one, head) in enumerate(zip(series, heads, strict=True))
    ]
    bottom = len(series) * (name + _PANEL + _GAP) - _GAP
    ticks = "".join(
        f'<text x="{scale.x(value):.1f}" y="{bottom + 16:.1f}" text-anchor="middle">{escape(axis.say(value))}</text>'
        for value in _ticks(scale.low, scale.high, 6)
    )
    said = "; ".join(f"{one.name}: {one.note}" for one in series)
    height = f"{bottom + _FOOT:.1f}"
    drawing = (
        f'<svg viewBox="0 0 {_WIDTH:g} {height}" width="{_WIDTH:g}" height="{height}" role="img" '
        f'aria-label="{escape(f"Histogram. {axis.title}. {said}")}">{"".join(panels)}{ticks}'
        f'<text x="{(_LEFT + _WIDTH - _RIGHT) / 2:.1f}" y="{bottom + 33:.1f}" text-anchor="middle">'
        f"{escape(axis.title)}</text></svg>"
    )
    rows = [(axis.span(k), *(str(int(one.counts[k])) for one in series)) for k in range(first, last + 1)]
    numbers = table(f"{axis.title}: {axis.counted}", ("", *(one.name for one in series)), rows)
    return Html(f"<figure>{drawing}{details('The numbers', numbers)}</figure>")


def colour_scale() -> Html:
    """What the colours of :func:`wct_plugin.reports.pictures.pictures` stand for."""
    scale = _Scale(HEIGHT[0][0], HEIGHT[-1][0], 1.0)
    middle = scale.x(0.0)
    marks = ((-1.0, "−1"), (-0.5, "−0.5"), (0.0, "0"), (1.0 / 3.0, "⅓"))
    said = (
        "Colour: the smallest h/R of a tet, below 0 where its circumcenter is outside; violet where it is inside, but "
        "a triangle of the tet is not acute."
    )
    more = (
        f'<line x1="{middle:.1f}" x2="{middle:.1f}" y1="18" y2="40" stroke="var(--ink)"/>'
        f'<text x="{middle - 6:.1f}" y="14" text-anchor="end">circumcenter outside</text>'
        f'<text x="{middle + 6:.1f}" y="14">inside</text>'
        f'<rect x="{_LEFT:g}" y="3" width="14" height="14" fill="{hexadecimal(OBTUSE)}"/>'
        f'<text x="{_LEFT + 20:g}" y="14">not acute</text>'
    )
    return _colour_bar("min-height", HEIGHT, marks, said, more)


def deviation_scale(stops: Stops, tolerance: float | None) -> Html:
    """What the colours of :func:`wct_plugin.reports.pictures.deviation_pictures` stand for."""
    said = "Colour: distance from the reference, as a fraction of the bounding box's diagonal"
    beyond = tolerance is not None and tolerance < stops[-1][0]
    if tolerance is not None:
        said += f"; the tolerance is {tolerance:.2e}" + (", orange and brown are beyond it" if beyond else "")
    marks = [(stops[0][0], "0"), (stops[-1][0], f"{stops[-1][0]:.2e}")]
    return _colour_bar("deviation", stops, marks, f"{said}.")


def _colour_bar(name: str, stops: Stops, marks: Sequence[tuple[float, str]], said: str, more: str = "") -> Html:
    """A bar with the colours of ``stops``, a word below each of the ``marks``, ``more`` drawn above it."""
    scale = _Scale(stops[0][0], stops[-1][0], 1.0)
    low, high = scale.x(scale.low), scale.x(scale.high)
    anchors = "".join(
        f'<stop offset="{(scale.x(value) - low) / (high - low):.4f}" stop-color="{hexadecimal(colour)}"/>'
        for value, colour in stops
    )
    bar = (
        f'<defs><linearGradient id="{name}">{anchors}</linearGradient></defs>'
        f'<rect x="{low:.1f}" y="22" width="{high - low:.1f}" height="14" fill="url(#{name})"/>'
    )
    words = "".join(
        f'<text x="{scale.x(value):.1f}" y="51" text-anchor="{"end" if len(word) > _SHORT else "middle"}">{word}</text>'
        for value, word in marks
    )
    drawing = (
        f'<svg viewBox="0 0 {_WIDTH:g} 56" width="{_WIDTH:g}" height="56" role="img" aria-label="{said}">{bar}{words}'
        f"{more}</svg>"
    )
    return Html(f"<figure>{drawing}<figcaption>{said}</figcaption></figure>")


def _shown(axis: Axis, first: int, last: int) -> tuple[int, int]:
    """The bins that hold anything, and those up to the line with one on either side."""
    if axis.line is not None:
        at = int(np.searchsorted(axis.edges, axis.line))
        first, last = min(first, at - 1), max(last, at)
    return max(first, 0), min(last, len(axis.edges) - 2)


@dataclass(frozen=True)
class _Scale:
    low: float
    high: float
    most: float  #: percent

    def x(self, value: float) -> float:
        return _LEFT + (_WIDTH - _LEFT - _RIGHT) * (value - self.low) / (self.high - self.low)

    def height(self, percent: float) -> float:
        return max(_PANEL * percent / self.most, _LEAST) if percent else 0.0


def _head(one: Series) -> list[str]:
    """What stands over a panel, in lines that fit."""
    line = f"{one.name}: {one.note}"
    if len(line) <= _CHARACTERS:
        return [line]
    half = _CHARACTERS // 2 - 1
    return [one.name if len(one.name) <= _CHARACTERS else f"{one.name[:half]}…{one.name[-half:]}", one.note]


def _panel(axis: Axis, one: Series, head: Sequence[str], scale: _Scale, top: float, shown: range) -> str:
    base, start, end = top + _PANEL, _LEFT, _WIDTH - _RIGHT
    share = one.percent
    parts = [
        f'<text x="{start:g}" y="{top - 6 - _LINE * (len(head) - 1 - k):.1f}">{escape(line)}</text>'
        for k, line in enumerate(head)
    ]
    for value in _ticks(0.0, scale.most, 3):
        y = base - _PANEL * value / scale.most
        parts.append(
            f'<line x1="{start:g}" x2="{end:g}" y1="{y:.1f}" y2="{y:.1f}" stroke="var(--line)"/>'
            f'<text x="{start - 5:g}" y="{y + 4:.1f}" text-anchor="end">{value:g} %</text>'
        )
    for k in shown:
        if not one.counts[k]:
            continue
        x, right, height = scale.x(float(axis.edges[k])), scale.x(float(axis.edges[k + 1])), scale.height(share[k])
        colour = "var(--bar-bad)" if axis.misses(k) else "var(--bar)"
        parts.append(
            f'<rect x="{x + 0.4:.2f}" y="{base - height:.2f}" width="{max(right - x - 0.8, 0.5):.2f}" '
            f'height="{height:.2f}" fill="{colour}"><title>{axis.span(k)}: {int(one.counts[k])} {axis.counted} '
            f"({share[k]:.3g} %)</title></rect>"
        )
    if axis.line is not None:
        parts.append(_line(axis, scale.x(axis.line), top, base))
    return "".join(parts)


def _line(axis: Axis, x: float, top: float, base: float) -> str:
    words = "".join(
        f'<text x="{x + side * 5:.1f}" y="{top + 10:.1f}" text-anchor="{anchor}">{escape(word)}</text>'
        for side, anchor, word in ((-1, "end", axis.words[0]), (1, "start", axis.words[1]))
        if word
    )
    return (
        f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{top:.1f}" y2="{base:.1f}" stroke="var(--ink)" stroke-dasharray="4 3"/>'
        + words
    )


def _ticks(low: float, high: float, most: int) -> list[float]:
    """Round numbers from ``low`` to ``high``, about ``most`` of them."""
    rough = (high - low) / most
    unit = 10.0 ** math.floor(math.log10(rough))
    step = next(unit * factor for factor in (1.0, 2.0, 2.5, 5.0, 10.0) if unit * factor >= rough)
    start, end = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(k * step, 10) + 0.0 for k in range(start, end + 1)]
