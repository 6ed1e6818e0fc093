"""Meshio is the user's too: reading and writing alters nothing in it, and one module of ours imports it."""

import ast
import importlib
import pkgutil
import sys
import warnings
from pathlib import Path
from types import ModuleType
from typing import Any

import meshio

import wct_plugin
from wct_plugin.errors import WctWarning
from wct_plugin.io import read, write
from wct_plugin.io.formats import FORMATS
from wct_plugin.mesh import TetMesh


def state() -> dict[str, Any]:
    """Every object in every module of meshio: itself, what it contains, and the code it runs."""
    found: dict[str, Any] = {}
    for name, module in sorted(sys.modules.items()):
        if name != "meshio" and not name.startswith("meshio."):
            continue
        for key, item in vars(module).items():
            if key == "__builtins__" or isinstance(item, ModuleType):
                continue
            found[f"{name}.{key}"] = (id(item), _content(item))
    return found


def _content(item: Any) -> Any:
    if isinstance(item, (dict, list, set, tuple, str, int)):
        return repr(item)
    if isinstance(item, type):
        return {key: (id(value), id(getattr(value, "__code__", None))) for key, value in vars(item).items()}
    code = getattr(item, "__code__", None)
    return (id(code), repr(item.__defaults__)) if code else None


def test_nothing_in_meshio_is_altered(full: TetMesh, tmp_path: Path) -> None:
    for module in pkgutil.walk_packages(meshio.__path__, "meshio."):
        importlib.import_module(module.name)
    before = state()
    assert len(before) > 500
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", WctWarning)
        for form in FORMATS:
            for suffix in form.suffixes if form.writes else ():
                mesh = full if form.volume else full.boundary_surface()
                write(tmp_path / f"part{suffix}", mesh)
                read(tmp_path / f"part{suffix}")
    after = state()
    assert after.keys() == before.keys()
    assert [name for name in before if before[name] != after[name]] == []


def _imports(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.add((node.module or "").partition(".")[0])
    return found


def test_one_module_of_io_imports_meshio() -> None:
    package = Path(wct_plugin.__file__).parent
    assert [path for path in package.rglob("*.py") if "meshio" in _imports(path)] == []
    asking = [path for path in package.rglob("*.py") if 'import_module(f"meshio' in path.read_text(encoding="utf-8")]
    assert [path.name for path in asking] == ["meshio_modules.py"]
