"""Metrics of a filter that print in a few lines."""

from collections.abc import Mapping
from typing import Any

#: Longer text is not shown in the line.
_LONGEST = 30


class ShortMetrics(dict[str, Any]):
    """A dict in all but its ``repr``, which says what there is; ``print(dict(metrics))`` prints all of it."""

    def __repr__(self) -> str:
        shown = {name: _in_short(value) for name, value in self.items()}
        told = ", ".join(f"{name} {text}" for name, text in shown.items() if text)
        more = ", ".join(name for name, text in shown.items() if not text and self[name])
        return f"<metrics: {told or 'no single numbers'}{f'; more in {more}' if more else ''}; dict(_) prints all>"


def _in_short(value: Any) -> str:
    match value:
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:.4g}"
        case int():
            return str(value)
        case str():
            return value if len(value) <= _LONGEST else ""
        case Mapping() if set(value) == {"count", "percent"}:
            return f"{value['count']} ({value['percent']:.1f} %)"
        case _:
            return ""
