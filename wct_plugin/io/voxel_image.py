"""Voxels from files: NumPy's .npy as it is; stacks of images, in one file of many pages or in a folder, by Pillow."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError, WctError

_PAGES = (".tif", ".tiff")
_SLICES = (".png", ".bmp", ".pgm", ".tif", ".tiff")


def read(source: str) -> NDArray[Any]:
    """The array of a file, indexed x, y, z; of images x runs along rows, y down, z from the first to the last.

    Images of a folder come in the order of their names, numbers within by value. Raises :class:`InputError` for what
    cannot be read and :class:`WctError` where images need Pillow.
    """
    path = Path(source)
    if not path.exists():
        raise InputError(f"{path}: no such file or folder")
    if path.is_dir():
        return _folder(path)
    if path.suffix.lower() in _PAGES:
        return _stack(path, list(_pages(path)))
    if path.suffix.lower() == ".npy":
        try:
            found = np.load(path, allow_pickle=False)
        except (OSError, ValueError, EOFError) as error:
            raise InputError(f"{path}: no array can be read: {' '.join(str(error).split())}") from error
        return np.asarray(found)
    raise InputError(
        f"{path}: unknown suffix {path.suffix!r}; allowed are .npy {' '.join(_PAGES)} and folders of images"
    )


def _folder(path: Path) -> NDArray[Any]:
    files = [file for file in path.iterdir() if file.suffix.lower() in _SLICES]
    if not files:
        raise InputError(f"{path}: the folder holds no image; allowed are {' '.join(_SLICES)}")
    return _stack(path, [page for file in sorted(files, key=_order) for page in _pages(file)])


def _order(file: Path) -> list[tuple[int, str]]:
    """Names in the order of the numbers in them: slice9 before slice10."""
    return [(int(part), "") if part.isdigit() else (0, part) for part in re.split(r"(\d+)", file.name)]


def _stack(path: Path, pages: list[NDArray[Any]]) -> NDArray[Any]:
    sizes = sorted({page.shape for page in pages})
    if len(sizes) > 1:
        shown = " and ".join(f"{size[1]} x {size[0]}" for size in sizes[:2])
        raise InputError(f"{path}: the images have {shown} pixels; all must have the same")
    return np.stack(pages).transpose(2, 1, 0)


def _pages(file: Path) -> Iterator[NDArray[Any]]:
    try:
        from PIL import Image, ImageSequence
    except ImportError:
        raise WctError(f"{file}: images need Pillow: pip install 'wct_plugin[images]'") from None
    try:
        with Image.open(file) as image:
            for page in ImageSequence.Iterator(image):
                pixels = np.asarray(page)
                if pixels.ndim != 2:
                    raise InputError(f"{file}: has {pixels.shape[2]} channels; voxels need images of one")
                yield pixels
    except (OSError, SyntaxError, ValueError) as error:  # Pillow's for files that are damaged or none of its own
        raise InputError(f"{file}: no image can be read: {' '.join(str(error).split())}") from error
