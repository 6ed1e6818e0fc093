"""gmsh, initialized and quiet, and the model that most of the tests of formats have."""

from collections.abc import Iterator
from contextlib import contextmanager

import gmsh


@contextmanager
def gmsh_session() -> Iterator[None]:
    """The body has gmsh to itself."""
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        yield
    finally:
        gmsh.finalize()


def add_two_boxes(second: float = 1.0) -> None:
    """Volumes 1 and 2: the unit cube, and a box behind it of length ``second``; they share a face."""
    boxes = [(3, gmsh.model.occ.addBox(x, 0, 0, length, 1, 1)) for x, length in ((0, 1), (1, second))]
    gmsh.model.occ.fragment(boxes[:1], boxes[1:])
    gmsh.model.occ.synchronize()
