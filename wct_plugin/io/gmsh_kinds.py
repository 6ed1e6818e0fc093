"""gmsh's kinds of cells by its numbers."""

from typing import NamedTuple

from wct_plugin.errors import InputError


class Kind(NamedTuple):
    """A kind of cell."""

    name: str  #: meshio's
    nodes: int


KINDS = {
    1: Kind("line", 2),
    2: Kind("triangle", 3),
    3: Kind("quad", 4),
    4: Kind("tetra", 4),
    5: Kind("hexahedron", 8),
    6: Kind("wedge", 6),
    7: Kind("pyramid", 5),
    8: Kind("line3", 3),
    9: Kind("triangle6", 6),
    10: Kind("quad9", 9),
    11: Kind("tetra10", 10),
    12: Kind("hexahedron27", 27),
    13: Kind("wedge18", 18),
    14: Kind("pyramid14", 14),
    15: Kind("vertex", 1),
    16: Kind("quad8", 8),
    17: Kind("hexahedron20", 20),
    18: Kind("wedge15", 15),
    19: Kind("pyramid13", 13),
    21: Kind("triangle10", 10),
    23: Kind("triangle15", 15),
    25: Kind("triangle21", 21),
    26: Kind("line4", 4),
    27: Kind("line5", 5),
    28: Kind("line6", 6),
    29: Kind("tetra20", 20),
    30: Kind("tetra35", 35),
    31: Kind("tetra56", 56),
    36: Kind("quad16", 16),
    37: Kind("quad25", 25),
    38: Kind("quad36", 36),
    90: Kind("wedge40", 40),
    91: Kind("wedge75", 75),
    92: Kind("hexahedron64", 64),
    93: Kind("hexahedron125", 125),
}


def kind_of(number: int) -> Kind:
    """The kind of a number; :class:`InputError` where there is none that is known."""
    if number not in KINDS:
        raise InputError(f"has elements of type {number}, which is none of gmsh's that are known")
    return KINDS[number]
