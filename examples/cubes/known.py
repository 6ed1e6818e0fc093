"""Roughly where the smallest known cubes have their vertices, in the unit cube, without its corners.

Too rough to be well-centered: descent and polishing lead back to that.
"""

import numpy as np

from cubes.symmetry import Floats

_TEXT = {
    "3wc 30 tets": """
        0 0.6 0.5   1 0.5 0.3   0.4 1 0.5   0.5 0.4 1   0.6 0.5 0   0.5 0 0.7   0.3 0 1   1 0.7 0
        0 1 0.3
    """,
    "cwc 84 tets": """
        0.5 0.28 0.2   0.5 0.73 0.2   0.5 0.5 0.21   0 0.41 0.22   1 0.41 0.22   0 0.59 0.22
        1 0.59 0.22   0.4 0 0.2   0.6 0 0.2   0.4 1 0.2   0.6 1 0.2   0.58 0.3 0   0.42 0.31 0
        0.58 0.7 0   0.41 0.7 0   0.25 0.25 1   0.74 0.25 1   0.25 0.75 1   0.74 0.75 1   0.5 0 0
        0.5 1 0   0.5 0 1   0.5 1 1   0 0.49 0   1 0.48 0   0 0.5 1   1 0.5 1
    """,
    "cwc 87 tets": """
        0.51 0.49 0.2   0 0.41 0.2   1 0.4 0.2   0 0.6 0.2   1 0.6 0.2   0.13 0.47 0   0.85 0.54 0
        0.13 0.54 0   0.85 0.45 0   0.21 0.69 1   0.75 0.68 1   0.27 0.33 1   0.76 0.3 1   0.6 1 0.2
        0.42 1 0.19   0.6 0 0.19   0.43 0 0.19   0.59 0.5 0   0.51 0 0   0.51 1 0   0.52 0 1   0.49 1 1
        0 0.51 0   1 0.5 0   0 0.55 1   1 0.49 1   0.12 0.5 0.19   0.86 0.5 0.19
    """,
}


def sketches(goal: str) -> list[Floats]:
    """Points (n, 3) of each that is known for the goal."""
    return [np.array(text.split(), float).reshape(-1, 3) for name, text in _TEXT.items() if name.startswith(goal)]
