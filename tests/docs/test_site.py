"""The site builds without a warning, and the tutorials do what they say when typed in their order."""

import itertools
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient
from support.typing_in import type_in

ROOT = Path(__file__).parents[2]
TUTORIALS = sorted((ROOT / "docs/tutorials").glob("*.md"))


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Where it was built; a warning is an error there."""
    place = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--quiet", "--strict", "--site-dir", str(place)]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return place


def test_it_has_a_page_per_filter_example_and_tutorial(site):
    filters = {path.stem for path in (ROOT / "filters").glob("[a-z]*.py")}
    assert filters == {path.stem for path in (site / "filters").glob("*.html")} - {"index"}
    examples = {path.stem for path in (ROOT / "examples").glob("*.py")}
    assert examples == {path.stem for path in (site / "examples").glob("*.html")}
    assert {path.stem for path in TUTORIALS} == {path.stem for path in (site / "tutorials").glob("*.html")}


def test_pages_load_nothing_from_elsewhere_and_have_no_marks_of_another_language(site):
    pages = list(site.rglob("*.html"))
    assert len(pages) > 50
    for page in pages:
        text = page.read_text(encoding="utf-8")
        loaded = re.findall(r'<(?:script|img|link rel="stylesheet")[^>]*(?:src|href)="(https?:[^"]+)"', text)
        assert loaded == [], page
        assert not re.search(r":(?:class|func|meth|mod|attr|data):<", text), page


def test_the_reference_has_parameters_and_errors(site):
    text = (site / "reference.html").read_text(encoding="utf-8")
    for name in ("optimize", "apply_filter", "well_center", "TetMesh", "hodge_star"):
        assert re.search(rf'id="wct_plugin\.[\w.]*\b{name}"', text), name
    assert text.count("Parameters:") > 5
    assert "Raises:" in text


def blocks(page):
    """Language and content of each block of code; Python after Python is one."""
    text = page.read_text(encoding="utf-8")
    found = re.findall(r"^```(sh|python)\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)
    return [
        (language, "".join(part for _, part in group))
        for language, group in itertools.groupby(found, lambda one: one[0])
    ]


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_a_tutorial_runs_as_it_stands(page, tmp_path, demo):
    """Shell block by block, but for the demo; Python in one interpreter that stays open, as a reader's would."""
    python = ""
    for language, text in blocks(page):
        for folder in re.findall(r"^wct demo(?: (\w+))?$", text, flags=re.MULTILINE):
            shutil.copytree(demo[0], tmp_path / folder, dirs_exist_ok=True)
        if language == "python":
            python += text
            type_in([sys.executable, "-c", python], tmp_path)
        else:
            rest = re.sub(r"^wct demo(?: \w+)?$", "", text, flags=re.MULTILINE)
            type_in(["bash", "-ec", rest], tmp_path)


def test_the_notebook_runs(tmp_path):
    book = nbformat.read(ROOT / "examples/first_mesh.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in book.cells)
    NotebookClient(book, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = "".join(str(out) for cell in book.cells for out in cell.get("outputs", []))
    assert "0 of" in shown
    assert len(shown) < 20_000
