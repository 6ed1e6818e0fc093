"""What the work on several parts of a mesh amounts to."""

from collections.abc import Mapping, Sequence
from typing import Any

from wct_plugin.types import Metrics


def together(works: Sequence[Mapping[str, Any]], shares: Sequence[float]) -> Metrics:
    """The metrics of the parts as those of the whole; ``shares``: each part's diagonal, as a fraction of the whole's.

    Counts are summed, what is smallest or farthest of any part is kept, and fractions become those of the whole.
    """
    out: Metrics = {"stopped": any(one["stopped"] for one in works), "kept": all(one["kept"] for one in works)}
    for name in ("passes", "kicks", "evaluations"):
        if name in works[0]:
            out[name] = sum(one[name] for one in works)
    if "released" not in works[0]:
        return out
    out["exhausted"] = any(one["exhausted"] for one in works)
    creases = sum(one["released"]["creases"] for one in works)
    length = sum(one["released"]["length"] * share for one, share in zip(works, shares, strict=True))
    out["released"] = {"creases": creases, "length": length}
    estimates = [one["estimate"] for one in works if one["estimate"] is not None]
    out["estimate"] = sum(estimates) if estimates else None
    needed = [one["needed"] for one in works if one["needed"] is not None]
    out["needed"] = sum(needed) if needed else None
    counts = [(one["planes"], share) for one, share in zip(works, shares, strict=True) if one["planes"]]
    out["planes"] = (
        {name: sum(one[name] for one, _ in counts) for name in ("patches", "planes", "axis")}
        | {"moved": max(one["moved"] * share for one, share in counts)}
        if counts
        else None
    )
    least = [
        {**one["local_tolerance"], "least": one["local_tolerance"]["least"] * share}
        for one, share in zip(works, shares, strict=True)
        if one["local_tolerance"]
    ]
    out["local_tolerance"] = min(least, key=lambda one: float(one["least"])) if least else None
    return out
