"""HDF5 files, opened so that what is missing or damaged in them is said in one line."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """The open file; within the body what h5py raises is an :class:`InputError` without the file's name."""
    import h5py  # type: ignore[import-untyped]  # here: what reads no such file should not take it

    try:
        with h5py.File(path, "r") as file:
            yield file
    except (KeyError, RuntimeError, OSError) as error:  # h5py's for what is not there, and for what is damaged
        raise InputError(f"lacks a part that is needed, or it is damaged ({error.args[0]})") from error


def children(group: Any) -> Iterator[tuple[str, Any]]:
    """Names and members of a group. Raises :class:`InputError` for what is none, and for members that cannot be had."""
    if not hasattr(group, "items"):
        raise InputError(f"has {_called(group)} where a group should be")
    for name, member in group.items():
        if member is None:
            raise InputError(f"lacks what {name!r} in {_called(group)} leads to, or it is damaged")
        yield name, member


def array(group: Any, name: str, kinds: str = "iuf") -> NDArray[Any]:
    """A whole array; its type must be of one of these ``kinds`` of NumPy's. Raises :class:`InputError` otherwise."""
    found = group[name]
    if getattr(found, "shape", None) is None or found.dtype.kind not in kinds:
        raise InputError(f"has {name!r} in {_called(group)}, which is no array of numbers")
    return np.asarray(found[()])


def number(part: Any, name: str) -> int:
    """A whole number that is an attribute. Raises :class:`InputError` for what is none."""
    value = np.asarray(part.attrs[name])
    if value.size != 1 or value.dtype.kind not in "iu":
        raise InputError(f"has the attribute {name!r} of {_called(part)}, which is no whole number")
    return int(value.item())


def _called(part: Any) -> str:
    return repr(getattr(part, "name", "") or "a part without a name")
