"""Writing files so that nothing half written carries the target's name, and refusing early what cannot be written."""

import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from wct_plugin.errors import OutputError
from wct_plugin.io.workplaces import alone_in, workplace


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
        If the directory is missing or takes no new file, or if what has the name is no file or may not be written.
    """
    try:
        target = _target(path)
        if not target.parent.is_dir():
            raise OutputError(f"{path}: there is no directory {target.parent}; create it first")
        # Only creating a file tells: permission bits say nothing to root, nor about read-only or full disks.
        with tempfile.TemporaryFile(dir=target.parent):
            pass
    except OSError as error:
        raise _unwritable(path, error) from error


def _target(path: str | Path) -> Path:
    """The file that is to be written, behind a link too. Raises :class:`OSError` for what must not be replaced."""
    target = Path(path)
    if target.is_symlink():
        try:
            target = target.resolve()
        except RuntimeError as error:  # Python's for links that lead round in circles
            raise OSError(0, "is a link that leads to itself") from error
    _check_replaceable(target)
    return target


def _check_replaceable(target: Path) -> None:
    """Raise :class:`OSError` for directories, devices and pipes, and for files that may not be written."""
    if target.is_dir():
        raise IsADirectoryError(0, "is a directory; a file name is needed")
    if target.exists() and not target.is_file():
        raise OSError(0, "is a device or a pipe; allowed are files, and - for standard output")
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(0, "the file there is write-protected")


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Let the body write to a temporary path and rename the result to ``path`` if the body succeeds.

    The temporary path has the target's own file name in a hidden directory next to it. A writer that chooses its
    format by suffix, adds companions (``.node`` + ``.ele``, ``.xdmf`` + ``.h5``) or stores a companion's name inside
    a file thus sees what it would see at the target; companions are moved too, before the target. Whatever is
    raised, KeyboardInterrupt included, nothing temporary stays and an existing target is as it was; a process that is
    killed leaves the directory, which the next one that writes this target takes away. A file that takes the place of
    another has its permissions.

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
    try:
        target = _target(path)
        with workplace(target.parent, target.name) as work:
            yield work / target.name
            _move(work, target, Path(path))
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
        with tempfile.TemporaryFile(dir=there):
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
        with workplace(there, target.name) as work:
            try:
                yield work
                target.mkdir(parents=True, exist_ok=True)
                _name([(made, target / made.name, target / made.name) for made in sorted(work.iterdir())])
            except BaseException:
                for made in reversed(missing):  # the outermost comes first
                    if made.is_dir() and not any(made.iterdir()):
                        made.rmdir()
                raise
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
        _check_replaceable(final)
        with file.open("rb") as handle:
            os.fsync(handle.fileno())  # some file systems report a full disk only now
    notes = _NOTES.get()
    for folder in {final.parent for _, final, _ in made}:
        with alone_in(folder):
            for file, final, known in made:
                _take_permissions(file, final)
                if notes is not None:
                    notes.note(known, file)
                file.replace(final)


def _take_permissions(file: Path, final: Path) -> None:
    """Give a file the permissions, and where we may the owner, of the one whose place it takes."""
    if not final.exists():
        return
    there, ours = final.stat(), file.stat()
    if (there.st_uid, there.st_gid) != (ours.st_uid, ours.st_gid) and hasattr(os, "chown"):
        with suppress(PermissionError):
            os.chown(file, there.st_uid, there.st_gid)
    file.chmod(stat.S_IMODE(there.st_mode))


def _unwritable(path: str | Path, error: OSError) -> OutputError:
    # NumPy's tofile reports a short write without saying why; a full disk is what causes it.
    reason = error.strerror or f"{error} (is the disk full?)"
    return OutputError(f"{path}: cannot be written: {reason}")
