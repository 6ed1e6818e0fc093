"""The variables of a netCDF file, whichever of its kinds it is."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import hdf5
from wct_plugin.io.netcdf_classic import ClassicFile
from wct_plugin.io.text_lines import decoded


class Variables(dict[str, NDArray[Any]]):
    """Arrays by name, and the types of cells of those that are cells of Exodus's."""

    def __init__(self, arrays: dict[str, NDArray[Any]], types: dict[str, str]) -> None:
        super().__init__(arrays)
        self.types = types

    def texts(self, name: str) -> list[str]:
        """The rows of characters of a variable as texts; none where there is no such variable."""
        rows = self.get(name)
        if rows is None:
            return []
        if rows.dtype.kind in "OU":
            return [str(row) for row in rows]
        return [_text(np.asarray(row, dtype="S1").tobytes()) for row in rows]


def _text(content: bytes) -> str:
    return decoded(content.partition(b"\0")[0]).strip()


def read(path: Path, wanted: tuple[str, ...]) -> Variables:
    """The variables whose names begin with one of the wanted. Raises :class:`InputError` without the file's name."""
    with path.open("rb") as file:
        start = file.read(8)
    if start.startswith(b"\x89HDF\r\n\x1a\n"):
        return _from_hdf(path, wanted)
    if start[:4] in (b"CDF\x01", b"CDF\x02"):
        return _from_classic(path, wanted)
    kind = "is netCDF of the kind CDF-5" if start[:4] == b"CDF\x05" else "is no netCDF"
    raise InputError(f"{kind}; allowed are its classic form, that of 64-bit offsets, and netCDF-4")


def _from_hdf(path: Path, wanted: tuple[str, ...]) -> Variables:
    arrays: dict[str, NDArray[Any]] = {}
    types: dict[str, str] = {}
    with hdf5.opened(path) as file:
        for name in file:
            if name.startswith(wanted):
                data = file[name]
                arrays[name] = hdf5.array(file, name, "iufSOU")
                if "elem_type" in data.attrs:
                    value = data.attrs["elem_type"]
                    types[name] = value if isinstance(value, str) else _text(bytes(value))
    return Variables(arrays, types)


def _from_classic(path: Path, wanted: tuple[str, ...]) -> Variables:
    file = ClassicFile(path.read_bytes())
    chosen = [name for name in file.variables if name.startswith(wanted)]
    types = {name: file.variables[name].attributes.get("elem_type", b"") for name in chosen}
    return Variables(
        {name: file.values(name) for name in chosen}, {name: _text(said) for name, said in types.items() if said}
    )
