"""Changes of the Python modules that judge meshes, drawn by a seed, and whether the tests notice them.

``python -m benchmarks.mutants --count 200 --seed 1`` changes one place at a time, an operator, a number, a condition or
a reduction, and runs the tests in ``tests/measure``, ``exact``, ``certify`` and ``duals`` until one fails. Nothing on
the disk is changed: a forked process gets the changed module in place of the file's, and what the tests import from
other packages is there already. The table grows in ``build/python_mutants/table.md`` after each, so that it can be
stopped at any time. A change takes some two seconds where it is noticed, and as long as all tests where it is not.
"""

import argparse
import ast
import importlib
import importlib.util
import os
import random
import signal
import sys
import traceback
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.machinery import ModuleSpec, SourceFileLoader
from pathlib import Path
from types import CodeType

import pytest

ROOT = Path(__file__).parents[1]
WORK = ROOT / "build" / "python_mutants"
#: What is changed, and the tests that notice most of it; all the others come after them.
MODULES = {
    "measure/quality.py": "measure/test_quality.py",
    "measure/shape_polynomials.py": "measure/test_rounding_bounds.py",
    "measure/duals.py": "measure/test_duals.py",
    "exact/predicates.py": "exact",
    "exact/polynomial_signs.py": "exact",
    "certify/certificate.py": "certify/test_certificate.py",
    "certify/overlaps.py": "certify/test_certificate.py",
    "certify/overlapping_tets.py": "certify/test_overlapping_tets.py",
    "certify/box_pairs.py": "certify/test_box_pairs.py",
}
FOLDERS = ("exact", "measure", "certify", "duals")
#: Imported before the forks: what takes the tests long to import, and is no part of this package.
PRELOADED = ("numpy", "scipy.spatial", "scipy.optimize", "hypothesis.strategies", "meshio", "pydantic", "rich.table")
#: Seconds after which a change that makes the tests run on and on counts as noticed.
LONGEST = 400

_OPERATORS: dict[type[ast.AST], tuple[type[ast.AST], ...]] = {
    ast.Add: (ast.Sub,), ast.Sub: (ast.Add,), ast.Mult: (ast.Div,), ast.Div: (ast.Mult,), ast.Pow: (ast.Mult,),
    ast.BitOr: (ast.BitAnd,), ast.BitAnd: (ast.BitOr,), ast.BitXor: (ast.BitOr,),
    ast.LShift: (ast.RShift,), ast.RShift: (ast.LShift,), ast.FloorDiv: (ast.Mult,), ast.Mod: (ast.Mult,),
    ast.And: (ast.Or,), ast.Or: (ast.And,),
    ast.Lt: (ast.LtE, ast.Gt), ast.LtE: (ast.Lt, ast.Gt), ast.Gt: (ast.GtE, ast.Lt), ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,), ast.NotIn: (ast.In,),
}  # fmt: skip
_NAMES = {
    "any": "all", "all": "any", "min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum",
    "argmin": "argmax", "argmax": "argmin",
}  # fmt: skip


@dataclass(frozen=True)
class Change:
    """One place of a module, by its number in the order of :func:`_nodes`, and which of its changes."""

    module: str
    node: int
    variant: int

    @property
    def path(self) -> Path:
        """Of the module's file."""
        return ROOT / "wct_plugin" / self.module

    @property
    def name(self) -> str:
        """Of the module, as it is imported."""
        return "wct_plugin." + self.module.removesuffix(".py").replace("/", ".")

    def applied(self) -> tuple[CodeType, int, str]:
        """The changed module, the line, and what became of what there."""
        text = self.path.read_text(encoding="utf-8")
        tree = ast.parse(text)
        node = list(_nodes(tree))[self.node]
        before = ast.unparse(node)
        _variants(node)[self.variant](node)
        ast.fix_missing_locations(tree)
        line: int = (node.target if isinstance(node, ast.comprehension) else node).lineno  # type: ignore[attr-defined]
        what = f"`{before}` to `{ast.unparse(node)}` in `{text.splitlines()[line - 1].strip()}`".replace("|", "\\|")
        return compile(tree, str(self.path), "exec"), line, what


def _nodes(tree: ast.AST) -> Iterator[ast.AST]:
    """All that computes, in order: annotations and decorators do not."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield child
                yield from _nodes(child)


def _variants(node: ast.AST) -> list["_Edit"]:
    """What may be done to a node; none where it is not changed."""
    match node:
        case ast.BinOp(op=op) | ast.AugAssign(op=op) | ast.BoolOp(op=op):
            return [_Edit("op", other()) for other in _OPERATORS.get(type(op), ())]
        case ast.Compare(ops=[op]):
            return [_Edit("ops", [other()]) for other in _OPERATORS[type(op)]]
        case ast.Constant(value=bool(value)):
            return [_Edit("value", not value)]
        case ast.Constant(value=int(value)):
            return [_Edit("value", value + 1), _Edit("value", value - 1)]
        case ast.Constant(value=float(value)):
            return [_Edit("value", 2.0 * value or 1.0), _Edit("value", value / 2.0 or -1.0)]
        case ast.Attribute(attr=name) if name in _NAMES:
            return [_Edit("attr", _NAMES[name])]
        case ast.Call(func=ast.Name(id=name)) if name in _NAMES:
            return [_Edit("func", ast.Name(_NAMES[name], ast.Load()))]
        case ast.UnaryOp(op=ast.USub() | ast.Invert() | ast.Not()):
            return [_Edit("op", ast.UAdd())]  # the value itself
        case ast.If(test=test) | ast.IfExp(test=test) | ast.comprehension(ifs=[test]):
            negated = ast.UnaryOp(ast.Not(), test)
            return [_Edit("ifs", [negated]) if isinstance(node, ast.comprehension) else _Edit("test", negated)]
    return []


@dataclass(frozen=True)
class _Edit:
    """Another value for a field of a node."""

    field: str
    value: object

    def __call__(self, node: ast.AST) -> None:
        setattr(node, self.field, self.value)


class _Loader(SourceFileLoader):
    """Runs a changed module in place of the file's."""

    def __init__(self, name: str, path: str, code: CodeType) -> None:
        super().__init__(name, path)
        self._code = code

    def get_code(self, fullname: str) -> CodeType:
        return self._code


class _Finder:
    """Comes first, and finds the changed module alone."""

    def __init__(self, change: Change, code: CodeType) -> None:
        self._change, self._code = change, code

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        if name != self._change.name:
            return None
        place = str(self._change.path)
        return importlib.util.spec_from_file_location(name, place, loader=_Loader(name, place, self._code))


class _First:
    """Keeps the first test that fails, or the folder that cannot be imported."""

    def __init__(self) -> None:
        self.name = ""

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self.name = self.name or report.nodeid.split("/")[-1]

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed:
            self.name = self.name or "its import"


def noticed(change: Change | None, tests: Sequence[str]) -> str:
    """The test that notices a change, empty where none does; without a change, the test that fails anyway."""
    sys.stdout.flush()
    sys.stderr.flush()
    said, says = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(said)
        signal.alarm(LONGEST)
        _judge(change, tests, says)
    os.close(says)
    with open(said, encoding="utf-8") as pipe:
        name = pipe.read()
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return "takes too long" if os.WTERMSIG(status) == signal.SIGALRM else f"signal {os.WTERMSIG(status)}"
    return name or ("" if os.WEXITSTATUS(status) == 0 else "an error outside of the tests")


def _judge(change: Change | None, tests: Sequence[str], says: int) -> None:
    """In the child: import the change, run the tests, name the first that fails, and end."""
    silent = os.open(WORK / "last.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    first = _First()
    code = 1
    try:
        if change:
            sys.meta_path.insert(0, _Finder(change, change.applied()[0]))  # type: ignore[arg-type]
        options = [
            "-x",
            "-q",
            "-p",
            "no:cacheprovider",
            "--hypothesis-seed=0",
            "-Wignore::pytest.PytestAssertRewriteWarning",
            f"--basetemp={WORK / 'tmp'}",
        ]
        for some in filter(None, (tests[:1], tests[1:])):  # most are noticed before the others are imported
            code = int(pytest.main([*options, *(str(ROOT / "tests" / test) for test in some)], plugins=[first]))
            if code:
                break
    except BaseException:
        traceback.print_exc()
    sys.stdout.flush()
    os.write(says, first.name.encode())
    os._exit(code)


def drawn(modules: Sequence[str], seed: int) -> list[Change]:
    """All changes, in the order that a seed gives them."""
    found = []
    for module in modules:
        tree = ast.parse((ROOT / "wct_plugin" / module).read_text(encoding="utf-8"))
        for number, node in enumerate(_nodes(tree)):
            found += [Change(module, number, variant) for variant in range(len(_variants(node)))]
    random.Random(seed).shuffle(found)
    return found


def main() -> None:
    """Print what survives; the whole table is in a file."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--module", choices=MODULES, action="append", help="all of them unless given")
    asked = parser.parse_args()
    WORK.mkdir(parents=True, exist_ok=True)
    os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = str(WORK / "hypothesis")
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    for name in PRELOADED:
        importlib.import_module(name)
    if failed := noticed(None, FOLDERS):
        sys.exit(f"without any change this test fails: {failed}")
    changes = drawn(asked.module or list(MODULES), asked.seed)
    rows: list[str] = []
    killed = 0
    for change in changes[: asked.count]:
        _, line, what = change.applied()
        by = noticed(change, (MODULES[change.module], *FOLDERS))
        killed += bool(by)
        rows.append(f"| {change.module}:{line} | {what} | {by or '**survives**'} |")
        head = f"{killed} of {len(rows)} changes are noticed (seed {asked.seed}, of {len(changes)}).\n\n"
        table = head + "| place | change | noticed by |\n|---|---|---|\n" + "\n".join(rows) + "\n"
        (WORK / "table.md").write_text(table, encoding="utf-8")
        if not by:
            sys.stderr.write(rows[-1] + "\n")
    sys.stderr.write(f"{killed} of {len(rows)} noticed: {WORK / 'table.md'}\n")


if __name__ == "__main__":
    main()
