"""``wct demo``: small samples to try everything on, and the main job done on one of them."""

import importlib.util
from importlib.resources import files as resources
from pathlib import Path

import click
from rich.text import Text

from wct_plugin.cli.messages import out
from wct_plugin.cli.output import print_table
from wct_plugin.errors import OutputError, how_to_install
from wct_plugin.io import atomic_files

#: The samples and what each is; ``examples/samples_from_gmsh.py`` makes them.
SAMPLES = {
    "bone.ply": "a surface: a bone",
    "two_material.msh": "tets of gmsh: a ball in a cube, two materials and two contacts with names",
    "part.msh": "tets of gmsh: a plate with a hole, clamped at one end and pulled at the other",
    "part.stl": "the surface of that plate, its hole in finer facets",
}
#: What to try next, as one would type it beside the samples.
NEXT = (
    "wct report bone.vtu",
    "wct optimize two_material.msh two_material.vtu",
    "wct optimize part.msh part.vtu --reference part.stl",
    "wct filters meshing_well_centered",
)
#: Where pymeshlab's wheel keeps a scan of a bone; where it has none, the sample of ours is the bone.
_SCAN = Path("tests/sample_meshes/bone.ply")


def _sample(name: str) -> bytes:
    """Content of a sample."""
    if name == _SCAN.name and (found := importlib.util.find_spec("pymeshlab")):
        for folder in found.submodule_search_locations or ():
            if (Path(folder) / _SCAN).is_file():
                return (Path(folder) / _SCAN).read_bytes()
    return resources("wct_plugin.cli").joinpath("samples", name).read_bytes()


def _check(folder: Path, samples: dict[str, bytes], results: list[str]) -> None:
    """Refuse a folder in which a file would be written over; a sample from an earlier time may be there."""
    other = [name for name, content in samples.items() if _differs(folder / name, content)]
    other += [name for name in results if (folder / name).exists()]
    if other:
        raise OutputError(
            f"{folder / other[0]}: a file of this name is there already, and the demo writes over none;"
            " give an empty folder: wct demo DIR"
        )
    if not folder.exists():
        atomic_files.check_writable(folder)  # which a folder can be made in where a file can
        return
    for name in (*samples, *results):
        atomic_files.check_writable(folder / name)


def _differs(path: Path, content: bytes) -> bool:
    return path.exists() and not (path.is_file() and path.read_bytes() == content)


@click.command()
@click.argument("folder", metavar="[DIR]", default=".")
@click.pass_context
def demo(context: click.Context, folder: str) -> int:
    """Write small samples into DIR, by default the current folder, and make the tets of one well-centered.

    A file that is there already is never written over: give an empty folder, or a new one.

    Exit code 0: every tet of the bone meets the goal. 1: not every one, all is written. 2: an error or an interrupt,
    which says what was written before it, if anything.
    """
    where = Path(folder)
    samples = {name: _sample(name) for name in SAMPLES}
    results = ["bone.vtu"]
    options = []
    if importlib.util.find_spec("matplotlib"):  # which draws the pictures of the page
        results.append("bone.html")
        options = ["--html", "bone.html"]
    _check(where, samples, results)
    where.mkdir(exist_ok=True)
    for name, content in samples.items():
        with atomic_files.replacing(where / name) as temporary:
            temporary.write_bytes(content)
    print_table(f"Samples in {where.resolve()}", ("file", "what it is"), list(SAMPLES.items()), left=True)

    command = ["optimize", "bone.ply", "bone.vtu", "--allow-released", *options]
    out.print(Text(f"$ wct {' '.join(command)}", style="bold"), soft_wrap=True)
    here = [str(where / word) if word in (*samples, *results) else word for word in command]
    wct = context.find_root().command
    code: int = wct.main(args=here, prog_name="wct", standalone_mode=False)

    missing = "" if options else f" The report with pictures needs matplotlib: {how_to_install('report')}"
    out.print(Text(f"Wrote {' and '.join(str(where / name) for name in results)}.{missing}"))
    place = "" if where.resolve() == Path.cwd() else f" in {where}"
    out.print(Text(f"Try next{place}:", style="bold"))
    for line in NEXT:
        out.print(Text(f"  {line}"), soft_wrap=True)
    return code
