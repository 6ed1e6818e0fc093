"""Files that a mesh file includes: read only beside it or below, so that no file leads to others of the machine."""

from pathlib import Path

from wct_plugin.errors import InputError
from wct_plugin.io import read_limit
from wct_plugin.io.companions import checked, expect_name, folder_of

#: Files that one file may lead to, itself included more than once among them.
_MOST = 1000


class Included:
    """What a file includes, directly or by way of others."""

    def __init__(self, file: Path) -> None:
        self._file, self._root = file, folder_of(file).resolve()
        self._count = 0

    def read(self, name: str, within: tuple[Path, ...]) -> tuple[Path, bytes]:
        """The path and content of an included file; ``within``: the files that include it, the outermost first.

        Raises :class:`InputError` for a file that is not there, is no file, or lies elsewhere, and for one that
        includes itself.
        """
        expect_name(name, f"includes {name!r}")
        relative = name.replace("\\", "/")
        beside = [folder / relative for folder in (*[one.parent for one in within[-1:]], self._root)]
        wanted = next((path for path in beside if path.exists()), beside[0]).resolve()
        if not wanted.is_relative_to(self._root) and not wanted.is_relative_to(self._file.resolve().parent):
            raise InputError(f"includes {name!r}; allowed are files beside it or below")
        if not wanted.is_file():
            raise InputError(f"includes {name!r}, which is {'no file' if wanted.exists() else 'not there'}")
        checked(self._file, wanted, f"includes {name!r}")
        self._count += 1
        if wanted in within or self._count > _MOST:
            raise InputError(f"includes {name!r}, which includes itself")
        read_limit.claim(wanted.stat().st_size, f"the included file {name!r}")
        return wanted, wanted.read_bytes()
