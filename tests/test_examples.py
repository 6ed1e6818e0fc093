"""The examples are run as their readers would run them; each asserts the number it prints."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
#: Examples that print a page of the documentation; the others print one line.
PAGES = {"paper.py": "docs/paper.md"}


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.name)
def test_runs_as_a_script(path, tmp_path):
    done = subprocess.run([sys.executable, path], cwd=tmp_path, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()
    printed = done.stdout.decode("utf-8")
    if path.name in PAGES:
        assert printed == (ROOT / PAGES[path.name]).read_text(encoding="utf-8")
    else:
        assert len(printed.strip().splitlines()) == 1


def test_pictures_of_the_pages_are_there():
    for page in (ROOT / name for name in PAGES.values()):
        pictures = re.findall(r"!\[.+?\]\((.+?)\)", page.read_text(encoding="utf-8"))
        assert pictures
        assert all((page.parent / picture).stat().st_size < 80_000 for picture in pictures)
