"""``wct dual``: the dual of a mesh, for solvers."""

from typing import get_args

import click
from rich.text import Text

from wct_plugin.cli.in_and_out import in_and_out
from wct_plugin.cli.messages import GOAL_MET, out
from wct_plugin.cli.output import check_apart
from wct_plugin.duals.dual_files import DualFormat, check_dual_writable, format_of, write_dual
from wct_plugin.io import read
from wct_plugin.io.region_choice import Regions
from wct_plugin.mesh import TetMesh
from wct_plugin.pipeline.stage import check_kind


@click.command()
@in_and_out
@click.option(
    "--format",
    "form",
    type=click.Choice(get_args(DualFormat)),
    help="vtu: polyhedra; openfoam: polyMesh in the folder OUT; npz, matrix-market: Hodge stars and derivatives"
    "  [default: as the suffix says, openfoam without one]",
)
def dual(
    source: str,
    target: str,
    form: DualFormat | None,
    regions: Regions,
    repair: bool,
    max_bytes: int | None,
    input_format: str | None,
) -> int:
    """Write the circumcentric dual of the tet mesh IN: Voronoi cells, or the matrices of exterior calculus.

    OUT is NAME.vtu (a polyhedron per vertex and region), NAME.npz (Hodge stars and exterior derivatives), or a
    folder: a case of OpenFOAM's, or with --format matrix-market a file per matrix. Cells that would be tangled are
    refused, with the goal of meshing_well_centered that mends it.
    """
    check_dual_writable(target, format_of(target, form))
    check_apart([source], target)
    mesh = read(source, suffix=input_format, regions=regions, repair=repair, max_bytes=max_bytes)
    check_kind("wct dual", TetMesh, type(mesh))
    out.print(Text(f"{target}: {write_dual(target, mesh, format=form)}"))
    return GOAL_MET
