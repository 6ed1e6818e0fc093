"""Pages of the filters: complete, up to date in docs/, and their examples run."""

from pathlib import Path

import numpy as np
import pytest
from support.builders import jittered_cube, sphere_surface

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.mesh import TetMesh
from wct_plugin.pipeline import stage_page
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.pipeline.stage import filter_names, find_filter

DOCS = Path(__file__).parents[2] / "docs/filters.md"


def test_the_page_in_docs_is_up_to_date(tmp_path):
    assert main.run(["filters", "--markdown", str(tmp_path / "filters.md")]) == 0
    assert DOCS.read_text() == (tmp_path / "filters.md").read_text(), "run `make docs`"


@pytest.mark.parametrize("name", filter_names())
def test_a_page_has_what_the_declaration_has(name, capsys):
    stage = find_filter(name)
    page = DOCS.read_text().partition(f"\n## filters.{name}\n")[2].partition("\n## ")[0]
    assert stage_page.takes_and_gives(stage) in page
    assert stage.summary().replace("``", "`") in page
    for option, field in stage.declaration.model_fields.items():
        row = next(line for line in page.splitlines() if line.startswith(f"| `{option}` |"))
        assert field.description.replace("|", "\\|") in row
    assert main.run(["filters", name]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert " ".join(stage_page.about(stage).split()) in printed
    assert stage_page.example_in_python(stage) in printed


@pytest.mark.parametrize("name", filter_names())
def test_the_example_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stage = find_filter(name)
    *source, _, target = stage_page.example(stage)
    for file in source:
        wct.write(file, jittered_cube(3, 0) if stage.takes is TetMesh else sphere_surface(60))
    np.save("ball.npy", np.ones((2, 1, 1)))
    page = DOCS.read_text().partition(f"\n## filters.{name}\n")[2]
    result = Pipeline.from_json(page.partition("```json\n")[2].partition("```")[0]).execute()
    assert isinstance(result.mesh, stage.gives)
    assert isinstance(wct.read(target), stage.gives)

    chain = eval(page.partition("```python\n")[2].partition(".execute()\n```")[0], {"wct": wct})
    assert chain.to_json() == stage_page.example(stage)


def test_cells_of_a_table_are_escaped():
    assert stage_page.table(("a", "b"), [("x | y", "")]) == "| a | b |\n| --- | --- |\n| x \\| y |  |"
