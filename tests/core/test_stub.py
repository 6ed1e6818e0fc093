"""The stub of the compiled module is what nanobind's stubgen makes of its docstrings: ``make docs`` writes it."""

import ast
from pathlib import Path

from nanobind.stubgen import StubGen

import wct_plugin
from wct_plugin.core import _core


def test_it_is_made_from_the_module():
    made = StubGen(_core)
    made.put(_core)
    written = Path(wct_plugin.__file__).parent / "core" / "_core.pyi"
    assert ast.dump(ast.parse(written.read_text(encoding="utf-8"))) == ast.dump(ast.parse(made.get()))


def test_every_function_has_types_and_a_docstring():
    found = [one for one in vars(_core).values() if callable(one)]
    assert len(found) >= 15
    for function in found:
        signature, _, text = function.__doc__.partition("\n\n")
        assert "object" not in signature
        assert "->" in signature
        assert text
