"""Abaqus's and CalculiX's types of elements as kinds of cells: by the family of a type and how many nodes it says."""

import re
from typing import NamedTuple

_SOLIDS = {
    "4": "tetra", "5": "pyramid", "6": "wedge", "8": "hexahedron", "10": "tetra10", "13": "pyramid13", "15": "wedge15",
    "20": "hexahedron20", "27": "hexahedron27",
}  # fmt: skip
_FACES = {"3": "triangle", "4": "quad", "6": "triangle6", "8": "quad8", "9": "quad9"}
_LINES = {"2": "line", "3": "line3"}
_BEAMS = {"1": "line", "2": "line3", "3": "line"}  # what a beam's name says is the degree; cubic ones have two nodes
#: The nodes of each kind.
_NODES = {
    "line": 2, "line3": 3, "triangle": 3, "triangle6": 6, "quad": 4, "quad8": 8, "quad9": 9, "tetra": 4, "tetra10": 10,
    "pyramid": 5, "pyramid13": 13, "wedge": 6, "wedge15": 15, "hexahedron": 8, "hexahedron20": 20, "hexahedron27": 27,
}  # fmt: skip
_FAMILIES = (
    (r"(?:C|DC|DCC|AC|EMC|Q|F|FC|COH|CIN|GK|PC)3D(27|20|15|13|10|8|6|5|4)[A-Z]*", _SOLIDS),
    (r"SC(6|8)R[A-Z]*|CSS(8)", _SOLIDS),
    (r"STRI(3)|STRI(6)5", _FACES),
    (r"D?S(3|4|6|8|9)(?:R|RS|RSW|R5|S|T|RT|5)?", _FACES),
    (r"(?:M|R|SFM)3D(3|4|6|8|9)[A-Z]*", _FACES),
    (r"(?:CPS|CPE|CPEG|CAX|CGAX|DCAX|DC2D|DCC2D|DCCAX|AC2D|ACAX|COH2D|WARP2D|EMC2D)(3|4|6|8)[A-Z]*", _FACES),
    (r"T[23]D(2|3)[A-Z]*|(?:DC|AC|DCC)1D(2|3)[A-Z]*|R2D(2)|RB[23]D(2)|RAX(2)", _LINES),
    (r"(?:B2|B3|PIPE2|PIPE3|ELBOW3|D?SAX)(1|2|3)[A-Z]*", _BEAMS),
)


class Element(NamedTuple):
    """A kind of cell and its nodes, which stand in VTK's order."""

    kind: str
    nodes: int


def element_of(type_: str) -> Element | None:
    """What the elements of a type, in capitals, are; None for those that are no cells, as masses and springs."""
    for pattern, kinds in _FAMILIES:
        found = re.fullmatch(pattern, type_)
        if found:
            kind = kinds[next(size for size in found.groups() if size)]
            return Element(kind, _NODES[kind])
    return None
