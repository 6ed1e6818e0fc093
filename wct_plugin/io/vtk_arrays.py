"""The arrays of VTK's XML files: text, base64 or raw bytes, packed or not, in the element or appended."""

import base64
import binascii
import lzma
import xml.etree.ElementTree as ET
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import lz4_block, read_limit, safe_xml
from wct_plugin.io.text_lines import numbers_of_type, whole_number

_TYPES = {
    "Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4", "Int64": "i8",
    "UInt64": "u8", "Float32": "f4", "Float64": "f8",
}  # fmt: skip
_ORDERS = {"LittleEndian": "<", "BigEndian": ">", None: "="}
#: Bytes that LZMA's dictionary may take; its strongest preset takes 65 MiB.
_LZMA_MEMORY = 1 << 28
_UNPACK: dict[str, Callable[[bytes, int], bytes]] = {
    "vtkZLibDataCompressor": lambda block, size: zlib.decompressobj().decompress(block, size + 1),
    "vtkLZMADataCompressor": lambda block, size: lzma.LZMADecompressor(memlimit=_LZMA_MEMORY).decompress(
        block, size + 1
    ),
    "vtkLZ4DataCompressor": lz4_block.unpack,
}


@dataclass(frozen=True)
class VtkXml:
    """A file of VTK's XML formats: its elements, and what is needed to read their arrays."""

    root: ET.Element
    order: str
    head: np.dtype[Any]  #: of the lengths before the bytes
    unpack: Callable[[bytes, int], bytes] | None
    appended: bytes  #: what follows the ``_``
    raw: bool  #: whether it is bytes, not base64


def parse(text: bytes, kind: str) -> VtkXml:
    """The file, whose type must be this. Raises :class:`InputError` without the file's name."""
    text, appended = _split(text)
    root = safe_xml.parse(text)
    if root.tag != "VTKFile" or root.get("type") != kind:
        raise InputError(f"holds {root.get('type') or root.tag}; expected a VTKFile of type {kind}")
    compressor = root.get("compressor") or ""
    if compressor and compressor not in _UNPACK:
        raise InputError(f"is packed by {compressor}; allowed are {', '.join(_UNPACK)}")
    order = _ORDERS.get(root.get("byte_order"))
    head = {"UInt32": "u4", "UInt64": "u8"}.get(root.get("header_type", "UInt32"))
    if order is None or head is None:
        raise InputError(f"has byte_order {root.get('byte_order')!r} and header_type {root.get('header_type')!r}")
    element = root.find("AppendedData")
    raw = element is not None and element.get("encoding") == "raw"
    return VtkXml(root, order, np.dtype(order + head), _UNPACK.get(compressor), appended, raw)


def _split(text: bytes) -> tuple[bytes, bytes]:
    """The XML, and the bytes after the ``_`` of its appended data, which need be none."""
    start = text.find(b"<AppendedData")
    begin = text.find(b"_", text.find(b">", start)) if start >= 0 else -1
    if begin < 0:
        return text, b""
    end = text.rfind(b"</AppendedData>")
    if end < begin:
        raise InputError("ends within its appended data")
    return text[:begin] + text[end:], text[begin + 1 : end]


def values(file: VtkXml, element: ET.Element) -> NDArray[Any]:
    """The numbers of a ``DataArray``, one row per tuple where it has several components."""
    kind = element.get("type", "")
    if kind not in _TYPES:
        raise InputError(f"array {element.get('Name')!r} has the type {kind!r}; allowed are {', '.join(_TYPES)}")
    dtype = np.dtype(file.order + _TYPES[kind])
    match element.get("format", "ascii"):
        case "ascii":
            array = numbers_of_type((element.text or "").encode(), dtype)
        case "binary":
            array = _numbers(_content(file, "".join((element.text or "").split()).encode(), raw=False), dtype)
        case "appended":
            start = whole_number(element.get("offset", "-1"), "an offset")
            if not 0 <= start < len(file.appended):
                raise InputError(f"array {element.get('Name')!r} lies beyond the appended data")
            array = _numbers(_content(file, file.appended[start:], raw=file.raw), dtype)
        case other:
            raise InputError(f"array {element.get('Name')!r} has the format {other!r}")
    width = whole_number(element.get("NumberOfComponents") or "1", "NumberOfComponents")
    if len(array) % max(width, 1):
        raise InputError(f"array {element.get('Name')!r} has {len(array)} numbers, not {width} for each row")
    return array.astype(dtype.newbyteorder("=")).reshape((-1, width) if width > 1 else -1)


def _numbers(content: bytes, dtype: np.dtype[Any]) -> NDArray[Any]:
    if len(content) % dtype.itemsize:
        raise InputError(f"has an array of {len(content)} bytes, not {dtype.itemsize} for each number")
    return np.frombuffer(content, dtype)


def _content(file: VtkXml, data: bytes, *, raw: bool) -> bytes:
    """The bytes of an array, unpacked; ``data`` may go on after them."""
    if not data:
        return b""
    if file.unpack is None:
        head, rest = _take(data, file.head.itemsize, raw=raw)
        size = int(np.frombuffer(head, file.head)[0])
        if raw or data[: _base64_length(len(head))].endswith(b"="):  # the length was encoded by itself
            return _claimed(_take(rest, size, raw=raw)[0])
        return _claimed(_take(data, len(head) + size, raw=raw)[0][len(head) :])
    count = int(np.frombuffer(_take(data, file.head.itemsize, raw=raw)[0], file.head)[0])
    if not count:
        return b""
    head, rest = _take(data, (3 + count) * file.head.itemsize, raw=raw)
    _, size, last, *packed = np.frombuffer(head, file.head).tolist()
    bodies, _ = _take(rest, sum(packed), raw=raw)
    ends = np.cumsum(packed).tolist()
    sizes = [size] * (count - 1) + [last or size]
    read_limit.claim(sum(sizes), "an array")
    try:
        blocks = [
            file.unpack(bodies[end - length : end], wanted)
            for end, length, wanted in zip(ends, packed, sizes, strict=True)
        ]
    except (zlib.error, lzma.LZMAError) as error:
        raise InputError(f"has a damaged packed block ({error})") from error
    if [len(block) for block in blocks] != sizes:
        raise InputError("has a packed block of another length than it says")
    return b"".join(blocks)


def _claimed(content: bytes) -> bytes:
    """The bytes of an array, which others may have too: what is appended may be named any number of times."""
    read_limit.claim(len(content), "an array")
    return content


def _take(data: bytes, size: int, *, raw: bool) -> tuple[bytes, bytes]:
    """The first ``size`` bytes that the data stand for, and the data after them."""
    length = size if raw else _base64_length(size)
    try:
        taken = data[:length] if raw else base64.b64decode(data[:length], validate=True)
    except binascii.Error as error:
        raise InputError(f"has an array that is no base64 ({error})") from error
    if len(taken) < size:
        raise InputError("ends within an array")
    return taken[:size], data[length:]


def _base64_length(size: int) -> int:
    return -(-size // 3) * 4
