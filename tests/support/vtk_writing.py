"""Files as VTK's own writers make them."""

from pathlib import Path
from typing import Any


def write_legacy(writer: Any, data: Any, path: Path, *, version: int, binary: bool) -> None:
    """Write with one of VTK's writers of its older files."""
    writer.SetInputData(data)
    writer.SetFileName(str(path))
    writer.SetFileVersion(version)
    (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
    assert writer.Write()
