"""``wct report``: what meshes are like."""

import json
from collections.abc import Sequence

import click

from wct_plugin.adapters import meshio
from wct_plugin.cli_show import GOAL_MET, GOAL_MISSED, check_outputs, print_report, write_text
from wct_plugin.mesh import TetMesh
from wct_plugin.report import Report, make_report
from wct_plugin.report_page import html
from wct_plugin.stage import Mesh, find_filter


def _report(mesh: Mesh, worst: int) -> Report:
    find_filter("get_quality").check_takes(type(mesh))
    assert isinstance(mesh, TetMesh)
    return make_report(mesh, worst)


def _meets(report: Report, goal: str) -> bool:
    return report.flags[goal] == report.tets


@click.command()
@click.argument("sources", metavar="FILE...", nargs=-1, required=True)
@click.option("--json", "json_path", metavar="FILE", help="Write JSON (- for stdout): one object, or a list of them")
@click.option("--html", "html_path", metavar="FILE", help="Write one self-contained HTML page")
@click.option("--worst", type=click.IntRange(min=0), default=10, show_default=True, help="How many worst tets to list")
@click.option("--goal", type=click.Choice(["3wc", "cwc"]), help="Exit with 1 unless every tet of every FILE meets it")
def report(sources: Sequence[str], json_path: str | None, html_path: str | None, worst: int, goal: str | None) -> int:
    """Measure tet meshes: ranges, tiers, flags, histograms, and the worst tets with their place."""
    check_outputs(json_path, html_path)
    reports = []
    for source in sources:
        reports.append(_report(meshio.read(source), worst))
    if html_path:
        write_text(html_path, html(reports, ", ".join(sources)))
    if json_path:
        found = [one.to_dict() for one in reports]
        write_text(json_path, json.dumps(found[0] if len(found) == 1 else found, indent=2))
    if json_path != "-":
        for one in reports:
            print_report(one)
    return GOAL_MET if goal is None or all(_meets(one, goal) for one in reports) else GOAL_MISSED
