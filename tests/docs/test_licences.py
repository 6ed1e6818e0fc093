"""The table of licences says what the installed packages say, and leaves out none that asks for anything."""

import re
from pathlib import Path

from support.licences import SHARING, declared, family, installed, needed

ROOT = Path(__file__).parents[2]
PROJECT = ROOT / "pyproject.toml"
PAGE = (ROOT / "docs/licences.md").read_text(encoding="utf-8")
ROWS = dict(re.findall(r"^\| (?!package )([\w.-]+) \| ([^|]+) \|", PAGE, flags=re.M))


def test_every_package_that_we_name_has_a_row_and_so_has_each_that_asks_for_something():
    """Of what those bring with them the rest may change with any release of theirs."""
    asking = {name for name, found in needed(PROJECT, without="test").items() if family(found) in SHARING}
    assert {*declared(PROJECT), *asking} - set(ROWS) == set()
    assert "certifi" in asking  # comes with another


def test_rows_say_what_the_packages_say():
    found = {name: family(one) for name, one in installed(set(ROWS)).items()}
    assert len(found) > 40
    wrong = {
        name: (ROWS[name], said) for name, said in found.items() if said and not re.search(rf"\b{said}\b", ROWS[name])
    }
    assert wrong == {}
    assert {name for name, said in found.items() if not said} <= {"fipy"}
    above = PAGE.partition("## All others")[0]
    assert {name for name, said in found.items() if said in SHARING} | {"tetgen"} == {
        name for name in found if f"| {name} |" in above
    }
