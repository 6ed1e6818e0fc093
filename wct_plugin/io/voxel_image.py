"""Voxels from files: NumPy's .npy as it is; stacks of images, in one file of many pages or in a folder, by Pillow."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError, WctError, how_to_install
from wct_plugin.io import read_limit
from wct_plugin.io.companions import checked, note_opened

_PAGES = (".tif", ".tiff")
_SLICES = (".png", ".bmp", ".pgm", ".tif", ".tiff")
#: What Pillow may take a file for, whatever its name says: others run programs, as that of PostScript does.
_FORMATS = ("TIFF", "PNG", "BMP", "PPM")
#: Bytes of a pixel by Pillow's mode; 4 of others.
_PIXEL = {"1": 1, "L": 1, "P": 1, "I;16": 2, "I;16B": 2, "I;16L": 2}


def read(source: str, max_bytes: int | None = None) -> NDArray[Any]:
    """The array of a file, indexed x, y, z; of images x runs along rows, y down, z from the first to the last.

    Images of a folder come in the order of their names, numbers within by value. ``max_bytes`` is a limit of what they
    may become, as of :func:`wct_plugin.read`. Raises :class:`InputError` for what
    cannot be read and :class:`WctError` where images need Pillow.
    """
    with read_limit.limited(max_bytes):
        try:
            return _read(Path(source))
        except MemoryError as error:
            raise InputError(f"{source}: ran out of memory: {error}") from error


def _read(path: Path) -> NDArray[Any]:
    if not path.exists():
        raise InputError(f"{path}: no such file or folder")
    if path.is_dir():
        return _folder(path)
    if not path.is_file():
        raise InputError(f"{path}: is no file")
    note_opened(path)
    if path.suffix.lower() in _PAGES:
        return _stack(path, list(_pages(path)))
    if path.suffix.lower() == ".npy":
        try:
            return np.array(np.lib.format.open_memmap(path, mode="r"))  # which finds out whether all of it is there
        except (OSError, ValueError, EOFError) as error:
            raise InputError(f"{path}: no array can be read: {' '.join(str(error).split())}") from error
    raise InputError(
        f"{path}: unknown suffix {path.suffix!r}; allowed are .npy {' '.join(_PAGES)} and folders of images"
    )


def _folder(path: Path) -> NDArray[Any]:
    files = [file for file in path.iterdir() if file.suffix.lower() in _SLICES]
    if not files:
        raise InputError(f"{path}: the folder holds no image; allowed are {' '.join(_SLICES)}")
    return _stack(path, [page for file in sorted(files, key=_order) for page in _pages(_checked(file))])


def _checked(file: Path) -> Path:
    try:
        return checked(file.parent / "folder", file, "holds an image")
    except InputError as error:
        raise InputError(f"{file}: {error}") from None


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
        raise WctError(f"{file}: images need Pillow: {how_to_install('images')}") from None
    try:
        with Image.open(file, formats=_FORMATS) as image:
            for page in ImageSequence.Iterator(image):
                if len(bands := page.getbands()) != 1:
                    raise InputError(f"{file}: has {len(bands)} channels; voxels need images of one")
                read_limit.claim(page.width * page.height * _PIXEL.get(page.mode, 4), f"the images of {file}")
                yield np.asarray(page)
    except (
        OSError,
        SyntaxError,
        ValueError,
        Image.DecompressionBombError,
    ) as error:
        raise InputError(f"{file}: no image can be read: {' '.join(str(error).split())}") from error
