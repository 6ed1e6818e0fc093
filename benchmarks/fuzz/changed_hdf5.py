"""HDF5 files changed at random where it matters: most bytes of one are its own, and a wrong one is refused by HDF5."""

import random
from pathlib import Path
from typing import Any

import h5py
import numpy as np

_INTS = (0, -1, 1, 2, 2**31 - 1, 2**31, 2**62, 400_000_000)
_FLOATS = (np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, 0.0)


def _names(file: h5py.File) -> list[str]:
    found: list[str] = []
    file.visit(found.append)
    return sorted(found)


def _another_value(draw: random.Random, values: Any) -> Any:
    """The values with one, or a row, replaced by hostile ones, as far as their type takes them."""
    flat = np.array(values).reshape(-1)
    if not flat.size or flat.dtype.kind not in "iufS":
        return values
    put: Any = draw.choice(_FLOATS if flat.dtype.kind == "f" else _INTS)
    if flat.dtype.kind == "S":
        put = draw.choice((b"", b"\xff\xfe", b"x" * 300, b"a/b", b"\x1b[2J"))
    elif flat.dtype.kind in "iu":
        width = 8 * flat.dtype.itemsize
        put = (
            (put + (1 << width - 1)) % (1 << width) - (1 << width - 1) if flat.dtype.kind == "i" else put % (1 << width)
        )
    flat[draw.randrange(flat.size)] = np.array(put).astype(flat.dtype)
    return flat.reshape(np.shape(values))


def _another_shape(draw: random.Random, values: Any) -> Any:
    array = np.array(values)
    match draw.randrange(6):
        case 0:
            return array.reshape(-1)[: draw.randrange(array.size + 1)]
        case 1:
            return array[None]
        case 2:
            return np.concatenate([array.reshape(-1), array.reshape(-1)])
        case 3:
            return np.empty(0, array.dtype)
        case 4:
            return array.reshape(-1)[:1].reshape(()) if array.size else array
    return array.T


def _another_type(draw: random.Random, values: Any) -> Any:
    array = np.array(values)
    if array.dtype.kind not in "iuf":
        return array
    with np.errstate(all="ignore"):
        return array.astype(draw.choice(("i1", "u1", "i2", ">i4", "u8", ">f4", "f2", "?", "S5", "c16")))


def changed(draw: random.Random, path: Path) -> None:
    """Change one to three arrays, attributes or names of an HDF5 file."""
    with h5py.File(path, "r+") as file:
        for _ in range(draw.choice((1, 1, 2, 3))):
            names = _names(file)
            if not names:
                return
            name = draw.choice(names)
            node = file[name]
            way = draw.randrange(7)
            if way == 0:
                del file[name]
            elif way == 1:
                file.move(name, f"{name}{draw.choice(('x', '0', ' ', 'é'))}")
            elif len(node.attrs) and (way < 4 or not isinstance(node, h5py.Dataset)):
                key = draw.choice(sorted(node.attrs))
                value = draw.choice((_another_value, _another_shape, _another_type))(draw, node.attrs[key])
                del node.attrs[key]
                if draw.random() < 0.8:
                    node.attrs[key] = value
            elif isinstance(node, h5py.Dataset) and node.dtype.kind in "iufS":
                value = draw.choice((_another_value, _another_value, _another_shape, _another_type))(draw, node[()])
                kept = dict(node.attrs)
                del file[name]
                file.create_dataset(name, data=value).attrs.update(kept)
