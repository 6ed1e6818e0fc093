"""The look of our HTML pages: self-contained, on any screen from a phone's on, dark too, and in print.

A page loads nothing and runs nothing but a script it is given, which its content security policy holds it to.
Functions take plain text and escape it; only what is :data:`Html` already goes in as it is.
"""

import re
from base64 import b64encode
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from hashlib import sha256
from html import escape
from typing import NewType

from wct_plugin.reports.printable import printable

#: Markup, every piece of foreign text in it escaped.
Html = NewType("Html", str)

_STYLE = """
:root { --ink: #1c2430; --muted: #55606d; --page: #fff; --panel: #f5f7f9; --line: #d3d9e0;
  --good: #0b5394; --bad: #a63603; --bar: #4a87b8; --bar-bad: #c4500c; --zone: #a6360314; }
@media screen and (prefers-color-scheme: dark) { :root { color-scheme: dark; --ink: #e4eaf1; --muted: #a0acb9;
  --page: #12171d; --panel: #1b222b; --line: #3a4552; --good: #7dbcf0; --bad: #ffa266; --bar: #5b9bd0;
  --bar-bad: #f08446; --zone: #ffa2661c; } }
* { box-sizing: border-box; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 74rem; margin: 0 auto; padding: 1.5rem 1rem 3rem;
  color: var(--ink); background: var(--page); overflow-wrap: break-word; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0 0 .25rem; }
h2 { font-size: 1.25rem; margin: 2.5rem 0 .5rem; padding-top: .6rem; border-top: 1px solid var(--line); }
p { margin: .4rem 0; max-width: 75ch; }
.muted, figcaption { color: var(--muted); }
table .good, table .bad { white-space: nowrap; }
.good { color: var(--good); } .bad { color: var(--bad); }
ul.cards { list-style: none; margin: 1.2rem 0; padding: 0; display: grid; gap: .8rem;
  grid-template-columns: repeat(auto-fit, minmax(min(100%, 18rem), 1fr)); }
.cards li { background: var(--panel); border: 1px solid var(--line); border-left: .35rem solid var(--line);
  border-radius: .5rem; padding: .7rem .9rem; min-width: 0; }
.cards li.good { border-left-color: var(--good); color: inherit; }
.cards li.bad { border-left: .35rem double var(--bad); color: inherit; }
.cards strong { display: block; font-size: 1.6rem; line-height: 1.3; }
.cards .good strong { color: var(--good); } .cards .bad strong { color: var(--bad); }
.grid { display: grid; gap: 1rem 1.5rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 25rem), 1fr)); }
.columns { columns: 28rem 2; column-gap: 2rem; } .columns > * { break-inside: avoid; margin: 0 0 1.2rem; }
figure { margin: 0 0 .6rem; min-width: 0; }
figcaption { font-size: .9rem; }
caption { font-weight: 600; text-align: left; padding: .3rem 0; }
img, svg { display: block; max-width: 100%; height: auto; } svg { width: 100%; max-width: 36rem; }
svg text { fill: var(--ink); font: 12px system-ui, sans-serif; }
.scroll { overflow-x: auto; max-width: 100%; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .92rem; }
th, td { padding: .3rem .75rem; text-align: right; vertical-align: top; border-bottom: 1px solid var(--line); }
thead th { background: var(--panel); vertical-align: bottom; }
thead th[scope=colgroup] { text-align: center; }
tbody th { font-weight: 500; }
tbody th, thead th:first-child, .words td, .words th { text-align: left; }
.long { overflow-wrap: anywhere; }
pre { background: var(--panel); border: 1px solid var(--line); border-radius: .3rem; padding: .5rem .7rem;
  white-space: pre-wrap; overflow-wrap: anywhere; font: .9rem/1.5 ui-monospace, monospace; }
details { margin: .5rem 0; } summary { cursor: pointer; color: var(--good); }
:focus-visible { outline: 2px solid var(--good); outline-offset: 2px; }
@media (max-width: 42rem) {
  th, td { padding: .3rem .4rem; }
  table { font-size: .85rem; }
  svg text { font-size: 15px; }
  .records thead { position: absolute; clip-path: inset(50%); width: 1px; height: 1px; overflow: hidden; }
  .records, .records caption, .records tbody, .records tr { display: block; }
  .records tr { border-bottom: 1px solid var(--line); padding: .5rem 0; }
  .records th, .records td { display: grid; grid-template-columns: 8.5rem 1fr; gap: .6rem; border: 0; }
  .records th, .records td { padding: .1rem 0; }
  .records [data-name]::before { content: attr(data-name); color: var(--muted); font-weight: 400; }
}
@media (max-width: 26rem) { th, td { padding: .3rem .25rem; } table { font-size: .8rem; } }
@media print {
  body { font-size: 10.5pt; max-width: none; padding: 0; }
  .grid { grid-template-columns: 1fr 1fr; } .columns { columns: 2; } details:not([open]) { display: none; }
  table { font-size: .8rem; } th, td { padding: .2rem .4rem; }
  h2, summary, caption { break-after: avoid; } figure, .cards li, tr { break-inside: avoid; }
  .scroll { overflow: visible; } * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
"""
#: So many columns of words fit a phone.
_COLUMNS = 4
#: No word of ours is longer; names of files and options may be.
_WORD = 16
_LONG = re.compile(rf"\S{{{_WORD + 1},}}")
_SIGNS = re.compile(r"&\w+;|[_/\\.,:;=|)-]")
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


@dataclass(frozen=True)
class Script:
    """A script that a page runs."""

    code: str

    @property
    def html(self) -> Html:
        """The element; nothing in the code may end it."""
        return Html(f"<script>{self.code}</script>")

    @property
    def policy(self) -> str:
        """What allows this script alone, what it unpacks of the page itself, and the fonts in that."""
        digest = b64encode(sha256(self.code.encode()).digest()).decode("ascii")
        return f"; script-src 'sha256-{digest}' blob:; font-src data:"


def page(title: str, body: Iterable[Html], *, style: str = "", script: Script | None = None) -> str:
    """A whole page; ``body`` are its parts, after the heading; ``script``, in one of them, may run."""
    policy = _POLICY + (script.policy if script else "")
    return printable(
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
        f"<title>{escape(title)}</title>"
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>{_STYLE}{style}</style></head>\n<body><main>\n<h1>{escape(title)}</h1>\n{join(body)}\n</main></body>"
        "</html>\n"
    )


def paragraph(plain: str, kind: str = "") -> Html:
    """A paragraph; ``kind``: ``muted``, ``good`` or ``bad``."""
    return Html(f"<p{_class(kind)}>{escape(plain)}</p>")


def code(plain: str) -> Html:
    """What is typed as it is; its lines are folded where they are too long."""
    return Html(f"<pre><code>{escape(plain)}</code></pre>")


def join(parts: Iterable[Html]) -> Html:
    """One part of many."""
    return Html("\n".join(parts))


def section(title: str, *parts: Html) -> Html:
    """A heading and what stands below it."""
    return Html(f"<section><h2>{escape(title)}</h2>\n{join(parts)}</section>")


def grid(parts: Iterable[Html]) -> Html:
    """Parts side by side where there is room."""
    return Html(f'<div class="grid">{join(parts)}</div>')


def columns(parts: Iterable[Html]) -> Html:
    """Parts one after the other, in columns where there is room."""
    return Html(f'<div class="columns">{join(parts)}</div>')


def details(summary: str, *parts: Html) -> Html:
    """Parts that are folded away until asked for."""
    return Html(f"<details><summary>{escape(summary)}</summary>{join(parts)}</details>")


def image(png: bytes, size: tuple[int, int], alt: str, caption: str) -> Html:
    """A picture that the page carries itself."""
    width, height = size
    return Html(
        f'<figure><img src="data:image/png;base64,{b64encode(png).decode("ascii")}" width="{width}" height="{height}" '
        f'alt="{escape(alt)}"><figcaption>{escape(caption)}</figcaption></figure>'
    )


@dataclass(frozen=True)
class Card:
    """One finding at the top of a page."""

    label: str
    value: str
    note: str = ""
    kind: str = ""  #: ``good``, ``bad`` or neither; the words must say it too


def cards(found: Iterable[Card]) -> Html:
    """Findings side by side."""
    items = (
        f"<li{_class(card.kind)}>{escape(card.label)}<strong>{_whole(card.value)}</strong>"
        f'<span class="muted">{_whole(card.note)}</span></li>'
        for card in found
    )
    return Html(f'<ul class="cards">{"".join(items)}</ul>')


def _whole(plain: str) -> str:
    """Text whose numbers are not parted from their percent sign."""
    return escape(plain.replace(" %", "\N{NO-BREAK SPACE}%"))


def table(
    caption: str, head: Sequence[str], rows: Iterable[Sequence[str]], *, over: Sequence[str] = (), words: bool = False
) -> Html:
    """A table whose rows begin with their name; it scrolls by itself where it is too wide.

    ``over``: names above ``head``, each over as many columns as share them. ``words``: of text, to the left, and where
    there are many columns each row becomes a list of its cells on a narrow screen.
    """
    names = list(head)
    top = "" if not over else _row_over(names, over)
    top += "<tr>" + "".join(_heading(name, "col") for name in names) + "</tr>"
    records = words and len(names) > _COLUMNS
    body = "".join(_row(row, names if records else ()) for row in rows)
    kind = "words records" if records else "words" if words else ""
    # A table that is laid out as blocks is no table to a screen reader unless its role says so.
    role = ' role="table"' if records else ""
    return Html(
        f'<div class="scroll" tabindex="0" role="group" aria-label="{escape(caption)}"><table{_class(kind)}{role}>'
        f"<caption>{escape(caption)}</caption><thead>{top}</thead><tbody>{body}</tbody></table></div>"
    )


def _row_over(names: Sequence[str], over: Sequence[str]) -> str:
    span = (len(names) - 1) // len(over)
    return (
        "<tr><td></td>"
        + "".join(f'<th scope="colgroup" colspan="{span}">{_breakable(name)}</th>' for name in over)
        + "</tr>"
    )


def _heading(name: str, scope: str) -> str:
    return f'<th scope="{scope}">{_breakable(name)}</th>' if name else "<td></td>"


def _row(cells: Sequence[str], names: Sequence[str]) -> str:
    given = [f' data-name="{escape(name)}"' if name else "" for name in names] or [""] * len(cells)
    row, cell, first = (' role="row"', ' role="cell"', ' role="rowheader"') if names else ("", "", "")
    rest = "".join(
        f"<td{cell}{name}>{_marked(content)}</td>" for content, name in zip(cells[1:], given[1:], strict=True)
    )
    return f'<tr{row}><th scope="row"{first}{given[0]}>{_breakable(cells[0])}</th>{rest}</tr>'


def _marked(cell: str) -> str:
    """A cell; yes and no are seen at a glance."""
    sign = {"yes": ("good", "✓"), "no": ("bad", "✗")}.get(cell)
    return f'<span class="{sign[0]}">{sign[1]} {cell}</span>' if sign else _breakable(cell)


def _breakable(plain: str) -> str:
    """Text whose words stay whole; names that are longer than any break at their signs, or where there are none."""
    return _LONG.sub(lambda word: _parted(word.group()), escape(plain))


def _parted(name: str) -> str:
    pieces = _SIGNS.sub(r"\g<0> ", name).split(" ")
    return "<wbr>".join(f'<span class="long">{piece}</span>' if len(piece) > _WORD else piece for piece in pieces)


def _class(kind: str) -> str:
    return f' class="{kind}"' if kind else ""
