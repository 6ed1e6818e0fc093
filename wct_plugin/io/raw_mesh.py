"""What a file holds, before anybody has said what it means: the one form that all readers of volume formats give.

Kinds of cells have meshio's names (``tetra``, ``triangle``, ``line``, ``vertex``, ``tetra10``, ``wedge``, ...), which
are those that its users know.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

from wct_plugin.types import Floats, Ints


@dataclass(frozen=True, eq=False)
class RawBlock:
    """Cells of one kind, in the order of the file."""

    type: str
    data: Ints  #: (k, d) rows of ``points``

    def __len__(self) -> int:
        return len(self.data)


@dataclass(eq=False)
class RawMesh:
    """Points, blocks of cells, and what the file says of them.

    Per-cell arrays and sets are lists with an entry for each block; None where the file has nothing for the
    block. Sets hold row numbers within their block.
    """

    points: Floats  #: (n, 3)
    cells: list[RawBlock]
    point_data: dict[str, NDArray[Any]] = field(default_factory=dict)
    cell_data: dict[str, list[NDArray[Any] | None]] = field(default_factory=dict)
    point_sets: dict[str, Ints] = field(default_factory=dict)
    cell_sets: dict[str, list[Ints | None]] = field(default_factory=dict)
    field_data: dict[str, NDArray[Any]] = field(default_factory=dict)  #: names of tags: tag, dimension
    #: Abaqus: sets that stand for the tag of their name in ``field_data``, and whether they are sets by themselves too.
    tag_sets: dict[str, bool] = field(default_factory=dict)
    periodic: list[Any] = field(default_factory=list)  #: gmsh: dimension, tags, affine map, pairs of points
    #: Abaqus: the type of the elements of a kind of cell (``{"tetra": "C3D4", "triangle": "S3"}``); where there are
    #: several of a kind, the first; elements of the others are in a set each.
    element_types: Mapping[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)  #: what was done to what the file holds, a line each, for the user
