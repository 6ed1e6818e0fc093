"""XML without what XML can do beyond text: no entities are expanded and no other file is opened."""

import xml.etree.ElementTree as ET
from typing import Any
from xml.parsers import expat

from wct_plugin.errors import InputError


def parse(text: bytes) -> ET.Element:
    """The root element, names without their namespaces. Raises :class:`InputError` without the file's name."""
    builder = ET.TreeBuilder()
    parser = expat.ParserCreate(namespace_separator="}")
    parser.buffer_text = True
    parser.buffer_size = 1 << 20
    parser.StartElementHandler = lambda name, attributes: builder.start(
        _local(name), {_local(key): value for key, value in attributes.items()}
    )
    parser.EndElementHandler = lambda name: builder.end(_local(name))
    parser.CharacterDataHandler = builder.data
    parser.EntityDeclHandler = _refuse
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise InputError(f"is no XML, or truncated ({error})") from error
    return builder.close()


def _local(name: str) -> str:
    return name.rpartition("}")[2]


def _refuse(*declared: Any) -> None:
    raise InputError(f"declares the XML entity {declared[0]!r}; allowed are files without")
