"""What docstrings and comments refer to by ``:mod:``, ``:func:`` and their like is there, under that name."""

import ast
import builtins
import re
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FILES = sorted(path for folder in ("wct_plugin", "filters") for path in (ROOT / folder).rglob("*.py"))
#: Other packages, whose names are not looked up.
ELSEWHERE = sys.stdlib_module_names | {"pyvista"}
_ROLE = re.compile(r":(?:mod|func|class|meth|attr|data|exc):`~?([\w.\s]+)`")


def source(module: str) -> Path | None:
    """The file of a module of the package."""
    path = ROOT / module.replace(".", "/").replace("wct_plugin/filters", "filters", 1)
    found = [one for one in (path.with_suffix(".py"), path / "__init__.py", path.with_suffix(".pyi")) if one.is_file()]
    return found[0] if found else None


@cache
def names(path: Path) -> frozenset[str]:
    """What a file defines or imports, and the members of its classes, bare and as ``Class.member``."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        match node:
            case ast.ClassDef(name=name, body=body):
                members = {named for one in body for named in named_by(one)}
                found |= {name, *members, *(f"{name}.{member}" for member in members)}
            case ast.FunctionDef(name=name):
                found.add(name)
            case ast.Import(names=aliases) | ast.ImportFrom(names=aliases):
                found |= {alias.asname or alias.name for alias in aliases}
            case ast.Assign() | ast.AnnAssign():
                found |= set(named_by(node))
    return frozenset(found)


def defined(path: Path) -> set[str]:
    """The classes of a file: of an imported one it is not known here what it has."""
    return {node.name for node in ast.parse(path.read_text(encoding="utf-8")).body if isinstance(node, ast.ClassDef)}


def named_by(node: ast.stmt) -> list[str]:
    match node:
        case ast.FunctionDef(name=name) | ast.AnnAssign(target=ast.Name(id=name)):
            return [name]
        case ast.Assign(targets=targets):
            return [target.id for target in targets if isinstance(target, ast.Name)]
    return []


def is_there(target: str, path: Path) -> bool:
    if target.startswith("."):
        folders = path.relative_to(ROOT).parent.parts
        target = ".".join(folders if folders[0] == "wct_plugin" else ("wct_plugin", *folders)) + target
    if not target.startswith("wct_plugin."):
        first, _, member = target.partition(".")
        known = names(path) | (ELSEWHERE if member else set(dir(builtins)))
        return target in known or (bool(member) and first in known - defined(path))
    parts = target.split(".")
    for end in range(len(parts), 0, -1):
        if module := source(".".join(parts[:end])):
            return end == len(parts) or ".".join(parts[end:]) in names(module)
    return False


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_names_lead_somewhere(path: Path) -> None:
    targets = [re.sub(r"\s", "", target) for target in _ROLE.findall(path.read_text(encoding="utf-8"))]
    assert [target for target in targets if not is_there(target, path)] == []


@pytest.mark.parametrize(
    "target",
    [".starts", "wct_plugin.mesh.surface", "wct_plugin.mesh.strata.strata", "no_such", "old.name", "TetMesh.no_such"],
)
def test_a_name_that_is_gone_would_be_found(target: str) -> None:
    assert not is_there(target, ROOT / "wct_plugin/mesh/mesh.py")
    assert is_there("wct_plugin.mesh.strata.find_strata", ROOT / "wct_plugin/mesh/mesh.py")
