"""The planes of the surface that was followed: how many, how far they were put right, in words."""

from typing import TypedDict


class PlaneCount(TypedDict):
    """What the planes of a surface are, as metrics."""

    patches: int  #: of the surface that is followed
    planes: int  #: of these, how many are planes
    axis: int  #: of these, how many have one coordinate
    moved: float  #: farthest that a vertex was put right, as a fraction of the diagonal


def describe(count: PlaneCount) -> str:
    """One line for the report, empty where nothing is plane."""
    if not count["planes"]:
        return ""
    one = count["patches"] == 1
    line = f"{count['planes']} of {count['patches']} patch{'' if one else 'es'} of the surface"
    line += f" {'is a plane' if count['planes'] == 1 else 'are planes'}, {count['axis']} of one coordinate"
    return line + (f"; put right by up to {count['moved']:.1e} of the diagonal" if count["moved"] > 1e-15 else "")
