"""HDF5 files, opened so that what is missing or damaged in them is said in one line.

HDF5 follows links into other files by itself, wherever they lie, and unpacks what it finds to the end: so links are
looked at before they are followed, and what an array will take is claimed before it is read.
"""

import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import read_limit
from wct_plugin.io.text_lines import decoded

#: Times that deflate may unpack its bytes to.
_DEFLATE_MOST = 1032
#: Bytes that filters beside a packing one may add to a part of an array, as check sums.
_ADDED = 64


@contextmanager
def opened(path: Path, *, links: bool = False) -> Iterator[Any]:
    """The open file; within the body what h5py raises is an :class:`InputError` without the file's name.

    A file with a link that leads out of it is refused, unless ``links``: then :func:`leads_out` tells of each path.
    """
    import h5py  # type: ignore[import-untyped]  # here: what reads no such file should not take it

    try:
        with h5py.File(path, "r") as file:
            out = None if links else _link_out(file)
            if out is not None:
                raise InputError(f"has the link {out!r} into another file; allowed are links within it")
            yield file
    except (KeyError, RuntimeError, OSError) as error:  # h5py's for what is not there, and for what is damaged
        raise InputError(f"lacks a part that is needed, or it is damaged ({error.args[0]})") from error


def children(group: Any) -> Iterator[tuple[str, Any]]:
    """Names and members of a group. Raises :class:`InputError` for what is none, and for members that cannot be had."""
    if not hasattr(group, "items"):
        raise InputError(f"has {_called(group)} where a group should be")
    for name in group:
        member = _member(group, name)
        if member is None:
            raise InputError(f"lacks what {_text(name)!r} in {_called(group)} leads to, or it is damaged")
        yield _text(name), member


def array(group: Any, name: str, kinds: str = "iuf") -> NDArray[Any]:
    """A whole array; its type must be of one of these ``kinds`` of NumPy's. Raises :class:`InputError` otherwise."""
    found = group[name]
    if getattr(found, "shape", None) is None or found.dtype.kind not in kinds:
        raise InputError(f"has {name!r} in {_called(group)}, which is no array of numbers")
    if found.external or found.is_virtual:
        raise InputError(f"has {name!r} in {_called(group)}, which is kept in another file; allowed is one file")
    read_limit.claim(found.nbytes, f"array {name!r}")
    if found.dtype.kind == "O":
        return _texts(found)
    _check_packed(found, name)
    return np.asarray(found[()])


def number(part: Any, name: str) -> int:
    """A whole number that is an attribute. Raises :class:`InputError` for what is none."""
    if prod(part.attrs.get_id(name).shape) != 1:
        raise InputError(f"has the attribute {name!r} of {_called(part)}, which is no whole number")
    value = np.asarray(part.attrs[name])
    if value.size != 1 or value.dtype.kind not in "iu":
        raise InputError(f"has the attribute {name!r} of {_called(part)}, which is no whole number")
    return int(value.item())


def _text(name: str | bytes) -> str:
    """A name: h5py gives bytes where they are not UTF-8."""
    return name if isinstance(name, str) else decoded(name)


def _member(group: Any, name: str | bytes) -> Any:
    """A member of a group, None where it cannot be had; by bytes h5py's groups give none themselves."""
    from h5py import Dataset, Group, h5d, h5g, h5o

    if isinstance(name, str):
        return group.get(name)
    found = h5o.open(group.id, name)
    kind = {h5g.GroupID: Group, h5d.DatasetID: Dataset}.get(type(found))
    return kind and kind(found)


def _link_out(file: Any) -> str | None:
    """The first link found that leads out of the file; none is followed."""
    from h5py import Group, h5l, h5o

    waiting = [file["/"]]
    seen = {h5o.get_info(waiting[0].id).addr}
    while waiting:
        group = waiting.pop()
        for name in group:
            kind = group.id.links.get_info(name if isinstance(name, bytes) else name.encode()).type
            if kind not in (h5l.TYPE_HARD, h5l.TYPE_SOFT):
                return _text(name)
            member = _member(group, name) if kind == h5l.TYPE_HARD else None
            if isinstance(member, Group) and (place := h5o.get_info(member.id).addr) not in seen:
                seen.add(place)
                waiting.append(member)
    return None


def leads_out(group: Any, path: str, most: int = 100) -> bool:
    """Whether a link on the way to a path leads into another file, or round in circles; none is followed to find out.

    A path with a part that is not there leads nowhere, and so not out.
    """
    from h5py import ExternalLink, SoftLink

    group = group.file if path.startswith("/") else group
    first, _, rest = path.strip("/").partition("/")
    if not first or not hasattr(group, "items"):
        return False
    link = group.get(first, getlink=True)
    if isinstance(link, ExternalLink) or most < 1:
        return True
    if isinstance(link, SoftLink):
        return leads_out(group, f"{link.path}/{rest}", most - 1)
    return bool(rest) and first in group and leads_out(group[first], rest, most)


def _texts(found: Any) -> NDArray[Any]:
    """Texts of any lengths, row by row: any number of rows may have the same one."""
    rows = np.empty(found.shape, dtype=object)
    for place in np.ndindex(found.shape):
        rows[place] = found[place]
        read_limit.claim(len(rows[place]), "texts")
    return rows


def _check_packed(found: Any, name: str) -> None:
    """Refuse parts of an array that unpack to more than they are to hold, which HDF5 unpacks to their end."""
    from h5py import h5z

    if found.chunks is None:
        return
    size = prod(found.chunks) * found.dtype.itemsize
    read_limit.claim(max(0, size - found.nbytes), f"a part of array {name!r}")
    made = found.id.get_create_plist()
    filters = [made.get_filter(k)[0] for k in range(made.get_nfilters())]
    packing = [k for k, code in enumerate(filters) if code not in (h5z.FILTER_SHUFFLE, h5z.FILTER_FLETCHER32)]
    if len(packing) > 1:
        raise InputError(f"has array {name!r}, which is packed {len(packing)} times; allowed is once")
    if h5z.FILTER_DEFLATE not in filters:
        return
    large: list[Any] = []

    def look(chunk: Any) -> None:
        if chunk.size * _DEFLATE_MOST > read_limit.left() and not chunk.filter_mask >> packing[0] & 1:
            large.append(chunk.chunk_offset)

    found.id.chunk_iter(look)
    for place in large:
        unpacker = zlib.decompressobj()
        try:
            content = unpacker.decompress(found.id.read_direct_chunk(place)[1], size + _ADDED)
        except zlib.error as error:
            raise InputError(f"has a damaged part of array {name!r} ({error})") from error
        if len(content) == size + _ADDED:
            raise InputError(f"has a part of array {name!r} that unpacks to more than its {size} bytes")


def _called(part: Any) -> str:
    return repr(getattr(part, "name", "") or "a part without a name")
