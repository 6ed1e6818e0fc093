"""C++ folders include downwards only, by the table in docs/developing.md; nothing is built for it."""

import re
from pathlib import Path

CPP = Path(__file__).parents[2] / "cpp"

#: A folder includes its own files and those of lines below its own; folders on one line do not know each other.
LAYERS = (
    {"bindings", "library"},
    {"conform"},
    {"refill"},
    {"sampling"},
    {"domain", "delaunay", "search", "move_vertices", "measure"},
    {"energy", "geometry"},
    {"base"},
)
_LAYER = {folder: number for number, folders in enumerate(LAYERS) for folder in folders}
_INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)
_NAMESPACE = re.compile(r"^namespace (wct[\w:]*) \{", re.MULTILINE)


def upward(folder: str, included: str) -> bool:
    """Whether a file in ``folder`` may not include one in the folder ``included``."""
    return folder != included and _LAYER[included] <= _LAYER[folder]


def sources() -> list[Path]:
    return sorted(path for path in CPP.rglob("*") if path.suffix in (".cpp", ".h"))


def test_every_folder_has_its_layer():
    assert {path.name for path in CPP.iterdir() if path.is_dir()} == set(_LAYER)
    assert len(sources()) > 100


def test_includes_name_their_folder_and_point_downwards():
    wrong = []
    for path in sources():
        folder = path.parent.name
        for name in _INCLUDE.findall(path.read_text(encoding="utf-8")):
            if not (CPP / name).is_file() or upward(folder, name.split("/")[0]):
                wrong.append(f"{path.relative_to(CPP)} includes {name}")
    assert wrong == []


def test_a_file_declares_in_the_namespace_of_its_folder():
    wrong = []
    for path in sources():
        folder = path.parent.name
        allowed = {"base": {"wct"}, "library": {"wct", "wct::library"}}.get(folder, {f"wct::{folder}"})
        found = set(_NAMESPACE.findall(path.read_text(encoding="utf-8")))
        if not found <= allowed:
            wrong.append(f"{path.relative_to(CPP)} declares in {sorted(found - allowed)}")
    assert wrong == []


def test_an_include_upwards_would_be_found():
    assert upward("geometry", "search")
    assert upward("search", "sampling")
    assert upward("search", "domain")  # on one line: they do not know each other
    assert upward("library", "bindings")
    assert not upward("search", "geometry")
    assert not upward("search", "search")
