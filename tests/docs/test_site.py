"""The site builds without a warning, and the tutorials do what they say when typed in their order."""

import os
import re
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

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
    text = page.read_text(encoding="utf-8")
    return re.findall(r"^```(sh|python)\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_a_tutorial_runs_as_it_stands(page, tmp_path):
    """Shell line by line; Python in one interpreter that stays open, as a reader's would."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    python = ""
    for language, text in blocks(page):
        if language == "python":
            python += text
        typed = [[sys.executable, "-c", python]] if language == "python" else [["bash", "-ec", text]]
        for command in typed:
            done = subprocess.run(
                command, cwd=tmp_path, env=os.environ | {"PATH": path}, capture_output=True, text=True, timeout=300
            )
            assert done.returncode == 0, f"{text}\n{done.stderr}"


def test_the_notebook_runs(tmp_path):
    book = nbformat.read(ROOT / "examples/first_mesh.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in book.cells)
    NotebookClient(book, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = "".join(str(out) for cell in book.cells for out in cell.get("outputs", []))
    assert "0 of" in shown
    assert len(shown) < 20_000
