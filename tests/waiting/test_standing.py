"""Where the work stands, in words, and what ``progress=True`` prints of it."""

import io
import sys

import pytest

import wct_plugin as wct
from wct_plugin.progress import Progress
from wct_plugin.waiting import printed
from wct_plugin.waiting.printed import told
from wct_plugin.waiting.standing import Standing, clock_time, roughly


class Clock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


def test_a_line_names_stage_phase_bad_tets_and_times():
    clock = Clock()
    standing = Standing(clock)
    standing.hear(Progress("reading part.msh", 0.0, number=1, count=3))
    clock.now += 40.0
    standing.hear(Progress("moving vertices", 0.0, 40, number=2, count=3))
    clock.now += 12.0
    standing.hear(Progress("moving vertices", 0.25, 34, number=2, count=3))
    assert standing.line() == "stage 2 of 3: moving vertices, 34 bad tets left, 0:52, about 35 s left"
    assert standing.fraction() == 0.25


def test_without_a_pipeline_there_is_no_number_of_a_stage():
    standing = Standing(Clock())
    standing.hear(Progress("moving vertices", 0.0, 1))
    assert standing.line() == "moving vertices, 1 bad tet left, 0:00"
    assert standing.fraction() is None


def test_what_is_done_never_becomes_less():
    clock = Clock()
    standing = Standing(clock)
    for done in (0.5, 0.2, 0.6):
        clock.now += 1.0
        standing.hear(Progress("weighing vertices", done))
        assert standing.fraction() >= 0.5


@pytest.mark.parametrize(
    ("seconds", "clock", "about"),
    [
        (3, "0:03", "a few seconds"),
        (52, "0:52", "about 50 s"),
        (724, "12:04", "about 12 min"),
        (5400, "1:30:00", "about 1.5 h"),
    ],
)
def test_times_in_words(seconds, clock, about):
    assert clock_time(seconds) == clock
    assert roughly(seconds) == about


# --- printed --------------------------------------------------------------------------------------------------------


class Terminal(io.StringIO):
    def isatty(self):
        return True


def work(progress):
    return wct.apply_filter("apply_coord_well_centering", wct.apply_filter("create_cube")[0], progress=progress)


def test_on_a_terminal_one_line_is_written_over_and_taken_away(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    work(True)
    shown = terminal.getvalue()
    assert "moving vertices" in shown
    assert "\n" not in shown
    assert shown.endswith("\r")


def test_elsewhere_there_is_a_line_now_and_then(monkeypatch, capsys):
    work(True)
    assert capsys.readouterr().err == ""  # it took no half minute
    monkeypatch.setattr(printed, "LINES", 0.0)
    work(True)
    assert all(line.startswith("moving vertices") for line in capsys.readouterr().err.splitlines())


@pytest.mark.parametrize("choice", [None, False])
def test_nothing_is_printed_unasked(choice, monkeypatch, capsys):
    monkeypatch.setattr(printed, "LINES", 0.0)
    work(choice)
    assert capsys.readouterr() == ("", "")


def test_a_function_is_called_as_it_is():
    with told(print) as callback:
        assert callback is print


def test_pipelines_print_too(monkeypatch, capsys):
    monkeypatch.setattr(printed, "LINES", 0.0)
    cube, _ = wct.apply_filter("create_cube")
    (wct.Reader(cube) | wct.Filter.apply_coord_well_centering()).execute(progress=True)
    wct.Pipeline(wct.Filter.apply_coord_well_centering().steps).apply(cube, progress=True)
    wct.optimize(cube, progress=True)
    lines = capsys.readouterr().err.splitlines()
    assert any(line.startswith("stage 2 of 2: moving vertices") for line in lines)
    assert lines[0].startswith("stage 1 of 2: reading")
