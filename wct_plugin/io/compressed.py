"""Files packed by gzip, ``part.msh.gz``: read by way of a temporary file, and packed when they are written."""

import gzip
import shutil
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from wct_plugin.errors import InputError
from wct_plugin.io import read_limit
from wct_plugin.io.companions import companion, standing_for
from wct_plugin.io.formats import PACKED, Format

#: Bytes that are unpacked at a time.
_PIECE = 1 << 20


@contextmanager
def unpacked(file: Path, form: Format) -> Iterator[Path]:
    """The file, or where it is packed a temporary one that stands for it, with those of its format beside it."""
    if file.suffix.lower() != PACKED:
        yield file
        return
    with tempfile.TemporaryDirectory(prefix="wct-") as folder:
        plain = Path(folder) / file.stem
        _unpack(file, plain)
        for suffix in form.packed:
            made = plain.with_suffix(suffix)
            beside = file.with_name(made.name)
            packed = beside.with_name(beside.name + file.suffix)
            if made != plain and packed.exists():
                _unpack(companion(file, packed.name), made)
            elif made != plain and beside.exists():
                shutil.copyfile(companion(file, beside.name), made)
        with standing_for(plain, file):
            yield plain


def _unpack(packed: Path, plain: Path) -> None:
    try:
        with gzip.open(packed, "rb") as source, plain.open("wb") as target:
            while part := source.read(_PIECE):
                read_limit.claim(len(part), "what is packed in it")
                target.write(part)
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise InputError(f"cannot be unpacked: {error}") from error


@contextmanager
def packing(file: Path, form: Format) -> Iterator[Path]:
    """Where to write the file: in its own place, or where it is to be packed beside it, to be packed afterwards.

    Of a format of several files all are packed that its programs know by their suffix; others stay as they are.
    """
    if file.suffix.lower() != PACKED:
        yield file
        return
    plain = file.with_name(file.stem)
    yield plain
    for suffix in dict.fromkeys((plain.suffix, *form.packed)):
        made = plain.with_suffix(suffix)
        if made.exists():
            _pack(made, made.with_name(made.name + file.suffix))
            made.unlink()


def _pack(plain: Path, packed: Path) -> None:
    """Without name and time, so that the same content gives the same bytes."""
    with (
        plain.open("rb") as source,
        packed.open("wb") as raw,
        gzip.GzipFile("", "wb", fileobj=raw, mtime=0, compresslevel=6) as target,
    ):
        shutil.copyfileobj(source, target)
