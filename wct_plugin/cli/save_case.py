"""``--save-case``: after an internal error a zip with all that it takes to have it again, for a report.

It holds the input files under ``files``, the command on them, options and seed, versions and the traceback. Unpacked,
the command that its ``case.json`` and ``replay.txt`` say runs in its folder.
"""

import json
import os
import shlex
import traceback
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import click

from wct_plugin.errors import one_line
from wct_plugin.io import atomic_files
from wct_plugin.io.companions import noting_opened
from wct_plugin.io.standard_streams import STREAM

_FLAG = "--save-case"


class Case:
    """What a command was given and read; saved if that is asked for."""

    def __init__(self, opened: dict[Path, None]) -> None:
        self.path: str | None = None  #: of the zip
        self._opened = opened

    def save(self, error: BaseException, arguments: Sequence[str]) -> str:
        """Save the case of an error, if that was asked for, and say in words what was done or can be."""
        if self.path is None:
            return f"{_FLAG} FILE saves what is needed to find it"
        try:
            with (
                atomic_files.noting(),  # apart: it is no output of the command
                atomic_files.replacing(self.path) as temporary,
                zipfile.ZipFile(temporary, "w") as archive,
            ):
                _fill(archive, error, arguments, list(self._opened))
        except Exception as fault:  # the error itself matters more
            return f"its case could not be saved: {one_line(fault)}"
        return f"its case is saved in {self.path}: please send it"


_CASE: ContextVar[Case | None] = ContextVar("what is saved of an internal error", default=None)


@contextmanager
def noting_case() -> Iterator[Case]:
    """Note what the command in the body reads, for :meth:`Case.save`."""
    with noting_opened() as opened:
        case = Case(opened)
        token = _CASE.set(case)
        try:
            yield case
        finally:
            _CASE.reset(token)


def save_case_option() -> click.Option:
    """``--save-case``, which every command has."""
    return click.Option(
        [_FLAG],
        metavar="FILE",
        expose_value=False,
        callback=_wanted,
        help="On an internal error, save inputs, options, versions and traceback as a zip",
    )


def _wanted(_: click.Context, __: click.Parameter, value: str | None) -> None:
    case = _CASE.get()
    if value is None or case is None:
        return
    if value == STREAM:
        raise click.BadParameter("is '-'; it must be the name of a file")
    atomic_files.check_writable(value)
    case.path = value


def _fill(archive: zipfile.ZipFile, error: BaseException, arguments: Sequence[str], opened: list[Path]) -> None:
    from wct_plugin.pipeline.provenance import environment  # here: a list of commands should not take NumPy

    words = _without_flag(arguments)
    named = [Path(os.path.abspath(_value(word))) for word in words if _value(word)]
    files = _places([file for file in dict.fromkeys([*named, *opened]) if file.is_file()])
    command = ["wct", *(_replayed(word, files) for word in words)]
    for file, place in files.items():
        archive.writestr(place, _content(file, files), zipfile.ZIP_DEFLATED)
    case: dict[str, Any] = {
        "command": command,
        "given": list(arguments),
        "error": one_line(error),
        "seed": _seed(words),
        **environment(),
        "settings": {name: value for name, value in os.environ.items() if name.startswith(("WCT_", "OMP_"))},
        "files": {place: str(file) for file, place in files.items()},
    }
    archive.writestr("case.json", json.dumps(case, indent=2))
    archive.writestr("traceback.txt", "".join(traceback.format_exception(error)))
    lacks = "\nStandard input is not in it.\n" if STREAM in words else ""
    archive.writestr("replay.txt", f"Unpack it, and in its folder run\n\n  {shlex.join(command)}\n{lacks}")


def _without_flag(arguments: Sequence[str]) -> list[str]:
    words, skip = [], False
    for word in arguments:
        if not skip and word != _FLAG and not word.startswith(f"{_FLAG}="):
            words.append(word)
        skip = word == _FLAG
    return words


def _value(word: str) -> str:
    """What follows the = of an option or setting, or the word itself."""
    return word if os.path.exists(word) else word.rpartition("=")[2]


def _places(files: Sequence[Path]) -> dict[Path, str]:
    """Where in the zip each file is: those below one folder as they lie there, as they name each other so."""
    roots: list[Path] = []
    for folder in sorted({file.parent for file in files}, key=lambda one: len(one.parts)):
        if not any(folder.is_relative_to(root) for root in roots):
            roots.append(folder)
    found = {}
    for file in files:
        number, root = next((k, root) for k, root in enumerate(roots) if file.is_relative_to(root))
        found[file] = f"files/{number}/{file.relative_to(root).as_posix()}"
    return found


def _replayed(word: str, files: dict[Path, str]) -> str:
    """A word of the command as it is in the folder of the case: inputs by their place, outputs by their name alone."""
    value = _value(word)
    head = word.removesuffix(value) if value else word
    if (place := files.get(Path(os.path.abspath(value)))) and value:
        return head + place
    if "/" in value and not value.startswith("-") and Path(value).parent.is_dir():
        return head + Path(value).name
    return word


def _content(file: Path, files: dict[Path, str]) -> bytes:
    """The content of a file; in a pipeline the names of files are those of the case."""
    content = file.read_bytes()
    if file.suffix.lower() != ".json":
        return content
    try:
        return json.dumps(_renamed(json.loads(content), files)).encode()
    except ValueError:
        return content


def _renamed(value: Any, files: dict[Path, str]) -> Any:
    match value:
        case dict():
            return {name: _renamed(item, files) for name, item in value.items()}
        case list():
            return [_renamed(item, files) for item in value]
        case str():
            return _replayed(value, files)
        case _:
            return value


def _seed(words: Sequence[str]) -> str:
    """The seed that was given, or that filters take by themselves."""
    for k, word in enumerate(words):
        if word == "--seed" and k + 1 < len(words):
            return words[k + 1]
        if word.startswith("--seed="):
            return _value(word)
    return "the default of each filter, or as its pipeline says"
