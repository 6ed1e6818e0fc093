"""``wct report``: what meshes are like."""

import json
from collections.abc import Sequence
from pathlib import PurePath
from typing import Any

import click
from rich.text import Text

from wct_plugin.cli import filter_options
from wct_plugin.cli.messages import GOAL_MET, GOAL_MISSED, out
from wct_plugin.cli.output import (
    check_apart,
    check_outputs,
    print_report,
    print_short,
    print_side_by_side,
    print_table,
    write_text,
)
from wct_plugin.errors import OptionError
from wct_plugin.io import read
from wct_plugin.io.region_choice import Regions
from wct_plugin.measure import compiled_quality, planar
from wct_plugin.measure.goals import DUAL, misses
from wct_plugin.measure.planar import PlanarReport
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.reports import html_report, json_schema
from wct_plugin.reports.report import Report, make_report


def _read(source: str, reference: SurfaceMesh | None, **how: Any) -> TetMesh | SurfaceMesh:
    """A tet mesh, or triangles in a plane; ``how`` it is read is for :func:`wct_plugin.read`."""
    mesh = read(source, **how)
    if isinstance(mesh, SurfaceMesh) and planar.is_planar(mesh):
        return mesh
    if isinstance(mesh, SurfaceMesh):
        raise OptionError(
            f"{source}: report needs a tet mesh, here is a surface; 'wct optimize {source} OUT' fills it first"
        )
    return mesh if reference is None else mesh.altered(reference=reference)


def _surface(source: str) -> SurfaceMesh:
    mesh = read(source)
    return mesh if isinstance(mesh, SurfaceMesh) else mesh.boundary_surface()


def _meets(mesh: TetMesh | SurfaceMesh, report: Report | PlanarReport, goal: str | None) -> bool:
    if isinstance(report, PlanarReport):
        return goal is None or report.acute == report.triangles
    if report.certificate:
        return report.certificate.valid if goal is None else report.certificate.meets(goal)
    if goal is not None and not report.tiers.valid:
        return False
    if goal in DUAL and isinstance(mesh, TetMesh):
        return not misses(mesh, compiled_quality.measure(mesh), goal).any()
    return goal is None or report.flags[goal] == report.tets


@click.command()
@click.argument("sources", metavar="FILE...", nargs=-1)
@click.option("--json", "json_path", metavar="FILE", help="Write JSON (- for stdout): one object, or a list of them")
@click.option(
    "--html",
    "html_path",
    metavar="FILE",
    callback=filter_options.page_name,
    help="Write one self-contained HTML page with pictures",
)
@click.option("--full", is_flag=True, help="Print all of it: tiers, duals, places, histograms, the worst tets")
@click.option("--worst", type=click.IntRange(min=0), help="How many worst tets to list  [default: 10]")
@click.option(
    "--goal",
    type=click.Choice(["delaunay", "one-sided", "3wc", "cwc"]),
    help="Exit with 1 unless every FILE meets it; one-sided: all signed duals of each region positive",
)
@click.option("--exact", is_flag=True, help="Prove it in exact arithmetic; exit with 1 where tets overlap or mismatch")
@click.option("--reference", metavar="FILE", help="Say how far each boundary is from this surface or mesh's boundary")
@filter_options.regions_option
@filter_options.repair_option
@filter_options.max_bytes_option
@click.option("--input-format", metavar="SUFFIX", help="Of each FILE, as vtu  [default: its name tells; - has none]")
@click.option("--schema", "print_schema", is_flag=True, help="Print the JSON schema of reports and end")
def report(
    sources: Sequence[str],
    json_path: str | None,
    html_path: str | None,
    full: bool,
    worst: int | None,
    goal: str | None,
    exact: bool,
    reference: str | None,
    regions: Regions,
    repair: bool,
    max_bytes: int | None,
    input_format: str | None,
    print_schema: bool,
) -> int:
    """Measure tet meshes, several side by side: ranges, tiers, flags, histograms, the worst tets with their place.

    Of triangles in a plane it says how many are acute.
    """
    if print_schema:
        write_text("-", json_schema.text())
        return GOAL_MET
    if not sources:
        raise click.UsageError("Missing argument 'FILE...'.")
    if sources.count("-") > 1:
        raise click.UsageError("'-' is given twice; standard input is one file")
    if exact and goal == "one-sided":
        raise click.UsageError("--exact proves no dual area: --goal one-sided goes without it, delaunay or 3wc with it")
    check_apart([*sources, *filter(None, [reference])], json_path, html_path)
    check_outputs(json_path, html_path)
    if html_path:
        html_report.check_available()
    surface = _surface(reference) if reference else None
    how = {"suffix": input_format, "regions": regions, "repair": repair, "max_bytes": max_bytes}
    meshes = [_read(source, surface, **how) for source in sources]
    _check_planar(meshes, html_path, goal)
    reports = [
        make_report(mesh, 10 if worst is None else worst, exact=exact)
        if isinstance(mesh, TetMesh)
        else planar.measure(mesh)
        for mesh in meshes
    ]
    if html_path:
        title = ", ".join(PurePath(source).name for source in sources)
        tets = [mesh for mesh in meshes if isinstance(mesh, TetMesh)]
        write_text(html_path, html_report.html(_of_tets(reports), title, meshes=tets))
    if json_path:
        found = [one.to_dict() for one in reports]
        write_text(json_path, json.dumps(found[0] if len(found) == 1 else found, indent=2))
    if json_path != "-":
        _print(reports, full=full, worst=worst is not None)
    met = [_meets(mesh, one, goal) for mesh, one in zip(meshes, reports, strict=True)]
    return GOAL_MET if all(met) else GOAL_MISSED


def _check_planar(meshes: Sequence[TetMesh | SurfaceMesh], html_path: str | None, goal: str | None) -> None:
    """Refuse what there is only of tets."""
    for mesh in meshes:
        if isinstance(mesh, SurfaceMesh) and html_path:
            raise OptionError(f"{mesh.source}: --html is for tets; of triangles in a plane there are text and --json")
        if isinstance(mesh, SurfaceMesh) and goal in DUAL:
            raise OptionError(
                f"{mesh.source}: --goal {goal} is for tets; of triangles in a plane 3wc and cwc ask for acute"
            )


def _of_tets(reports: Sequence[Report | PlanarReport]) -> list[Report]:
    return [one for one in reports if isinstance(one, Report)]


def _print(reports: Sequence[Report | PlanarReport], *, full: bool, worst: bool) -> None:
    tets = _of_tets(reports)
    if tets and not full:
        print_short(tets, worst=worst)
    elif len(tets) == 1:
        print_report(*tets)
    elif tets:
        print_side_by_side(tets)
    for one in reports:
        if isinstance(one, PlanarReport):
            out.print(Text(one.headline(), style="bold"))
            print_table("Triangles in a plane", ("", ""), one.rows())
            out.print(Text(planar.NOT_OPTIMISED.partition(";")[0]))
