"""A batch as one table: for the terminal, as CSV and as a page of its own; failures stand last."""

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Any

from wct_plugin.batch.job import Record
from wct_plugin.reports import html_elements
from wct_plugin.reports.printable import cell

#: Columns of the table; sizes and quality are before → after.
HEAD = ("file", "result", "tets", "3WC %", "CWC %", "min h/R", "seconds")
#: What each exit code means.
RESULTS = ("done", "goal missed", "failed")
#: Columns of the CSV file: of the record itself, creases given up and what else was not kept, numbers before and after.
_FIELDS = ("input", "output", "exit_code", "cause", "seconds", "cpu_seconds", "peak_bytes")
_METRICS = ("released", "losses")
_NUMBERS = ("points", "triangles", "tets", "3wc", "cwc", "min_height", "max_dihedral_angle")


def ordered(records: Sequence[Record]) -> list[Record]:
    """The records by input, those done first, failures last."""
    return sorted(records, key=lambda record: (record.exit_code, record.input))


def headline(records: Sequence[Record]) -> str:
    """How many there are of each result."""
    counts = [sum(record.exit_code == code for record in records) for code in range(len(RESULTS))]
    parts = [f"{count} {word}" for count, word in zip(counts, RESULTS, strict=True) if count]
    return f"{len(records)} file{'s' * (len(records) > 1)}: {', '.join(parts)}" if parts else "no files"


def row(record: Record) -> tuple[str, ...]:
    """A record's cells under :data:`HEAD`."""
    before, after = record.before or {}, record.after or {}
    return (
        record.input,
        RESULTS[record.exit_code],
        _change(before, after, "tets", "{:d}"),
        _change(before, after, "3wc", "{:.1f}"),
        _change(before, after, "cwc", "{:.1f}"),
        _change(before, after, "min_height", "{:.3f}"),
        f"{record.seconds:.1f}",
    )


def _change(before: Mapping[str, Any], after: Mapping[str, Any], name: str, form: str) -> str:
    shown = [form.format(side[name]) for side in (before, after) if side.get(name) is not None]
    return " → ".join(dict.fromkeys(shown)) or "-"


def causes(records: Sequence[Record]) -> list[tuple[str, str]]:
    """Input and cause of each failure."""
    return [(record.input, record.cause or "") for record in ordered(records) if record.failed]


def to_csv(records: Sequence[Record]) -> str:
    """One line per file under a line of names; what a file has no number for is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*_FIELDS, *_METRICS, *(f"{name}_{side}" for name in _NUMBERS for side in ("before", "after"))])
    for record in ordered(records):
        sides = (record.before or {}, record.after or {})
        numbers = [side.get(name, "") for name in _NUMBERS for side in sides]
        own = ["" if (value := getattr(record, name)) is None else value for name in _FIELDS]
        writer.writerow(map(cell, [*own, *_not_kept(record), *numbers]))
    return text.getvalue()


def _not_kept(record: Record) -> tuple[str, str]:
    """How many creases the last filter that says so gave up, and its losses in words; empty where none says."""
    for found in reversed(list(record.metrics.values())):
        if "losses" in found:
            creases = str(found["released"]["creases"]) if "released" in found else ""  # Delaunay goals give up none
            return creases, "; ".join(loss["text"] for loss in found["losses"])
    return "", ""


def to_html(records: Sequence[Record], title: str) -> str:
    """One page that needs nothing else."""
    body = [
        html_elements.paragraph(headline(records)),
        html_elements.table("Files", HEAD, [row(record) for record in ordered(records)], words=True),
    ]
    if failed := causes(records):
        body.append(
            html_elements.section("Failed", html_elements.table("Causes", ("file", "cause"), failed, words=True))
        )
    return html_elements.page(title, body)
