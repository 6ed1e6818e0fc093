"""MeshLab's filter scripts (.mlx), read here: pymeshlab itself says nothing about a missing or damaged one."""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.parsers import expat

from wct_plugin.errors import InputError

#: Attributes that hold the value of a ``Param`` with several numbers, in their order.
_ROWS = (("x", "y", "z"), ("r", "g", "b", "a"), tuple(f"val{k}" for k in range(16)))


class _EntityError(Exception):
    """The script declares an entity, by which a few bytes can stand for gigabytes."""


def _refuse_entity(*declared: Any) -> None:
    raise _EntityError(repr(declared[0]))


def read(path: Path) -> list[tuple[str, dict[str, Any]]]:
    """The filters of a script in order: MeshLab's display name, and the parameters as texts or lists of texts.

    Whether such filters and parameters exist is for :func:`wct_plugin.adapters.meshlab.run.check` to say.

    Raises
    ------
    InputError
        For a file that is missing, is not XML, is not a filter script, or has no filter.
    """
    try:
        content = path.read_bytes()
        looking = expat.ParserCreate()
        looking.EntityDeclHandler = _refuse_entity
        looking.Parse(content, True)
        root = ElementTree.fromstring(content)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from error
    except _EntityError as error:
        raise InputError(f"{path}: declares the XML entity {error}; allowed are scripts without") from error
    except (
        ElementTree.ParseError,
        expat.ExpatError,
        LookupError,
        ValueError,
    ) as error:  # the latter two of an unknown encoding
        raise InputError(f"{path}: is not XML: {error}") from error
    if root.tag != "FilterScript":
        raise InputError(f"{path}: its root is <{root.tag}>; MeshLab's filter scripts have <FilterScript>")
    if not len(root):
        raise InputError(f"{path}: the script has no filter")
    return [_filter(element, f"{path}: element {number}") for number, element in enumerate(root, 1)]


def _filter(element: ElementTree.Element, where: str) -> tuple[str, dict[str, Any]]:
    name = element.get("name")
    if element.tag != "filter" or not name:
        raise InputError(f"{where} is <{element.tag}>{'' if name else ' without a name'}; allowed is <filter name=...>")
    arguments: dict[str, Any] = {}
    for param in element:
        key = param.get("name")
        if param.tag != "Param" or not key:
            raise InputError(
                f"{where} {name!r} has a <{param.tag}>{'' if key else ' without a name'}; allowed is <Param name=...>"
            )
        if key in arguments:
            raise InputError(f"{where} {name!r} has the parameter {key!r} twice")
        arguments[key] = _value(param, f"{where} {name!r}: parameter {key!r}")
    return name, arguments


def _value(param: ElementTree.Element, where: str) -> str | list[str]:
    value = param.get("value")
    if value is not None:
        return value
    for names in _ROWS:
        if all(name in param.attrib for name in names):
            return [param.attrib[name] for name in names]
    raise InputError(f"{where} has no value")
