"""What ``wct`` prints of reports, results and filters, as tables; and text files."""

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import click
from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from wct_plugin.certify import certificate
from wct_plugin.cli.messages import out
from wct_plugin.io import atomic_files
from wct_plugin.io.standard_streams import STREAM, check_stdout, writing_stdout
from wct_plugin.measure.negative_duals import HEAD as NEGATIVE_HEAD
from wct_plugin.measure.solver_view import HEAD as SOLVER_HEAD
from wct_plugin.pipeline import stage_page
from wct_plugin.pipeline.result import Result
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.reports.report import Report, short_names
from wct_plugin.reports.text_histograms import text_histograms

# --- files ----------------------------------------------------------------------------------------------------------


def write_text(path: str, text: str) -> None:
    """Write a text file, or to stdout where ``path`` is ``-``."""
    if path == "-":
        check_stdout()
        with writing_stdout():
            click.echo(text)
        return
    with atomic_files.replacing(Path(path)) as temporary:
        temporary.write_text(text, encoding="utf-8")


def check_apart(sources: Iterable[str], *outputs: str | None) -> None:
    """Refuse an output that would take the place of a source or of another output."""
    taken = {os.path.realpath(source) for source in sources if source != STREAM}
    for path in outputs:
        if path is None:
            continue
        where = path if path == STREAM else os.path.realpath(path)
        if where in taken:
            raise click.UsageError(f"{path!r} is given twice; an output needs a name of its own")
        taken.add(where)


def writes_over(source: str, target: str, *, allowed: bool) -> bool:
    """Whether the output takes the place of the input, which is refused unless it is ``allowed``."""
    same = STREAM not in (source, target) and os.path.realpath(source) == os.path.realpath(target)
    if same and not allowed:
        raise click.UsageError(f"{target!r} is the input too; --force writes over it")
    return same


def check_outputs(*paths: str | None) -> None:
    """Find out before the work whether these can be written."""
    for path in paths:
        if path not in (None, "-"):
            atomic_files.check_writable(Path(path))


# --- tables ---------------------------------------------------------------------------------------------------------


def print_table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]], *, left: bool = False) -> None:
    """A table whose columns but the first stand to the right, unless ``left``; its title may be wider than it is."""
    made = Table(box=SIMPLE_HEAD, show_header=any(head))
    for index, name in enumerate(head):
        made.add_column(Text(name), justify="left" if index == 0 or left else "right", overflow="fold")
    for row in rows:
        made.add_row(*(Text(cell) for cell in row))
    out.print(Text(title, style="bold"))
    out.print(made)


_MORE = "--full prints all: tiers, duals, places, histograms, the worst tets"


def print_short(reports: Sequence[Report], *, worst: bool) -> None:
    """What fits a screen; with the ``worst`` tets if they were asked for."""
    for report in reports:
        out.print(Text(report.headline(), style="bold"))
    summaries = [one.rows_summary() for one in reports]
    names = short_names(reports) if len(reports) > 1 else [""]
    rows = [(one[0][0], *(value for _, value in one)) for one in zip(*summaries, strict=True)]
    print_table("Summary", ("", *names), rows)
    for name, report in zip(names, reports, strict=True):
        for note in report.notes:
            out.print(Text(": ".join(filter(None, (name, note)))))
        if worst and report.worst:
            print_table(f"Worst tets{name and f', {name}'}", report.worst_head(), report.rows_worst())
        elif report.worst:
            out.print(Text(": ".join(filter(None, (name, report.worst_line())))))
        _print_certificate(report, name and f", {name}")
    out.print(Text(_MORE))


def print_report(report: Report) -> None:
    """Everything a report has."""
    out.print(Text(report.headline(), style="bold"))
    print_table("Ranges", ("", "min", "max"), report.rows_ranges())
    print_table("Well-centered", ("", "tets", "percent"), report.rows_flags())
    print_table("Tiers", ("", "", ""), report.rows_tiers(), left=True)
    print_table("Negative duals", NEGATIVE_HEAD, report.negative_duals.rows())
    print_table("What solvers see", SOLVER_HEAD, report.solver_view.rows())
    print_table("Where the bad tets are", ("", "tets", "not 3WC", "not CWC"), report.rows_places())
    _print_histograms([report], "", 40)
    if report.worst:
        print_table("Worst tets", report.worst_head(), report.rows_worst())
    _print_certificate(report, "")


def print_side_by_side(reports: Sequence[Report]) -> None:
    """What reports say, in columns."""
    names = short_names(reports)
    for number, report in enumerate(reports, start=1):
        out.print(Text(f"{number}: {report.headline()}", style="bold"))

    def beside(title: str, tables: Sequence[Sequence[Sequence[str]]]) -> None:
        rows = [(one[0][0], *(row[1] for row in one)) for one in zip(*tables, strict=True)]
        print_table(title, ("", *names), rows)

    beside("Summary", [one.rows_summary() for one in reports])
    beside("Tiers", [one.rows_tiers() for one in reports])
    for k, where in ((1, "inside"), (2, "on the boundary")):
        beside(f"Negative duals {where}", [[(r[0], r[k]) for r in one.negative_duals.rows()] for one in reports])
    for name, one in zip(names, reports, strict=True):
        if len(one.regions) > 1:  # else all is in the summary
            print_table(f"What solvers see, {name}", SOLVER_HEAD, one.solver_view.rows())
    for k, kind in ((2, "not 3WC"), (3, "not CWC")):
        beside(f"Where the tets are that are {kind}", [[(r[0], r[k]) for r in one.rows_places()] for one in reports])
    share = out.width // len(reports)
    _print_histograms(reports, "; ".join(names), min(max(share - 12, 6), 40))
    for name, report in zip(names, reports, strict=True):
        if report.worst:
            print_table(f"Worst tets, {name}", report.worst_head(), report.rows_worst())
        _print_certificate(report, f", {name}")


def _print_certificate(report: Report, name: str) -> None:
    if report.certificate:
        title = f"Exact certificate{name}, {report.certificate.headline()}"
        print_table(title, certificate.HEAD, report.certificate.rows())
        for line in report.certificate.lines():
            out.print(Text(line), soft_wrap=True)


def _print_histograms(reports: Sequence[Report], names: str, width: int) -> None:
    for title, lines in text_histograms(reports, width):
        out.print(Text(f"{title}: {names}" if names else title, style="bold"))
        for line in lines:
            out.print(Text(line))


def print_before_after(before: Report, after: Report) -> None:
    """Two reports side by side, and what is left to do in the second one."""
    rows = [(name, old, new) for (name, old), (_, new) in zip(before.rows_summary(), after.rows_summary(), strict=True)]
    print_table(f"{before.source} -> {after.source}", ("", "before", "after"), rows)
    if left := after.left():
        print_table(*left, left=True)
    for line in after.why():
        out.print(Text(line))
    for note in after.notes:
        out.print(Text(note))


def print_result(result: Result) -> None:
    """Each stage of a pipeline with its seconds and mesh, and which goals were met."""
    rows = [(one.stage.type(), one.tag, f"{one.seconds:.1f}", one.size()) for one in result.stages]
    print_table("Stages", ("stage", "tag", "seconds", "mesh"), rows, left=True)
    for goal in result.goals:
        out.print(Text(str(goal)))


def print_metrics(title: str, metrics: Mapping[str, Any]) -> None:
    """What a filter found out, a line per metric."""
    rows = [(name.replace("_", " "), _shown(value)) for name, value in metrics.items()]
    print_table(title, ("", ""), rows)


def _shown(value: Any) -> str:
    match value:
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:.4g}"
        case list() | tuple():
            return ", ".join(f"({_shown(item)})" if isinstance(item, list) else _shown(item) for item in value)
        case _:
            return str(value)


def print_page(stage: type[FilterStage[Options]]) -> None:
    """One filter's page."""
    out.print(Text(stage.type(), style="bold"), Text(f"({stage_page.takes_and_gives(stage)})"))
    out.print(Text(stage_page.about(stage)))
    print_table("Options", ("option", "default", "allowed", "what"), stage_page.option_rows(stage), left=True)
    out.print(Text("Example", style="bold"))
    for line in stage_page.example_lines(stage):
        out.print(Text(line), soft_wrap=True)
