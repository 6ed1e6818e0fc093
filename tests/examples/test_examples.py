"""The examples are run as their readers would run them; each asserts the number it prints."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from support.builders import jittered_cube
from support.typing_in import PATH

import wct_plugin as wct

ROOT = Path(__file__).parents[2]
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


def test_the_slurm_array(tmp_path):
    """As SLURM would start its tasks; together they do every file once."""
    for k in range(3):
        wct.write(tmp_path / f"c{k}.vtu", jittered_cube(1, k))
    (tmp_path / "chain.json").write_text('[{"type": "filters.get_quality"}]')
    task = {"SLURM_ARRAY_TASK_COUNT": "2", "SLURM_CPUS_PER_TASK": "1", "SLURM_MEM_PER_CPU": "1000"}
    done = []
    for number in ("1", "2"):
        environment = {**os.environ, **task, "SLURM_ARRAY_TASK_ID": number, "PATH": PATH}
        command = [EXAMPLES / "batch_slurm_array.sh", "*.vtu", "out", "chain.json"]
        subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=True)
        done.append(len((tmp_path / f"out/manifest-{number}of2.jsonl").read_text().splitlines()))
    assert done == [2, 1]
    assert sorted(path.name for path in (tmp_path / "out").glob("*.vtu")) == ["c0.vtu", "c1.vtu", "c2.vtu"]
