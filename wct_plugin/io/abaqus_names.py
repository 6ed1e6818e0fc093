"""What Abaqus files say by names: types of elements, and which sets stand for tags, which Abaqus does not have.

Elements of a further type of their kind are a set, ``abaqus:R3D3``, so that it goes with them through filters. A set
that stands for a tag is named by the tag, and a comment has the number.
"""

import re

import numpy as np

from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.text_lines import decoded, whole_number

#: What the names of sets begin with that hold the elements of a type.
TYPE_SET = "abaqus:"
#: The usual type of each kind of cell.
USUAL = {
    "tetra": "C3D4",
    "tetra10": "C3D10",
    "triangle": "S3",
    "triangle6": "STRI65",
    "line": "B31",
    "line3": "B32",
    "hexahedron": "C3D8",
    "hexahedron20": "C3D20",
    "wedge": "C3D6",
    "wedge15": "C3D15",
    "quad": "S4",
    "quad8": "S8R",
}

_TAG = re.compile(rb"^\*\* tag (-?\d+) of dimension (\d) is (elset and set|elset) ([^\r\n]+?)\s*$", re.MULTILINE)


def tag_comment(name: str, tag: int, dimension: int, *, is_set: bool) -> str:
    """The line that has the number of a tag; ``is_set``: whether the tag's cells are a set of that name by themselves.

    Other programs take it for a comment.
    """
    return f"** tag {tag} of dimension {dimension} is {'elset and set' if is_set else 'elset'} {name}\n"


def put_tags(raw: RawMesh, text: bytes) -> None:
    """Tell the mesh which of its sets stand for tags, and what these are called."""
    for tag, dimension, what, name in _TAG.findall(text):
        called = decoded(name)
        number = whole_number(tag, f"as tag of {called!r}")
        raw.field_data[called] = np.array([number, int(dimension)])
        raw.tag_sets[called] = what == b"elset and set"


def fits(name: str) -> bool:
    """Whether a set can have this name."""
    return bool(name) and not set(name) & set(',=*\n"') and name == name.strip()
