"""The facets of one tet only, found without the package: generators and judges both need them."""

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]

FACETS = np.array([[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]])  #: of a positive tet, seen from outside


def boundary_of(tets: Ints) -> Ints:
    """(k, 3) those of tets (n, 4), oriented outwards for positive ones, all first facets before all second ones."""
    faces = tets[:, FACETS].swapaxes(0, 1).reshape(-1, 3)
    _, first, counts = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    outer: Ints = faces[np.sort(first[counts == 1])]
    return outer
