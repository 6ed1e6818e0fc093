"""Reports as one self-contained HTML page: what was reached, what is left and where, then all the numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import PurePath
from typing import Any

from wct_plugin.certify import certificate
from wct_plugin.certify.certificate import Certificate
from wct_plugin.measure.negative_duals import HEAD as NEGATIVE_HEAD
from wct_plugin.measure.solver_view import HEAD as SOLVER_HEAD
from wct_plugin.mesh import TetMesh
from wct_plugin.obstructions import remaining_tets
from wct_plugin.reports import colour_scales, interactive_view
from wct_plugin.reports.boundary_deviation import deviation_of_facets
from wct_plugin.reports.histograms import Axis, Series, colour_scale, deviation_scale, histogram
from wct_plugin.reports.html_elements import (
    Card,
    Html,
    cards,
    code,
    columns,
    details,
    grid,
    image,
    join,
    page,
    paragraph,
    section,
    table,
)
from wct_plugin.reports.interactive_view import Apart, View
from wct_plugin.reports.pictures import Picture, check_available, deviation_pictures, pictures
from wct_plugin.reports.report import BINS, TITLES, Report, short_names

__all__ = ["check_available", "html"]

_AXES = {
    "h/R": Axis(TITLES["h/R"], BINS["h/R"], "", "tets", 0.0, ("circumcenter outside", "inside"), -1),
    "face_angle": Axis(TITLES["face_angle"], BINS["face_angle"], "°", "tets", 90.0, ("acute", "obtuse"), 1),
    "dihedral_angle": Axis(TITLES["dihedral_angle"], BINS["dihedral_angle"], "°", "angles", 90.0, ("acute", "obtuse")),
    "R/l": Axis(TITLES["R/l"], BINS["R/l"], "", "tets", open_end=True),
}
#: So many of the tets that miss the goal are listed, and so many of these shown at once.
_MOST, _FIRST = 100, 10


def html(
    reports: Sequence[Report],
    title: str,
    *,
    names: Sequence[str] = (),
    meshes: Sequence[TetMesh] = (),
    made: Mapping[str, Any] | None = None,
) -> str:
    """One page of the reports side by side; nothing in it is loaded from elsewhere.

    ``names``: what to call each (default: its number and file). ``meshes``: those reported, for the pictures. ``made``:
    how the last one was made, as :func:`wct_plugin.pipeline.remaking.provenance` gives it, and under ``again`` what
    makes it again; the page then is about that one, and the first is what it was before.

    Raises :class:`wct_plugin.errors.WctError` without matplotlib, which draws the pictures.
    """
    if not reports:
        raise ValueError("a page needs at least one report")
    check_available()
    named = dict(zip(names or short_names(reports), reports, strict=True))
    shown = _shown(named, meshes) if meshes else None
    return page(
        title,
        _parts(named, shown, made),
        style=interactive_view.STYLE if shown else "",
        script=shown.view.script if shown else None,
    )


def _parts(reports: Mapping[str, Report], shown: "_Shown | None", made: Mapping[str, Any] | None) -> list[Html]:
    parts = [*_verdicts(reports, made is not None)]
    if shown:
        parts += [shown.view.html, shown.pictures]
    parts += [
        _left(name, report, len(reports) > 1) for name, report in reports.items() if report.left() or report.notes
    ]
    parts += [_certificate(name, one.certificate) for name, one in reports.items() if one.certificate]
    parts += [_histograms(reports), _tables(reports)]
    if made is not None:
        parts.append(_made(made))
    parts += [_words(), paragraph(f"Made by wct_plugin {version('wct_plugin')}.", "muted")]
    return parts


# --- what was reached ------------------------------------------------------------------------------------------------


def _verdicts(reports: Mapping[str, Report], ends: bool) -> list[Html]:
    """Of the last report compared with the first where one was made of the other; else of each."""
    first, last = next(iter(reports.values())), list(reports.values())[-1]
    if ends or len(reports) == 1:
        return [_verdict(last, first if first is not last else None)]
    return [section(name, _verdict(one, None)) for name, one in reports.items()]


def _verdict(report: Report, before: Report | None) -> Html:
    tets, outside, bad = report.tets, report.tets - report.flags["3wc"], report.tets - report.flags["cwc"]
    line = f"{outside} of {tets} tets do not contain their circumcenter."
    if not outside:
        line = f"All {tets} tets contain their circumcenter"
        line += f"; {bad} have a triangle that is not acute." if bad else ", and all their triangles are acute."
    shape = {name: (low, high) for name, low, high in report.rows_ranges()}
    tier = report.rows_tiers()[report.tiers.reached][2] if report.tiers.valid else "tets overlap"
    found = [
        _share("Contain their circumcenter (3WC)", "3WC", report, before),
        _share("All triangles acute too (CWC)", "CWC", report, before),
        _boundary(report),
        _remaining(report, bad),
        Card("Tier", report.tiers.name, tier.removeprefix("and "), "" if report.tiers.valid else "bad"),
        Card("Worst of all tets", f"h/R {shape['h/R'][0]}", f"largest face angle {shape['Face angle'][1]}"),
    ]
    return join([paragraph(line, "bad" if outside else "good"), cards(found)])


def _share(label: str, flag: str, report: Report, before: Report | None) -> Card:
    count, percent = _flag(report, flag)
    note = f"{count} of {report.tets} tets" + (f"; before: {_flag(before, flag)[1]}" if before else "")
    if count == report.tets:
        return Card(label, "100 %", note, "good")
    wanted = report.remaining is None or report.remaining["count"] > 0  # else the goal was less, and it is met
    return Card(label, percent, note, "bad" if wanted else "")


def _flag(report: Report, flag: str) -> tuple[int, str]:
    return next((int(count), percent) for name, count, percent in report.rows_flags() if name == flag)


def _boundary(report: Report) -> Card:
    if report.deviation is None:
        return Card("Boundary to reference", "not measured", "no surface to compare with is known")
    apart = report.deviation["fraction_of_diagonal"]
    value, both = _power(apart), "of the diagonal, the farthest of samples both ways"
    if report.tolerance is None:
        return Card("Boundary to reference", value, both)
    within = apart <= report.tolerance
    note = f"{both}; {'within' if within else 'beyond'} the tolerance of {_power(report.tolerance)}"
    return Card("Boundary kept" if within else "Boundary not kept", value, note, "good" if within else "bad")


def _power(value: float) -> str:
    return f"{value:.2e}".replace("e-0", "e-").replace("e+0", "e+")


def _remaining(report: Report, bad: int) -> Card:
    if report.remaining is None:
        places = ", ".join(f"{no} {name}" for name, (_, _, no) in report.bad_by_place.items() if no)
        return Card("Not completely well-centered", f"{bad} tets", places or "none", "bad" if bad else "good")
    count = report.remaining["count"]
    places = ", ".join(f"{count} {name}" for name, count in report.remaining["by_place"].items() if count)
    proven = report.remaining["proven"]
    note = places + (f"; {proven} provably cannot meet it under the options given" if proven else "")
    return Card("Miss the goal", f"{count} tets", note or "nothing is left to do", "bad" if count else "good")


# --- where ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Shown:
    """The meshes themselves: to be turned, and from two sides."""

    view: View
    pictures: Html


def _shown(reports: Mapping[str, Report], meshes: Sequence[TetMesh]) -> _Shown:
    names, apart = list(reports), _apart(list(reports.values()), meshes)
    sides = [pictures(mesh) for mesh in meshes]
    front, back = ([(name, side[k]) for name, side in zip(names, sides, strict=True)] for k in (0, 1))
    parts = [
        section(
            "Where the bad tets are", colour_scale(), _gallery(front), details("From the opposite side", _gallery(back))
        )
    ]
    if apart is not None:
        each = zip(meshes, apart.facets, strict=True)
        sides_apart = [deviation_pictures(mesh, found, apart.stops) for mesh, found in each]
        far, far_back = ([(name, (side[k],)) for name, side in zip(names, sides_apart, strict=True)] for k in (0, 1))
        parts.append(
            section(
                "How far the boundary is from the reference",
                deviation_scale(apart.stops, apart.tolerance),
                _gallery(far),
                details("From the opposite side", _gallery(far_back)),
            )
        )
    return _Shown(interactive_view.view(names, meshes, apart), join(parts))


def _apart(reports: Sequence[Report], meshes: Sequence[TetMesh]) -> Apart | None:
    """How far the boundaries are from the last one's reference, as the reports have it; None where there is none."""
    reference, tolerance = meshes[-1].reference, reports[-1].tolerance
    if reference is None or not reference.diagonal:
        return None
    facets = [deviation_of_facets(mesh, reference) for mesh in meshes]
    most = max(*(float(one.max()) for one in facets), tolerance or 0.0, 1e-12)
    return Apart(facets, colour_scales.deviation(most, tolerance), tolerance)


def _gallery(found: Sequence[tuple[str, Sequence[Picture]]]) -> Html:
    """Like beside like: first the boundary of every mesh, then the inside of those that have bad tets."""
    if len(found) == 1:
        return grid(image(one.png, one.size, one.alt, one.caption) for one in found[0][1])
    rows = []
    for k in range(max(len(each) for _, each in found)):
        row = []
        for name, each in found:
            if k < len(each):
                one = each[k]
                row.append(image(one.png, one.size, f"{name}. {one.alt}", f"{name}. {one.caption}"))
            else:
                row.append(paragraph(f"{name}. No bad tets: there is nothing to show inside.", "muted"))
        rows.append(grid(row))
    return join(rows)


def _left(name: str, report: Report, named: bool) -> Html:
    parts = []
    if report.remaining and report.remaining["count"]:
        found = report.remaining
        rows = remaining_tets.rows(found, _MOST)
        parts = [
            paragraph(f"{remaining_tets.title(found)}."),
            *(paragraph(f"{line}.") for line in report.why()),
            table("By what would free them", remaining_tets.KINDS, remaining_tets.kinds(found), words=True),
            table("The worst of them", remaining_tets.HEAD, rows[:_FIRST], words=True),
        ]
        if rows[_FIRST:]:
            more = table("By how bad they are", remaining_tets.HEAD, rows[_FIRST:], words=True)
            parts.append(details(f"The next {len(rows) - _FIRST}", more))
    parts += [paragraph(note) for note in report.notes]
    return section("What is left" + (f": {name}" if named else ""), *parts)


def _certificate(name: str, found: Certificate) -> Html:
    return section(
        f"Exact certificate, {name}: {found.headline()}",
        table("What is proven", certificate.HEAD, found.rows()),
        *map(paragraph, found.lines()),
    )


# --- numbers ----------------------------------------------------------------------------------------------------------


def _histograms(reports: Mapping[str, Report]) -> Html:
    notes = {
        "h/R": lambda r: f"{r.tets - r.flags['3wc']} of {r.tets} tets at 0 or below",
        "face_angle": lambda r: f"{r.tets - r.flags['2wc']} of {r.tets} tets at 90° or above",
        "dihedral_angle": lambda r: f"{r.tets - r.flags['acute']} of {r.tets} tets have 90° or more",
        "R/l": lambda r: f"largest {r.rows_ranges()[3][2]}",
    }
    return section(
        "Histograms",
        grid(
            histogram(axis, [Series(title, one.histograms[name], notes[name](one)) for title, one in reports.items()])
            for name, axis in _AXES.items()
        ),
    )


def _tables(reports: Mapping[str, Report]) -> Html:
    names, found = list(reports), list(reports.values())
    several = names if len(names) > 1 else []

    def joined(tables: Sequence[Sequence[Sequence[str]]]) -> list[list[str]]:
        """Rows of each report, which begin with the same names."""
        return [
            [first[0], *first[1:], *(cell for row in rest for cell in row[1:])]
            for first, *rest in zip(*tables, strict=True)
        ]

    def beside(caption: str, tables: Sequence[Sequence[Sequence[str]]], columns: tuple[str, ...]) -> Html:
        return table(caption, ("", *columns * len(found)), joined(tables), over=several)

    tiers = joined([[(name, yes) for name, yes, _ in r.rows_tiers()] for r in found])
    means = [[*row, note] for row, (_, _, note) in zip(tiers, found[0].rows_tiers(), strict=True)]
    parts = [
        table("Summary", ("", *names), joined([r.rows_summary() for r in found])),
        table("Tiers, each implies those before it", ("tier", *names, "what it means"), means, words=True),
        beside("Ranges over all tets", [r.rows_ranges() for r in found], ("min", "max")),
        beside("Well-centered tets", [r.rows_flags() for r in found], ("tets", "percent")),
        beside(
            "Tets by place, the highest of their vertices",
            [r.rows_places() for r in found],
            ("tets", "not 3WC", "not CWC"),
        ),
        *_negative_duals(reports),
    ]
    by_region = [
        details(f"What solvers see: {name}", table("By region", SOLVER_HEAD, report.solver_view.rows()))
        for name, report in reports.items()
        if len(report.regions) > 1  # else all is in the summary
    ]
    worst = [
        details(f"Worst tets: {name}", table("Worst first", report.worst_head(), report.rows_worst(), words=True))
        for name, report in reports.items()
        if report.worst
    ]
    return section("All numbers", columns(parts), *by_region, *worst)


def _negative_duals(reports: Mapping[str, Report]) -> list[Html]:
    """All of one mesh, else each place with a column per mesh: on a phone there is no room for three of each."""
    found = [one.negative_duals.rows() for one in reports.values()]
    if len(found) == 1:
        return [table("Negative duals", NEGATIVE_HEAD, found[0])]
    captions = ("Negative duals inside", "Negative duals on the boundary", "Duals that are zero")
    return [
        table(caption, ("", *reports), [(rows[0][0], *(row[k] for row in rows)) for rows in zip(*found, strict=True)])
        for k, caption in enumerate(captions, 1)
    ]


# --- how it was made --------------------------------------------------------------------------------------------------


def _made(made: Mapping[str, Any]) -> Html:
    stages = [(one["type"], f"{one['seconds']:.2f} s", one["mesh"]) for one in made["stages"]]
    versions = [*made["versions"].items(), ("platform", made["platform"])]
    parts = [
        table("Stages", ("stage", "time", "mesh it gave"), stages, words=True),
        table("Versions", ("package", "version"), versions, words=True),
    ]
    for one in made["stages"]:
        rows = [
            (name, _value(value), "given" if name in one["given"] else "default")
            for name, value in one["options"].items()
        ]
        parts.append(table(f"Options of {one['type']}", ("option", "value", "set"), rows, words=True))
    again = [paragraph("The same again, where the files are:"), code(made["again"])] if made.get("again") else []
    return section("How it was made", *again, columns(parts))


def _value(value: Any) -> str:
    """An option's value; of a path the name alone: the page may go where the folders are nobody's business."""
    if value is None:
        return "none"
    if isinstance(value, str):
        return PurePath(value).name or value
    return f"{value:g}" if isinstance(value, float) else str(value)


def _words() -> Html:
    meaning = (
        ("h/R", "of a facet: signed height of the circumcenter above it over the circumradius; 1/3 in the regular tet"),
        ("3WC", "the tet contains its circumcenter: all its h/R are positive"),
        ("2WC", "all its triangles are acute"),
        ("CWC", "completely well-centered: 3WC and 2WC"),
        ("Acute", "all its dihedral angles are below 90°"),
        ("R/ℓ", "circumradius over shortest edge, 0.612 in the regular tet; large where a tet is flat"),
        ("★0, ★1, ★2", "Hodge stars, diagonal and positive only if no circumcentric dual is negative or zero"),
        ("couple", "of two vertices in a region: signed area of the dual face across their edge, over its length"),
        ("unsigned / signed", "dual volume added up without signs, as DEVSIM does, over the volume; 1.000 if CWC"),
        ("non-orthogonality", "of a facet: its normal against the line of the centroids; with circumcenters it is 0"),
        ("place", "interior, boundary (or patch), crease or corner: the highest among the tet's vertices"),
    )  # fmt: skip
    return section("Words", table("What they mean here", ("word", "means"), meaning, words=True))
