"""The command line at hand: examples, --quiet, pipes, colours, narrow terminals and completion, for every command."""

import json
import os
import pty
import re
import shlex
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import click
import pytest
from support.builders import jittered_cube
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main, output, progress_bar
from wct_plugin.cli.commands import COMMANDS

WCT = Path(sys.executable).with_name("wct")
#: What each command that works on files can be given here.
WORK = {
    "batch": ["batch", "chain.json", "cube.vtu", "-o", "out"],
    "filters": ["filters", "meshing_well_centered"],
    "optimize": ["optimize", "cube.vtu", "out.vtu", "--filter", "apply_coord_well_centering"],
    "report": ["report", "cube.vtu"],
    "run": ["run", "chain.json", "cube.vtu", "out.vtu"],
}


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wct.write("cube.vtu", jittered_cube(4))
    Path("chain.json").write_text(json.dumps([{"type": "filters.get_quality"}]))
    return tmp_path


def on_a_terminal(arguments, **environment):
    """What is printed on a terminal, escape sequences and all."""
    ours, theirs = pty.openpty()
    clean = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "COLUMNS", "FORCE_COLOR")}
    child = subprocess.Popen(
        [WCT, *arguments], stdout=theirs, stderr=theirs, env=clean | {"TERM": "xterm-256color"} | environment
    )
    os.close(theirs)
    shown = b""
    with suppress(OSError):  # the terminal is gone when the child is
        while part := os.read(ours, 65536):
            shown += part
    os.close(ours)
    child.wait(60)
    return shown.decode()


# --- help -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", COMMANDS)
def test_help_ends_with_an_example_that_the_command_takes(name, capsys):
    assert main.run([name, "--help"]) == 0
    shown = capsys.readouterr().out
    assert "--quiet" in shown
    (line,) = re.findall(r"Example:\n  +(wct .*)\n", shown)
    assert line == COMMANDS[name].example
    program, command, *arguments = shlex.split(line.partition(" > ")[0])
    assert (program, command) == ("wct", name)
    if "--help" not in arguments:
        main.cli.get_command(None, name).make_context(name, arguments)  # parses, runs nothing


def test_each_creation_has_an_example_that_it_takes(capsys):
    context = click.Context(main.cli.get_command(None, "create"))
    names = main.cli.get_command(None, "create").list_commands(context)
    assert names
    for name in names:
        assert main.run(["create", name, "--help"]) == 0
        shown = capsys.readouterr().out
        (line,) = re.findall(r"Example:\n  +(wct .*)\n", shown)
        command = main.cli.get_command(None, "create").get_command(context, name)
        command.make_context(name, shlex.split(line)[3:])
        assert "--quiet" in shown


def test_help_lists_every_command_with_what_it_does(capsys):
    assert main.run(["--help"]) == 0
    shown = capsys.readouterr().out
    for name in COMMANDS:
        assert re.search(rf"^  {name}  +\w+", shown, re.M)


# --- quiet ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", WORK)
def test_quiet_prints_nothing_and_does_the_same(name, place, capfd):
    assert main.run([*WORK[name], "--quiet"]) in (0, 1)
    assert capfd.readouterr() == ("", "")
    made = {"batch": "out/cube.vtu", "optimize": "out.vtu", "run": "out.vtu"}
    assert name not in made or Path(made[name]).exists()


def test_quiet_stands_before_the_command_too_and_ends_with_it(place, capfd):
    assert main.run(["-q", "report", "cube.vtu"]) == 0
    assert capfd.readouterr() == ("", "")
    assert main.run(["report", "cube.vtu"]) == 0
    assert capfd.readouterr().out


def test_quiet_prints_errors_and_what_is_asked_for_on_stdout(place, capsys):
    assert main.run(["report", "-q", "none.vtu"]) == 2
    assert capsys.readouterr().err.startswith("error: none.vtu")
    assert main.run(["report", "-q", "cube.vtu", "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out)["tets"] == len(wct.read("cube.vtu").tets)


# --- pipes, colours, widths -----------------------------------------------------------------------------------------


def test_a_pipe_gets_plain_text_line_by_line(place):
    Path("bad.vtu").write_text("no")
    done = subprocess.run(
        [WCT, "batch", "chain.json", "cube.vtu", "bad.vtu", "-o", "out", "--jobs", "1"], capture_output=True, text=True
    )
    assert "\x1b" not in done.stdout + done.stderr
    first, second = done.stderr.splitlines()
    said = "cannot be read as VTU: is no XML, or truncated (syntax error: line 1, column 0)"
    assert re.fullmatch(rf"\[1/2\] bad.vtu: failed: {re.escape(said)} \(.* s\)", first)
    assert re.fullmatch(r"\[2/2\] cube.vtu: done \(.* s\)", second)
    assert done.stdout.splitlines()[-1] == f"bad.vtu: {said}"


def test_a_terminal_gets_a_bar_and_colours_unless_told_not_to(place):
    Path("bad.vtu").write_text("no")
    command = ["batch", "chain.json", "cube.vtu", "bad.vtu", "-o"]
    colour = re.compile(r"\x1b\[[0-9;]*3[0-9][0-9;]*m")
    shown = on_a_terminal([*command, "one"])
    assert colour.search(shown)
    assert "2/2" in shown
    assert "━" in shown
    shown = on_a_terminal([*command, "two"], NO_COLOR="1")
    assert not re.search(r"\x1b\[[0-9;]*m", shown)  # nor bold
    assert "bad.vtu" in shown


def test_a_terminal_is_told_stage_bad_tets_and_time(place):
    shown = on_a_terminal(["optimize", "cube.vtu", "out.vtu"], COLUMNS="80")
    plain = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown)
    assert re.search(r"stage 2 of 3: [a-z :]+, \d+ bad tets? left", plain)
    assert re.search(r"━ 0:\d\d", plain)
    assert max(len(line) for line in re.split(r"[\r\n]+", plain)) <= 80


def test_what_is_no_terminal_is_told_now_and_then(place, capsys, monkeypatch):
    monkeypatch.setattr(progress_bar, "LINES", 0.02)
    assert main.run(["optimize", "cube.vtu", "out.vtu"]) in (0, 1)
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("stage ")]
    assert any(re.match(r"stage 2 of 3: .*, 0:\d\d", line) for line in lines)


def test_verbose_prints_stages_and_their_phases(place, capsys):
    assert main.run(["optimize", "-v", "cube.vtu", "out.vtu"]) in (0, 1)
    said = capsys.readouterr().err
    assert "debug: stage 2 of 3 (filters.meshing_well_centered): resampling\n" in said
    assert re.search(r"debug: stage 3 of 3 \(writers.mesh\): \d\.\d s, out.vtu\n", said)
    assert main.run(["report", "cube.vtu"]) == 0
    assert "debug" not in capsys.readouterr().err


@pytest.mark.parametrize("name", WORK)
@pytest.mark.parametrize("width", [40, 100])
def test_no_line_is_wider_than_the_terminal(name, width, place, capsys, monkeypatch):
    monkeypatch.setattr(output.out, "_width", width)
    assert main.run(WORK[name]) in (0, 1)
    shown = capsys.readouterr().out.partition("\nExample\n")[0]  # which is to be copied, so it is not broken
    assert max(map(len, shown.splitlines())) <= width


def test_columns_count_in_a_pipe_too(place):
    widths = {}
    for given in ("50", ""):
        environment = {**os.environ, "COLUMNS": given}
        done = subprocess.run([WCT, "filters"], capture_output=True, text=True, env=environment, check=True)
        widths[given] = max(map(len, done.stdout.splitlines()))
    assert widths["50"] <= 50 < widths[""] <= 120


def test_who_reads_one_line_sees_no_error(place):
    shown = subprocess.run(f"'{WCT}' report cube.vtu | head -n 1", shell=True, capture_output=True, text=True)
    assert shown.stdout.count("\n") == 1
    assert shown.stderr == ""
    reader, writer = os.pipe()
    os.close(reader)  # who reads is gone before the first line, however busy the machine is
    cut = subprocess.run([WCT, "report", "cube.vtu"], stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert cut.stderr == ""
    assert cut.returncode == 2  # it was cut short, and says nothing of a goal


def test_nothing_asked_for_is_answered_by_the_help(capsys):
    assert main.run([]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "\nUsage" in f"\n{shown.err}"
    assert all(f"\n  {name} " in shown.err for name in COMMANDS)


def test_an_output_takes_the_place_of_no_input(place, capsys):
    before = Path("cube.vtu").read_bytes()
    cases = [
        ("report", "cube.vtu", "--json", "./cube.vtu"),
        ("report", "cube.vtu", "--html", "cube.vtu"),
        ("optimize", "cube.vtu", "out.vtu", "--json", "cube.vtu"),
        ("run", "dec-ready", "cube.vtu", "out.vtu", "--metadata", "cube.vtu"),
        ("run", "dec-ready", "cube.vtu", "out.vtu", "--metadata", "out.vtu"),
        ("report", "cube.vtu", "--json", "a.html", "--html", "a.html"),
        ("filters", "--json", "-", "--markdown", "-"),
    ]
    for case in cases:
        assert refused(capsys, *case) == f"{case[-1]!r} is given twice; an output needs a name of its own"
    assert Path("cube.vtu").read_bytes() == before


# --- completion -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_scripts_ask_wct(shell, capsys):
    assert main.run(["completion", shell]) == 0
    assert f"_WCT_COMPLETE={shell}_complete" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("wct re", "plain,report"),
        ("wct run dec", "plain,dec-ready"),
        ("wct run dec", "file,dec"),
        ("wct batch dec-ready a", "file,a"),
        ("wct filters get", "plain,get_quality"),
        ("wct report cu", "file,cu"),
        ("wct optimize a.vtu b.vtu --ref", "plain,--reference"),
        ("wct optimize a.vtu b.vtu --filter app", "plain,apply_coord_well_centering"),
        ("wct optimize a.vtu b.vtu --goal one", "plain,one-sided"),
        ("wct optimize a.vtu b.vtu --boundary k", "plain,keep"),
        ("wct optimize a.vtu b.vtu --mesher te", "plain,tetgen"),
        ("wct report a.vtu --goal 3", "plain,3wc"),
        ("wct create cube c.vtu --variant 19", "plain,194_best"),
        ("wct run dec-ready a.vtu b.vtu --set filters.mesh", "plain,filters.meshing_well_centered."),
        ("wct run dec-ready --set filters.meshing_well_centered.go", "plain,filters.meshing_well_centered.goal="),
        (
            "wct batch dec-ready --set filters.meshing_well_centered.goal=d",
            "plain,filters.meshing_well_centered.goal=delaunay",
        ),
    ],
)
def test_completion(words, expected, monkeypatch, capsys):
    monkeypatch.setenv("_WCT_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(len(words.split()) - 1))
    with pytest.raises((SystemExit, click.exceptions.Exit)):
        main.run([])
    assert expected in capsys.readouterr().out.splitlines()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["wct", "optimize", "a", "b", "--goal", "=", "3"], ["3wc"]),
        (["wct", "run", "dec-ready", "a", "b", "--set", "filters.meshing_well_centered.goal", "=", "o"], ["one-sided"]),
    ],
)
def test_bash_completes_behind_an_equals_sign_which_it_takes_for_a_word(words, expected):
    typed = " ".join(map(shlex.quote, words))
    script = (
        f"source <(wct completion bash); compopt() {{ :; }}; COMP_WORDS=({typed}); COMP_CWORD={len(words) - 1}; "
        '_wct_completion wct; printf "%s\\n" "${COMPREPLY[@]}"'
    )
    path = {**os.environ, "PATH": f"{WCT.parent}:{os.environ['PATH']}"}
    shown = subprocess.run(["bash", "-c", script], env=path, capture_output=True, text=True, check=True)
    assert shown.stdout.split() == expected
