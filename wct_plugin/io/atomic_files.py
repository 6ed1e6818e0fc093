"""Writing files so that nothing half written carries the target's name, and refusing early what cannot be written."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from wct_plugin.errors import OutputError


class Written:
    """The files that got their names within :func:`noting`."""

    def __init__(self) -> None:
        self._noted: dict[Path, int] = {}

    def note(self, name: Path, file: Path) -> None:
        """Note that ``file`` is about to be renamed to ``name``; after the renaming an interrupt might come first."""
        self._noted[name] = file.stat().st_ino

    def names(self) -> list[str]:
        """The names, in the order of writing, of those that were renamed indeed: they are still the same files."""
        return [str(name) for name, inode in self._noted.items() if name.exists() and name.stat().st_ino == inode]


_NOTES: ContextVar[Written | None] = ContextVar("written files", default=None)


@contextmanager
def noting() -> Iterator[Written]:
    """Note every file that the body writes by :func:`replacing`, for who must say what there is after an error."""
    written = Written()
    token = _NOTES.set(written)
    try:
        yield written
    finally:
        _NOTES.reset(token)


def check_writable(path: str | Path) -> None:
    """Find out, before any work is done, whether a file can be created under this name.

    Parameters
    ----------
    path : str or Path
        The file that is to be written; it may or may not exist.

    Raises
    ------
    OutputError
        If the directory is missing or takes no new file, or if a directory has the name.
    """
    target = Path(path)
    if target.is_dir():
        raise OutputError(f"{path}: is a directory; a file name is needed")
    if not target.parent.is_dir():
        raise OutputError(f"{path}: there is no directory {target.parent}; create it first")
    try:
        # Only creating a file tells: permission bits say nothing to root, nor about read-only or full disks.
        with tempfile.NamedTemporaryFile(dir=target.parent, prefix=f".{target.name}."):
            pass
    except OSError as error:
        raise _unwritable(path, error) from error


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Let the body write to a temporary path and rename the result to ``path`` if the body succeeds.

    The temporary path has the target's own file name in a hidden directory next to it. A writer that chooses its
    format by suffix, adds companions (``.node`` + ``.ele``, ``.xdmf`` + ``.h5``) or stores a companion's name inside
    a file thus sees what it would see at the target; companions are moved too, before the target. Whatever is
    raised, KeyboardInterrupt included, nothing temporary stays and an existing target is as it was.

    Parameters
    ----------
    path : str or Path
        The file to write. Where it is a symbolic link, the file it points to is replaced.

    Yields
    ------
    Path
        Where the body must write.

    Raises
    ------
    OutputError
        For an :class:`OSError` of the body or of the renaming (disk full, no permission), naming path and reason.
    """
    target = Path(path)
    if target.is_symlink():
        target = target.resolve()
    try:
        if target.is_dir():
            raise IsADirectoryError(0, "is a directory; a file name is needed")
        work = Path(tempfile.mkdtemp(dir=target.parent, prefix=f".{target.name}."))
        try:
            yield work / target.name
            _move(work, target, Path(path))
        finally:
            # What is raised here is the body's own exception, which matters more than a rest that cannot be removed.
            shutil.rmtree(work, ignore_errors=True)
    except OSError as error:
        raise _unwritable(path, error) from error


def check_fillable(folder: str | Path) -> None:
    """Find out, before any work is done, whether files can be created in a folder that may be there or not.

    Raises :class:`OutputError` if it, or the nearest of those around it that is there, takes no new file.
    """
    _, there = _missing(Path(folder))
    if not there.is_dir():
        raise OutputError(f"{folder}: {there} is a file; a folder is needed")
    try:
        with tempfile.NamedTemporaryFile(dir=there, prefix=".wct."):
            pass
    except OSError as error:
        raise _unwritable(folder, error) from error


@contextmanager
def filling(folder: str | Path) -> Iterator[Path]:
    """Let the body write files into a temporary folder, and give them their names in ``folder`` if it succeeds.

    ``folder`` is made, with those around it. What else is in it stays. Whatever is raised, nothing temporary stays, and
    files that were there are as they were.

    Yields
    ------
    Path
        The folder to write into.

    Raises
    ------
    OutputError
        For an :class:`OSError` of the body or of the renaming, naming folder and reason.
    """
    target = Path(folder)
    missing, there = _missing(target)
    try:
        work = Path(tempfile.mkdtemp(dir=there, prefix=".wct."))
        try:
            yield work
            target.mkdir(parents=True, exist_ok=True)
            _name([(made, target / made.name, target / made.name) for made in sorted(work.iterdir())])
        except BaseException:
            for made in reversed(missing):  # the outermost comes first
                if made.is_dir() and not any(made.iterdir()):
                    made.rmdir()
            raise
        finally:
            shutil.rmtree(work, ignore_errors=True)
    except OSError as error:
        raise _unwritable(folder, error) from error


def _missing(folder: Path) -> tuple[list[Path], Path]:
    """Which of the folders down to this one are not there, and the one around them that is."""
    chain = [folder, *folder.parents]
    there = next(one for one in chain if one.exists())
    return chain[: chain.index(there)][::-1], there


def _move(work: Path, target: Path, path: Path) -> None:
    """Give the files in ``work`` their names beside ``target``, which the caller knows as ``path``."""
    made = sorted(work.iterdir(), key=lambda file: file.name == target.name)
    if not made or made[-1].name != target.name:
        raise FileNotFoundError(0, "nothing was written")
    finals = [(file, target.parent / file.name) for file in made]
    _name([(file, final, path if final == target else final) for file, final in finals])


def _name(made: list[tuple[Path, Path, Path]]) -> None:
    """Give files their names, if all can have them: where each is, the name it gets, and what the caller calls that."""
    for file, final, _ in made:
        if final.is_dir():
            raise IsADirectoryError(0, f"there is a directory named {file.name}")
        with file.open("rb") as handle:
            os.fsync(handle.fileno())  # some file systems report a full disk only now
    notes = _NOTES.get()
    for file, final, known in made:
        if notes is not None:
            notes.note(known, file)
        file.replace(final)


def _unwritable(path: str | Path, error: OSError) -> OutputError:
    # NumPy's tofile reports a short write without saying why; a full disk is what causes it.
    reason = error.strerror or f"{error} (is the disk full?)"
    return OutputError(f"{path}: cannot be written: {reason}")
