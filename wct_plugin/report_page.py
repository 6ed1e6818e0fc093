"""Reports as one self-contained HTML page."""

from collections.abc import Sequence
from html import escape
from io import StringIO
from pathlib import PurePath

from wct_plugin import certificate
from wct_plugin.errors import WctError
from wct_plugin.report import BINS, TITLES, Report

_STYLE = """
:root { color-scheme: light dark; --line: #8886; --soft: #8882; --good: #1a7f37; --bad: #cf222e; }
@media (prefers-color-scheme: dark) { :root { --good: #3fb950; --bad: #ff7b72; } }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 76rem; margin: 2rem auto; padding: 0 1rem;
  color: light-dark(#1f2328, #e6edf3); background: light-dark(#fff, #0d1117); }
h1 { font-size: 1.5rem; } h2 { font-size: 1.1rem; margin-top: 2rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .9rem; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
thead th { background: var(--soft); }
.yes { color: var(--good); } .no { color: var(--bad); }
svg { width: 100%; height: auto; }
"""
#: Stands for the page's own text colour in the figure; no other element uses it.
_INK = "#010203"
#: What matplotlib would write into the figure, links and the date among it.
_METADATA = ("Creator", "Date", "Format", "Type")
_COLOURS = ("#8c959f", "#2f81f7", "#d29922", "#3fb950", "#db61a2", "#a371f7")


def html(reports: Sequence[Report], title: str) -> str:
    """One self-contained page, the reports side by side; nothing in it is loaded from elsewhere.

    Raises :class:`wct_plugin.errors.WctError` without matplotlib, which draws the histograms.
    """
    if not reports:
        raise ValueError("a page needs at least one report")
    names = [f"{k + 1}: {PurePath(r.source).name or 'mesh'}" for k, r in enumerate(reports)]
    body = [
        f"<h1>{escape(title)}</h1>",
        _side_by_side("Summary", names, [[(name, [value]) for name, value in r.rows_summary()] for r in reports], [""]),
        _side_by_side("Tiers", names, [[(name, [yes]) for name, yes, _ in r.rows_tiers()] for r in reports], [""]),
        _side_by_side(
            "Ranges", names, [[(n, [low, high]) for n, low, high in r.rows_ranges()] for r in reports], ["min", "max"]
        ),
        _side_by_side(
            "Well-centered tets",
            names,
            [[(n, [c, p]) for n, c, p in r.rows_flags()] for r in reports],
            ["tets", "percent"],
        ),
        f"<h2>Histograms</h2>{_figure(reports, names)}",
        _side_by_side(
            "Where the bad tets are",
            names,
            [[(n, list(row)) for n, *row in r.rows_places()] for r in reports],
            ["tets", "not 3WC", "not CWC"],
        ),
    ]
    for name, report in zip(names, reports, strict=True):
        if left := report.left(most=100):
            title_left, head, rows = left
            body.append(f"<h2>What is left, {escape(name)}</h2><p>{escape(title_left)}</p>{_table([head], rows)}")
        body += [f"<p>{escape(note)}</p>" for note in report.notes]
        if report.worst:
            body.append(f"<h2>Worst tets, {escape(name)}</h2>{_table([report.worst_head()], report.rows_worst())}")
        if report.certificate:
            title_exact = f"Exact certificate, {name}: {report.certificate.headline()}"
            body.append(f"<h2>{escape(title_exact)}</h2>{_table([certificate.HEAD], report.certificate.rows())}")
            body += [f"<p>{escape(line)}</p>" for line in report.certificate.lines()]
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>{_STYLE}</style></head>\n<body>{''.join(body)}</body></html>\n"
    )


def check_available() -> None:
    """Raise :class:`wct_plugin.errors.WctError` without matplotlib."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise WctError("the HTML page needs matplotlib: pip install 'wct_plugin[report]'") from None


def _side_by_side(title: str, names: list[str], tables: list[list[tuple[str, list[str]]]], columns: list[str]) -> str:
    """The reports' rows joined by name; ``columns`` are repeated for each report."""
    head = [["", *(name for name in names for _ in columns)]]
    if any(columns):
        head.append(["", *columns * len(names)])
    rows = [
        [first[0], *(cell for _, cells in (first, *rest) for cell in cells)]
        for first, *rest in zip(*tables, strict=True)
    ]
    return f"<h2>{escape(title)}</h2>{_table(head, rows)}"


def _table(head: Sequence[Sequence[str]], rows: Sequence[Sequence[str]]) -> str:
    top = "".join("<tr>" + "".join(f"<th>{escape(cell)}</th>" for cell in row) + "</tr>" for row in head)
    kind = {"yes": ' class="yes"', "no": ' class="no"'}
    body = "".join(
        "<tr>" + "".join(f"<td{kind.get(cell, '')}>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f'<div class="scroll"><table><thead>{top}</thead><tbody>{body}</tbody></table></div>'


def _figure(reports: Sequence[Report], names: list[str]) -> str:
    """The three histograms as inline SVG, the reports over one another, in percent of each mesh's own."""
    check_available()
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    style = rc_context(
        {
            "text.color": _INK,
            "axes.edgecolor": _INK,
            "axes.labelcolor": _INK,
            "xtick.color": _INK,
            "ytick.color": _INK,
            "font.size": 9,
            "svg.fonttype": "none",  # text stays text, in the page's font
            "svg.hashsalt": "wct",  # the same reports give the same page
            "text.parse_math": False,  # a $ in a file name is a $
        }
    )
    with style:
        figure = Figure(figsize=(12.0, 3.4), layout="constrained")
        for axes, (name, bins) in zip(figure.subplots(1, len(BINS)), BINS.items(), strict=True):
            for k, (report, label) in enumerate(zip(reports, names, strict=True)):
                share = 100.0 * report.histograms[name] / max(int(report.histograms[name].sum()), 1)
                axes.stairs(share, bins, fill=True, alpha=0.45, color=_COLOURS[k % len(_COLOURS)], label=label)
            axes.set_title(TITLES[name])
            axes.set_ylabel("percent")
            axes.set_facecolor("none")
            axes.set_xticks(bins[:: (len(bins) - 1) // 4])
            axes.axvline(0.0 if name == "h/R" else 90.0, color=_INK, linewidth=0.8, linestyle=":")
        figure.legend(
            *figure.axes[0].get_legend_handles_labels(),
            loc="outside lower center",
            ncols=min(len(reports), 4),
            frameon=False,
        )
        image = StringIO()
        figure.savefig(image, format="svg", transparent=True, metadata=dict.fromkeys(_METADATA))
    drawing = image.getvalue()
    return drawing[drawing.index("<svg") :].replace(_INK, "currentColor")
