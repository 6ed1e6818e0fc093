"""How ``wct`` refuses: exit code 2, one line, nothing on stdout."""

from pathlib import Path

import pytest

from wct_plugin.cli import main


def refused(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> str:
    """Run, expect exit code 2 and one line on stderr, and give that line."""
    assert main.run([str(argument) for argument in arguments]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("error: ")
    assert printed.err.count("\n") == 1
    return printed.err[len("error: ") : -1]
