"""The README's commands and Python, run in their order in an empty folder, as a newcomer would type them."""

import re
import shutil
import sys
from pathlib import Path

import pytest
from support.typing_in import type_in

from wct_plugin.cli.demo import NEXT

README = Path(__file__).parents[2] / "README.md"
#: Lines of shell that set up what the tests run in.
SET_UP = ("make ", "pip install ")


def blocks() -> list[tuple[str, str]]:
    """Language and content of each block of code."""
    return re.findall(r"^```(\w+)\n(.*?)^```", README.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)


def commands(shell: str) -> list[str]:
    return [line.partition("  #")[0].strip() for line in shell.splitlines() if not line.startswith(SET_UP)]


def test_every_block_is_run():
    assert {language for language, _ in blocks()} == {"sh", "python"}
    typed = [line for language, text in blocks() if language == "sh" for line in commands(text)]
    assert typed[0] == "wct demo"
    assert all(line.startswith("wct ") for line in typed)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, demo):
    """Where all has been typed, but for the demo, whose files are there."""
    place = tmp_path_factory.mktemp("typed")
    shutil.copytree(demo[0], place, dirs_exist_ok=True)
    python = ""  # what an interpreter that stays open would know already
    for language, text in blocks():
        if language == "python":
            python += text
            type_in([sys.executable, "-c", python], place)
            python = re.match(r"import .*\n", python).group()  # the meshes of one block are of no use to the next
            continue
        for line in commands(text):
            if line != "wct demo":
                type_in(["bash", "-c", line], place)
    return place


def test_it_runs_and_leaves_what_it_says(folder):
    made = {path.name for path in folder.iterdir()}
    assert {"bone.vtu", "bone2.vtu", "chain.vtu", "two_material.vtu", "part.vtu", "part.html", "chain.json"} <= made
    assert {"part.msh", "two_material.msh", "summary.html"} <= {path.name for path in (folder / "out").iterdir()}


def test_it_has_what_the_demo_says_to_try_next():
    typed = [line for language, text in blocks() if language == "sh" for line in commands(text)]
    for line in NEXT:
        assert any(one.startswith(line) for one in typed), line


def test_it_is_short():
    text = README.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 120
    assert len(text.split()) <= 950
