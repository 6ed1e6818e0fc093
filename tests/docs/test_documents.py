"""The documents: every link and picture of theirs is there, and the index has them all."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])


def prose(page):
    """Without blocks of code, whose brackets are none of Markdown's."""
    return re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)


def links(page):
    return re.findall(r"\]\(([^)\s]+)\)", prose(page))


def anchors(page):
    """The names under which GitHub finds the headings."""
    headings = re.findall(r"^#+ (.+)$", prose(page), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for link in links(page):
        name, _, anchor = link.partition("#")
        if ":" in name:  # another site
            continue
        target = page.parent / name if name else page
        assert target.resolve().is_relative_to(ROOT), link
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


def leads_to(page):
    return {(page.parent / link.partition("#")[0]).resolve() for link in links(page)}


def test_the_index_leads_to_every_page_and_example_and_the_readme_to_the_index():
    index = ROOT / "docs/index.md"
    assert index in leads_to(ROOT / "README.md")
    examples = [*(ROOT / "examples").glob("*.py"), *(ROOT / "examples").glob("*.sh")]
    assert {*(ROOT / "docs").glob("*.md"), *examples} - {index} <= leads_to(index)


def test_nothing_tells_to_install_from_a_registry_what_none_has():
    """Until it is published, what tells people how to install this package names the clone."""
    texts = [
        *PAGES,
        *(one for folder in ("wct_plugin", "filters", "examples") for one in (ROOT / folder).rglob("*.py")),
    ]
    wrong = re.compile(r"(?:pip|pipx|uv|uvx|conda|mamba) (?:\w+ )*(?:-\S+ )*[\"']?wct[_-]plugin\b(?! *@)")
    assert [(one.name, found[0]) for one in texts for found in wrong.finditer(one.read_text(encoding="utf-8"))] == []


def test_files_that_the_page_for_developers_names_are_there():
    page = prose(ROOT / "docs/developing.md")
    named = re.findall(r"`((?:wct_plugin|cpp|filters|tests|examples|docs)/[\w/]*(?:\.\w+)?)`", page)
    assert len(named) > 30
    assert [name for name in named if not (ROOT / name).exists() and "NAME" not in name] == []
