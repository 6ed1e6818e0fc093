"""Public names come when they are asked for, and what is imported for a little is little."""

import inspect
import os
import subprocess
import sys
from importlib import import_module

import pytest

import wct_plugin as wct
from wct_plugin.cli.commands import COMMANDS
from wct_plugin.cli.main import cli

#: What takes long to import and is needed by none of the cases below.
HEAVY = ("scipy", "matplotlib", "pyvista", "pymeshlab", "pytetwild", "h5py", "netCDF4")
_ASK = "import sys; {code}; print(*[name for name in {names!r} if name in sys.modules])"


def loaded(code: str, names: tuple[str, ...], environment: dict[str, str] | None = None) -> set[str]:
    """Which of the modules are imported in a fresh process that does this."""
    command = [sys.executable, "-c", _ASK.format(code=code, names=names)]
    done = subprocess.run(
        command, capture_output=True, text=True, check=True, env=os.environ | (environment or {}), timeout=60
    )
    return set(done.stdout.splitlines()[-1].split()) if done.stdout.strip() else set()


def test_every_public_name_is_there():
    assert set(wct._HOMES) == set(wct.__all__)
    for name in wct.__all__:
        assert getattr(wct, name) is getattr(import_module(wct._HOMES[name]), name)
    assert set(wct.__all__) <= set(dir(wct))


def test_other_names_are_not():
    with pytest.raises(AttributeError, match="'wct_plugin' has no attribute 'nothing'"):
        _ = wct.nothing


def test_the_package_alone_is_light():
    assert loaded("import wct_plugin", ("numpy", "pydantic", "meshio", *HEAVY)) == set()


def test_reading_a_mesh_takes_no_filters_and_no_scipy(tmp_path):
    mesh, _ = wct.apply_filter("create_cube", variant="84")
    wct.write(tmp_path / "cube.vtu", mesh)
    code = f"import wct_plugin; wct_plugin.read({str(tmp_path / 'cube.vtu')!r})"
    assert loaded(code, ("pydantic", "click", "numpy", *HEAVY)) == {"numpy"}


@pytest.mark.parametrize("words", ["--help", "--version"])
def test_the_list_of_commands_imports_none_of_them(words):
    code = f"from wct_plugin.cli.main import run; sys.argv = ['wct', {words!r}]; run()"
    assert loaded(code, ("numpy", "pydantic", "meshio", *HEAVY)) == set()


@pytest.mark.parametrize(
    ("typed", "found", "light"),
    [
        ("wct op", ["optimize"], ("numpy", "pydantic", *HEAVY)),
        ("wct optimize --tol", ["--tolerance"], HEAVY),
    ],
)
def test_a_completion_imports_what_it_needs(typed, found, light):
    asked = {"_WCT_COMPLETE": "bash_complete", "COMP_WORDS": typed, "COMP_CWORD": str(typed.count(" "))}
    code = "import atexit; from wct_plugin.cli.main import cli\n"
    code += f"atexit.register(lambda: print('loaded', *[name for name in {light!r} if name in sys.modules]))\n"
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; {code}cli(prog_name='wct')"],
        capture_output=True,
        text=True,
        env=os.environ | asked,
        timeout=60,
    )
    *completions, last = done.stdout.splitlines()
    assert [line.split(",")[1] for line in completions] == found
    assert last == "loaded"


@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_says_what_each_command_says_itself(name):
    command = cli.get_command(None, name)
    told = " ".join(inspect.cleandoc(command.help).split("\n\n")[0].split())
    assert told.startswith(COMMANDS[name].summary)
    assert COMMANDS[name].summary.endswith(".")
    assert COMMANDS[name].example in command.epilog
