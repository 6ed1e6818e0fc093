"""The readers of meshio, kept quiet and guarded against what they loop on or do not see."""

import contextlib
import io
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from wct_plugin.errors import InputError
from wct_plugin.io import tetgen_face_file
from wct_plugin.io.formats import Format
from wct_plugin.io.meshio_modules import meshio_module
from wct_plugin.io.raw_mesh import RawBlock, RawMesh

#: What meshio only warns of although part of the file is missing then.
_FATAL = ("not closed by", "cannot handle", "End-of-file reached", "could not parse", "markers according to NMARK")


def load(file: Path, form: Format) -> tuple[RawMesh, list[str]]:
    """What the file holds, and what meshio says it has left out. Whatever goes wrong is an InputError."""
    with refusing(form):
        _check_ends(file, form)
        with overheard() as said, warnings.catch_warnings():
            # NumPy only deprecates reading past what is no number.
            warnings.filterwarnings("error", message="string or file could not be read", category=DeprecationWarning)
            raw = raw_mesh(meshio_module(form.module).read(str(file)))
        for warning in said:
            if any(phrase in warning for phrase in _FATAL):
                raise InputError(warning)
        if form.name == "TetGen":
            said += _beyond_counts(file)
            tetgen_face_file.add_facets(raw, file)
    return raw, said


def raw_mesh(mesh: Any) -> RawMesh:
    """A ``meshio.Mesh`` in our form."""
    return RawMesh(
        mesh.points,
        [RawBlock(block.type, block.data) for block in mesh.cells],
        dict(mesh.point_data),
        {name: list(columns) for name, columns in mesh.cell_data.items()},
        dict(mesh.point_sets),
        {name: list(columns) for name, columns in mesh.cell_sets.items()},
        dict(mesh.field_data),
        periodic=list(getattr(mesh, "gmsh_periodic", None) or ()),
    )


@contextlib.contextmanager
def refusing(form: Format) -> Iterator[None]:
    """Whatever goes wrong in reading a file is an :class:`InputError` of one line; the file's name is left to add."""
    try:
        yield
    except (InputError, OSError) as error:
        raise InputError(f"cannot be read as {form.name}: {_first_line(error)}") from error
    except Exception as error:  # any at all: readers index and convert without looking
        said = _first_line(error)
        if type(error).__name__ != "ReadError":  # meshio's own, whose text is meant to be read
            said = f"malformed or truncated ({type(error).__name__}: {said})"
        raise InputError(f"cannot be read as {form.name}: {said or 'malformed or truncated'}") from error


def _first_line(error: BaseException) -> str:
    return " ".join(str(error).split("\n", 1)[0].split())[:200]


@contextlib.contextmanager
def overheard() -> Iterator[list[str]]:
    """Keep meshio from printing; afterwards the list holds its warnings, each one line."""
    said: list[str] = []
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        yield said
    said += [" ".join(part.split()) for part in err.getvalue().split("Warning:")[1:]]


def _check_ends(file: Path, form: Format) -> None:
    """Find damage that meshio's readers do not see or on which they would loop for ever."""
    if form.name == "TetGen":
        for part in _tetgen_parts(file):
            if not _content(part):
                raise InputError(f"{part.name} has no content")


def _tetgen_parts(file: Path) -> tuple[Path, Path]:
    return file.with_suffix(".node"), file.with_suffix(".ele")


def _content(part: Path) -> list[str]:
    """The lines of a file of TetGen's that are no comments."""
    with part.open() as lines:
        return [line for line in lines if line.strip() and not line.lstrip().startswith("#")]


def _beyond_counts(file: Path) -> list[str]:
    """Lines that files of TetGen's have after as many as they announce, which meshio leaves out."""
    found = {part.name: _content(part) for part in _tetgen_parts(file)}
    extra = {name: len(lines) - 1 - int(lines[0].split()[0]) for name, lines in found.items()}
    return [f"{count} lines of {name} beyond its count" for name, count in extra.items() if count > 0]
