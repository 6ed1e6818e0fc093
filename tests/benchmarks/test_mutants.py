"""Changes of Python modules: drawn by their seed, each another program, and noticed where a test fails."""

import ast
import subprocess
import sys

from benchmarks import mutants
from benchmarks.mutants import MODULES


def test_a_seed_draws_the_same_changes_of_all_modules() -> None:
    found = mutants.drawn(list(MODULES), 5)
    assert found == mutants.drawn(list(MODULES), 5)
    assert found != mutants.drawn(list(MODULES), 6)
    assert {change.module for change in found} == set(MODULES)
    assert len(set(found)) == len(found) > 1000


def test_each_change_is_another_program() -> None:
    for change in mutants.drawn(list(MODULES), 1)[:25]:
        before = change.path.read_text(encoding="utf-8")
        code, line, what = change.applied()
        assert code.co_code != b""
        assert before.splitlines()[line - 1].strip().replace("|", "\\|") in what
        first, _, second = what.partition(" to ")
        assert first != second.partition(" in ")[0]
        assert change.path.read_text(encoding="utf-8") == before


def test_annotations_and_words_are_left_alone() -> None:
    tree = ast.parse('@decorated(1)\ndef f(x: tuple[1, 2] | None) -> A[3]:\n    """Text."""\n    return x + 4\n')
    changed = [ast.unparse(node) for node in mutants._nodes(tree) if mutants._variants(node)]
    assert changed == ["x + 4", "4"]


def test_a_change_is_noticed_where_a_test_fails_and_nowhere_else() -> None:
    """In a process of its own, where the module is not imported yet."""
    drawn = mutants.drawn(["certify/box_pairs.py", "certify/certificate.py"], 1)
    changes = {change.applied()[2].partition(" in ")[0]: change for change in drawn}
    swapped, larger = changes["`a_low <= b_high` to `a_low > b_high`"], changes["`40` to `41`"]
    tests = ["certify/test_box_pairs.py"]
    program = f"""
from pathlib import Path
from benchmarks import mutants
from benchmarks.mutants import Change
mutants.WORK.mkdir(parents=True, exist_ok=True)
for change in (None, {swapped}, {larger}):
    print(mutants.noticed(change, {tests}))
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=mutants.ROOT, capture_output=True, text=True, check=True)
    before, noticed, after = done.stdout.splitlines()
    assert (before, after) == ("", "")
    assert noticed.startswith("test_box_pairs.py::test_all_pairs_and_no_others[")
