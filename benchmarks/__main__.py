"""Run every tool on every mesh, one at a time, and write the table: ``make bench MESHES=folder SURFACES=folder``."""

import sys
from pathlib import Path

import click

import wct_plugin as wct
from benchmarks import meshes, table
from benchmarks.judge import judge, row_of
from benchmarks.ours import OURS
from benchmarks.peers import PEERS
from benchmarks.run import run
from wct_plugin.errors import WctError

_EXISTING = click.Path(exists=True, path_type=Path)
_FOLDER = click.Path(exists=True, file_okay=False, path_type=Path)


@click.command()
@click.option(
    "--meshes", "given", type=_EXISTING, help="Folder of tet meshes, or one file; default: small ones made here."
)
@click.option("--surfaces", type=_FOLDER, help="Folder of true surfaces, named as the meshes are.")
@click.option("--only", multiple=True, help="Only tools whose name contains this; may be repeated.")
@click.option("--timeout", default=600.0, show_default=True, help="Seconds per tool and mesh.")
@click.option("--out", default=Path("build/bench"), type=click.Path(path_type=Path), show_default=True)
def main(given: Path | None, surfaces: Path | None, only: tuple[str, ...], timeout: float, out: Path) -> None:
    """Run ours and the peers side by side; write bench.md and bench.json."""
    files = meshes.found(given) if given else meshes.default(out / "meshes")
    if not files:
        raise click.UsageError(f"no tet mesh in {given}")
    tools = [tool.name for tool in (*OURS, *PEERS) if not only or any(part in tool.name for part in only)]
    about = table.machine(["wct_plugin", *dict.fromkeys(peer.package for peer in PEERS)])
    rows = []
    for file in files:
        surface_file = meshes.surface_of(file, surfaces)
        try:
            mesh = wct.read(file)
            surface = wct.read(surface_file) if surface_file else mesh.boundary_surface()
            row = {"mesh": file.stem, "tool": "input", "status": "ok", **judge(mesh, mesh, surface)}
        except WctError as error:
            raise click.ClickException(str(error)) from error
        rows.append(row)
        for tool in tools:
            click.echo(f"{file.stem}: {tool} ... ", nl=False, err=True)
            rows.append(row_of(file.stem, tool, run(tool, file, surface_file, timeout), mesh, surface))
            click.echo(rows[-1]["status"], err=True)
            table.write(rows, about, out)  # what is done stays if the run is stopped
    table.write(rows, about, out)
    click.echo(table.markdown(rows, about))
    click.echo(f"wrote {out / 'bench.md'} and {out / 'bench.json'}", err=True)


if __name__ == "__main__":
    sys.exit(main())
