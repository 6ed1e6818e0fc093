"""Kinds of cells by meshio's names: how many corners, which faces and edges; nodes are counted as meshio does.

A name ends with the number of nodes where there are more than corners: ``tetra10``, ``wedge15``.
"""

import re

#: Corners and dimension of each kind without further nodes.
_BASES = {
    "vertex": (1, 0), "line": (2, 1), "triangle": (3, 2), "quad": (4, 2),
    "tetra": (4, 3), "pyramid": (5, 3), "wedge": (6, 3), "hexahedron": (8, 3),
}  # fmt: skip
_LAGRANGE = {
    "VTK_LAGRANGE_CURVE": "line", "VTK_LAGRANGE_TRIANGLE": "triangle", "VTK_LAGRANGE_QUADRILATERAL": "quad",
    "VTK_LAGRANGE_TETRAHEDRON": "tetra", "VTK_LAGRANGE_PYRAMID": "pyramid", "VTK_LAGRANGE_WEDGE": "wedge",
    "VTK_LAGRANGE_HEXAHEDRON": "hexahedron",
}  # fmt: skip
#: The corners of each face of the kinds with a volume.
FACES = {
    "pyramid": ((0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    "wedge": ((0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "hexahedron": ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
#: The corners at the ends of each edge, in the order of the mid nodes, which follow the corners.
EDGES = {
    "line": ((0, 1),),
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "quad": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "tetra": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "pyramid": ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)),
    "wedge": ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    "hexahedron": (
        (0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7),
    ),
}  # fmt: skip
#: Kinds that have one node in the middle of each edge, and maybe more on faces and inside.
_SECOND = {
    "line3", "triangle6", "triangle7", "quad8", "quad9", "tetra10", "tetra14", "tetra15", "pyramid13", "pyramid14",
    "wedge15", "wedge18", "hexahedron20", "hexahedron24", "hexahedron27",
}  # fmt: skip


def base(kind: str) -> str:
    """The kind that has the corners alone; of an unknown kind the name itself."""
    plain = _LAGRANGE.get(kind) or re.sub(r"\d+$", "", kind)
    return plain if plain in _BASES else kind


def corners(kind: str) -> int:
    """How many corners cells of a known kind have."""
    return _BASES[base(kind)][0]


def nodes(kind: str) -> int:
    """How many nodes cells of a kind have by its name."""
    return int(kind.removeprefix(base(kind)) or corners(kind))


def dimension(kind: str) -> int:
    """Of a known kind 0 to 3, of an unknown one -1."""
    return _BASES.get(base(kind), (0, -1))[1]


def is_second_order(kind: str) -> bool:
    """Whether the nodes after the corners are one in the middle of each edge."""
    return kind in _SECOND


def second_order(kind: str) -> str:
    """The kind with the same corners and a node in the middle of each edge, and no other."""
    return kind + str(corners(kind) + len(EDGES[kind])) if kind in EDGES else kind
