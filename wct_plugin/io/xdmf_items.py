"""The arrays of an XDMF file, and the references from one of its elements to another."""

import re
import xml.etree.ElementTree as ET
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import hdf5, read_limit
from wct_plugin.io.companions import companion
from wct_plugin.io.text_lines import numbers_of_type, whole_number

_KINDS = {"int": "i", "uint": "u", "float": "f", "char": "i", "uchar": "u", "short": "i", "ushort": "u"}
#: Bytes of a number where the file does not say.
_BYTES = {"int": 4, "uint": 4, "float": 4, "char": 1, "uchar": 1, "short": 2, "ushort": 2}
_STEP = re.compile(r"(?P<name>\*|\w+)(?P<conditions>(\[[^]]*\])*)")
#: A step goes on to the next slash that is in no brackets; quotes in these may hold anything.
_STEPS = re.compile(r"(?:[^/\[]|\[(?:[^]'\"]|'[^']*'|\"[^\"]*\")*+\])++")
_CONDITION = re.compile(
    r"\[\s*(?:(?P<place>\d+)|@(?P<key>\w+)\s*=\s*(?P<q>[\"'])(?P<value>.*?)(?P=q)|(?P<self>self::.*?))\s*\]"
)


class XdmfFile:
    """An XDMF file with the files of numbers that lie beside or below it."""

    def __init__(self, path: Path, root: ET.Element) -> None:
        self.path, self.root = path, root

    def find(self, path: str) -> list[ET.Element]:
        """The elements at a path such as ``/Xdmf/Domain/Grid[@Name='mesh']/*[self::Topology or self::Geometry]``."""
        here = [self.root]
        found = re.fullmatch(r"(?:xpointer|element)\((.*)\)", path.strip())
        path = found[1] if found else path.strip()
        if path.startswith("//"):
            here, path = [self.root, *self.root.iter()], path[2:]
        elif path.startswith("/"):
            first, _, path = path[1:].partition("/")
            if first not in (self.root.tag, "*"):
                return []
        for step in _steps(path):
            here = _follow(here, step)
        return here

    def resolved(self, element: ET.Element) -> ET.Element:
        """The element, or the one that it refers to by ``Reference``."""
        seen: list[ET.Element] = []
        while (reference := element.get("Reference")) is not None and element not in seen:
            seen.append(element)
            path = (element.text or "") if reference.strip().upper() == "XML" else reference
            found = self.find(path)
            if not found:
                raise InputError(f"refers to {path.strip()!r}, where there is nothing")
            element = found[0]
        if element in seen:
            raise InputError(f"has a {element.tag} that refers to itself")
        return element

    def children(self, grid: ET.Element) -> list[ET.Element]:
        """The elements in a grid, with what it includes from elsewhere in the file in its place."""
        made = []
        for child in grid:
            if child.tag != "include":
                made.append(self.resolved(child))
                continue
            if child.get("href"):
                raise InputError(f"includes the file {child.get('href')!r}; allowed is what the file itself holds")
            found = self.find(child.get("xpointer", ""))
            if not found:
                raise InputError(f"includes {child.get('xpointer')!r}, where there is nothing")
            made += [self.resolved(element) for element in found]
        return made

    def values(self, item: ET.Element) -> NDArray[Any]:
        """The numbers of a ``DataItem``, in its shape and this machine's byte order."""
        item = self.resolved(item)
        kind = item.get("ItemType", "Uniform")
        if kind == "HyperSlab":
            return self._slab(item)
        if kind != "Uniform":
            raise InputError(f"has a DataItem of ItemType {kind!r}; allowed are Uniform and HyperSlab")
        text = (item.text or "").strip()
        match item.get("Format", "XML").upper():
            case "HDF":
                array = self._from_hdf(text)
            case "XML":
                dtype = _dtype(item)
                array = numbers_of_type(text.encode(), dtype)
                read_limit.claim(array.nbytes, "a DataItem")
            case "BINARY":
                array = self._from_bytes(text, item)
            case other:
                raise InputError(f"has a DataItem of Format {other!r}; allowed are HDF, XML and Binary")
        shape = _shape(item)
        if shape and prod(shape) != array.size:
            raise InputError(f"has a DataItem of {array.size} numbers but announces {' x '.join(map(str, shape))}")
        return array.reshape(shape or array.shape)

    def _from_hdf(self, text: str) -> NDArray[Any]:
        name, colon, inside = text.rpartition(":")
        if not colon:
            raise InputError(f"has the DataItem {text[:60]!r}; expected FILE:/PATH")
        path = companion(self.path, name)
        with hdf5.opened(path, links=True) as file:
            if hdf5.leads_out(file, inside):
                raise InputError(f"names {inside!r} in {name}, which is kept in another file")
            if inside not in file:
                raise InputError(f"names {inside!r} in {name}, where there is nothing")
            array = hdf5.array(file, inside)
        return array.astype(array.dtype.newbyteorder("="))

    def _from_bytes(self, text: str, item: ET.Element) -> NDArray[Any]:
        order: Any = {"Big": ">", "Little": "<"}.get(item.get("Endian", ""), "=")
        dtype = _dtype(item).newbyteorder(order)
        path = companion(self.path, text)
        with path.open("rb") as file:
            file.seek(max(whole_number(item.get("Seek", "0"), "Seek"), 0))
            size = min(prod(_shape(item)) * dtype.itemsize, path.stat().st_size)
            read_limit.claim(size, "a DataItem")
            content = file.read(size)
        array = np.frombuffer(content[: len(content) // dtype.itemsize * dtype.itemsize], dtype)
        return array.astype(dtype.newbyteorder("="))

    def _slab(self, item: ET.Element) -> NDArray[Any]:
        """A part of an array: start, stride and count along each axis."""
        items = item.findall("DataItem")
        if len(items) != 2:
            raise InputError(f"has a HyperSlab of {len(items)} DataItems; expected what is taken, and of what")
        array, chosen = self.values(items[1]), self.values(items[0])
        if chosen.size % 3 or chosen.dtype.kind not in "iu":
            raise InputError(f"has a HyperSlab of {chosen.size} numbers; expected start, stride and count of each axis")
        starts, strides, counts = chosen.astype(np.int64).reshape(3, -1)
        ends = starts + strides * counts
        if (
            len(starts) != array.ndim
            or (starts < 0).any()
            or (counts < 0).any()
            or (strides < 1).any()
            or (ends - strides >= array.shape).any()
        ):
            raise InputError("has a HyperSlab that reaches beyond its array")
        part = array[tuple(slice(a, b, step) for a, b, step in zip(starts, ends, strides, strict=True))]
        shape = _shape(item) or part.shape
        if prod(shape) != part.size:
            raise InputError(f"has a HyperSlab of {part.size} numbers but announces {' x '.join(map(str, shape))}")
        return part.reshape(shape)


def _shape(item: ET.Element) -> tuple[int, ...]:
    """The lengths of a DataItem along each axis."""
    shape = tuple(whole_number(word, "Dimensions") for word in item.get("Dimensions", "").split())
    if any(length < 0 for length in shape):
        raise InputError(f"has Dimensions {item.get('Dimensions')!r}; allowed are 0 and more")
    return shape


def _dtype(item: ET.Element) -> np.dtype[Any]:
    kind = (item.get("DataType") or item.get("NumberType") or "Float").lower()
    if kind not in _KINDS:
        raise InputError(f"has a DataItem of the type {kind!r}; allowed are {', '.join(_KINDS)}")
    size = whole_number(item.get("Precision") or str(_BYTES[kind]), "Precision")
    if size not in ((4, 8) if _KINDS[kind] == "f" else (1, 2, 4, 8)):
        raise InputError(
            f"has a DataItem of type {kind!r} and {size} bytes; allowed are 4 and 8, of whole numbers 1 and 2"
        )
    return np.dtype(f"{_KINDS[kind]}{size}")


def _steps(path: str) -> list[str]:
    """The steps of a path; a slash in brackets or quotes parts nothing."""
    return [step for step in _STEPS.findall(path) if step.strip()]


def _follow(here: list[ET.Element], step: str) -> list[ET.Element]:
    found = _STEP.fullmatch(step.strip())
    if not found:
        raise InputError(f"refers to {step!r}; allowed are names, [NUMBER], [@NAME='VALUE'] and [self::NAME]")
    made = []
    for element in here:
        children = [child for child in element if found["name"] in ("*", child.tag)]
        for condition in re.findall(r"\[[^]]*\]", found["conditions"]):
            asked = _CONDITION.fullmatch(condition)
            if not asked:
                raise InputError(f"refers to {condition!r}; allowed are [NUMBER], [@NAME='VALUE'] and [self::NAME]")
            if asked["place"]:
                children = children[int(asked["place"]) - 1 : int(asked["place"])]
            elif asked["key"]:
                children = [child for child in children if child.get(asked["key"]) == asked["value"]]
            else:
                names = [part.strip().removeprefix("self::") for part in asked["self"].split(" or ")]
                children = [child for child in children if child.tag in names]
        made += children
    return made
