"""What editors and type checkers know: names of filters, options with their types, what a filter gives."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pytest
from pydantic.json_schema import SkipJsonSchema

import wct_plugin as wct
from wct_plugin.mesh import SurfaceMesh
from wct_plugin.pipeline import stub

ROOT = Path(__file__).parents[2]
DATA = ROOT / "tests/data"
SOURCES = ("typed_right.py", "typed_wrong.py")
#: What the two modules need is followed; the whole package would take mypy a minute.
MYPY = """
[mypy]
strict = true
disallow_any_unimported = false
[mypy-wct_plugin.*]
follow_imports = skip
[mypy-wct_plugin,wct_plugin.mesh.*,wct_plugin.pipeline.signatures,wct_plugin.pipeline.pipeline,wct_plugin.pipeline.result,wct_plugin.progress,wct_plugin.types]
follow_imports = silent
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """The two modules beside the package, as an install has it; type checkers do not see an editable one."""
    folder = tmp_path_factory.mktemp("types")
    shutil.copytree(ROOT / "wct_plugin", folder / "wct_plugin", ignore=shutil.ignore_patterns("__pycache__", "*.so"))
    for name in SOURCES:
        shutil.copy(DATA / name, folder / name)
    (folder / "mypy.ini").write_text(MYPY)
    return folder


def wrong_lines():
    lines = (DATA / "typed_wrong.py").read_text().splitlines()
    return [number for number, line in enumerate(lines, start=1) if line.endswith("# wrong")]


def test_mypy_knows_right_from_wrong(place):
    command = [sys.executable, "-m", "mypy", "--config-file", "mypy.ini", "--hide-error-context", *SOURCES]
    done = subprocess.run(command, cwd=place, capture_output=True, text=True)
    found = re.findall(r"^(\w+\.py):(\d+): error:", done.stdout, re.M)
    assert sorted({(file, int(line)) for file, line in found}) == [("typed_wrong.py", line) for line in wrong_lines()]


def test_pyright_knows_right_from_wrong(place):
    command = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable, "--outputjson", *SOURCES]
    quiet = {**os.environ, "PYRIGHT_PYTHON_IGNORE_WARNINGS": "1"}
    done = subprocess.run(command, cwd=place, env=quiet, capture_output=True, text=True)
    found = json.loads(done.stdout)["generalDiagnostics"]
    lines = {(Path(one["file"]).name, one["range"]["start"]["line"] + 1) for one in found}
    assert sorted(lines) == [("typed_wrong.py", line) for line in wrong_lines()]


def test_the_committed_types_are_those_of_the_declarations():
    assert stub.STUB.read_text() == stub.text(stub.ours()), "stale: make docs"


def test_every_filter_is_there_at_run_time_too():
    assert set(stub.ours()) <= set(dir(wct.Filter))
    assert {"mesh", "report", "dual"} <= set(dir(wct.Writer))


@pytest.mark.parametrize(
    ("annotation", "shown"),
    [
        (float | None, "float | None"),
        (Literal["a", 2], 'Literal["a", 2]'),
        (dict[str, float], "Mapping[str, float]"),
        (tuple[float, float, float] | float, "Sequence[float] | float"),
        (Path, "str | PathLike[str]"),
        (SkipJsonSchema[np.ndarray] | str, "ArrayLike | str"),
        (SkipJsonSchema[SurfaceMesh] | str | None, "Any"),  # or what a mesh can be made of
        (Annotated[int, "whatever"], "int"),
    ],
)
def test_what_may_be_given_for_an_option(annotation, shown):
    assert stub.typed(annotation) == shown


def test_the_version_is_that_of_the_package():
    assert re.fullmatch(r"\d+\.\d+\.\d+.*", wct.__version__)
    shown = subprocess.run([sys.executable, "-m", "wct_plugin", "--version"], capture_output=True, text=True)
    assert shown.stdout.split()[-1] == wct.__version__
