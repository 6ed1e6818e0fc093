"""How many bytes a file may become in memory: what it declares is claimed before anything is allocated or unpacked.

Files can say in a few bytes that they hold gigabytes: packed zeros, a shape without values, one array under many names.
A reader claims each such size first; text and bytes that stand in the file as they are need no claim.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from wct_plugin.errors import InputError, OptionError

#: Without a limit of the user's: a file may become so many times its size, and always so many bytes. Deflate packs
#: zeros 1000 times, coordinates twice, and cells of a grid some 30 times.
TIMES, LEAST = 100, 1 << 28


class _Limit:
    """What of the limit is left."""

    def __init__(self, most: int | None) -> None:
        self._fixed, self._most, self._claimed = most is not None, LEAST if most is None else most, 0
        self._sizes: dict[Path, int] = {}

    def opened(self, path: Path) -> None:
        if not self._fixed and path not in self._sizes:
            self._sizes[path] = os.stat(path).st_size
            self._most = max(LEAST, TIMES * sum(self._sizes.values()))

    @property
    def left(self) -> int:
        return self._most - self._claimed

    def claim(self, size: int, what: str) -> None:
        if size > self.left:
            before = f"after {self._claimed} bytes of others, " if self._claimed else ""
            raise InputError(
                f"needs {size} bytes for {what}, {before}which is more than the limit of {self._most} bytes; "
                "--max-bytes sets another, in Python max_bytes"
            )
        self._claimed += size


_LIMIT: ContextVar[_Limit | None] = ContextVar("bytes that a file may become", default=None)


@contextmanager
def limited(most: int | None) -> Iterator[None]:
    """Within the body what files become is limited: to ``most`` bytes, or by the sizes of the files that are opened.

    Raises :class:`OptionError` for a limit that is no number above 0.
    """
    if most is not None and most < 1:
        raise OptionError(f"max_bytes is {most}; allowed is a number of bytes above 0")
    token = _LIMIT.set(_Limit(most))
    try:
        yield
    finally:
        _LIMIT.reset(token)


def opened(path: Path) -> None:
    """Take note of a file that is read: without a limit of the user's it counts by its size, once."""
    if (limit := _LIMIT.get()) is not None:
        limit.opened(path)


def claim(size: int, what: str) -> None:
    """Say that so many bytes are needed for what the file holds; :class:`InputError` where they are too many."""
    if (limit := _LIMIT.get()) is not None:
        limit.claim(int(size), what)


def claim_more(size: int, before: int, what: str) -> None:
    """The same of what grows from ``before`` bytes that are there already."""
    claim(max(0, size - before), what)


def left() -> int:
    """How many bytes may still be claimed."""
    limit = _LIMIT.get()
    return (1 << 62) if limit is None else limit.left
