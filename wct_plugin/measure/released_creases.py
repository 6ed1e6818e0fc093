"""Creases that the search gave up: how many, how long, in words."""

from typing import TypedDict


class Released(TypedDict):
    """Creases by their angle alone that became ordinary surface, within the tolerance as all of it."""

    creases: int
    length: float  #: together, as a fraction of the surface's bounding-box diagonal


def describe(found: Released) -> str:
    """One line for the report, empty where all creases were kept."""
    if not found["creases"]:
        return ""
    what = "1 crease" if found["creases"] == 1 else f"{found['creases']} creases"
    return (
        f"{what} ({found['length']:.2g} of the diagonal long together) too close to others for well-centered tets:"
        " the surface there is within the tolerance, but no edges run along it"
    )
