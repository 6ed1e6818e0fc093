"""The examples are run as their readers would run them; each asserts the number it prints."""

import runpy
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


def test_every_example_is_run_here():
    assert {path.name for path in EXAMPLES.glob("*.py")} == {"after_ftetwild.py", "into_scikit_fem.py"}


@pytest.mark.parametrize("name", ["after_ftetwild.py", "into_scikit_fem.py"])
def test_runs_as_a_script(name, tmp_path):
    done = subprocess.run([sys.executable, EXAMPLES / name], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.strip().splitlines()) == 1


def test_flux_is_the_exact_one(tmp_path):
    example = runpy.run_path(str(EXAMPLES / "into_scikit_fem.py"))
    assert example["main"](target=tmp_path / "improved.msh") == pytest.approx(0.5, rel=1e-10)
