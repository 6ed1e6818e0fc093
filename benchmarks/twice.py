"""Every mesh optimized, and its output again: ``python -m benchmarks.twice MESHES [--surfaces FOLDER]``.

What meets the goal within the tolerance comes back to the bit. Each run is a process of its own, as users have it, and
reads what the one before wrote.
"""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import click
import numpy as np

import wct_plugin as wct
from benchmarks import meshes

_WCT = Path(sys.executable).with_name("wct")


@click.command()
@click.argument("given", type=click.Path(exists=True, path_type=Path))
@click.option(
    "--surfaces",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Folder of true surfaces, named as the meshes are.",
)
@click.option("--out", default=Path("build/twice"), type=click.Path(path_type=Path), show_default=True)
def main(given: Path, surfaces: Path | None, out: Path) -> None:
    """Run ``wct optimize`` twice on each mesh and write twice.md; exit code 1 where a second run changed a mesh."""
    out.mkdir(parents=True, exist_ok=True)
    lines = [
        "| mesh | reference | tets in | tets out | exit codes | CPU s | same bits | SHA-256 of the output |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    same = True
    for file in meshes.found(given):
        surface = meshes.surface_of(file, surfaces)
        reference = ["--reference", str(surface)] if surface else []
        once, again = out / f"{file.stem}.once.vtu", out / f"{file.stem}.again.vtu"
        codes, seconds = zip(*(_optimized(*pair, reference) for pair in ((file, once), (once, again))), strict=True)
        first, second = wct.read(once), wct.read(again)
        equal = _digest(first) == _digest(second)
        same &= equal or codes[0] == 1  # what missed the goal may be bettered
        cells = (
            file.stem,
            surface.name if surface else "",
            len(wct.read(file).tets),
            len(first.tets),
            f"{codes[0]}, {codes[1]}",
            f"{seconds[0]:.1f}, {seconds[1]:.1f}",
            "yes" if equal else "no",
            _digest(first)[:16],
        )
        lines.append(f"| {' | '.join(map(str, cells))} |")
        click.echo(lines[-1])
    (out / "twice.md").write_text("\n".join(lines) + "\n")
    sys.exit(0 if same else 1)


def _optimized(source: Path, target: Path, reference: list[str]) -> tuple[int, float]:
    """Exit code and CPU seconds."""
    before = os.times()
    code = subprocess.run([_WCT, "-q", "optimize", source, target, *reference], stderr=subprocess.DEVNULL).returncode
    after = os.times()
    if code > 1:
        raise click.ClickException(f"wct optimize {source} ended with exit code {code}")
    return code, sum(after[2:4]) - sum(before[2:4])


def _digest(mesh: wct.TetMesh) -> str:
    arrays = (mesh.points, mesh.tets, mesh.regions, mesh.facets.vertices, mesh.facets.tags)
    return hashlib.sha256(b"".join(np.ascontiguousarray(array).tobytes() for array in arrays)).hexdigest()


if __name__ == "__main__":
    main()
