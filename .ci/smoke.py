"""Every command and every neighbour once, on small meshes: whether an installed ``wct`` works with the versions it has.

``.ci/run`` runs it with the lowest versions that pyproject.toml allows. A warning about a line of ours is an error;
what other packages say of each other is not ours to mend.
"""

import importlib
import json
import os
import pkgutil
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

WCT = Path(sys.executable).with_name("wct")
NOT_ON_WINDOWS = ("wct_plugin.batch.fork_server", "wct_plugin.batch.process_sessions")
REPAIR = [{"type": "filters.meshlab", "filter": "meshing_remove_duplicate_vertices"}]


def wct(*arguments: str, allowed: tuple[int, ...] = (0,)) -> str:
    """What ``wct`` prints."""
    done = subprocess.run([WCT, *arguments], capture_output=True, text=True)
    assert done.returncode in allowed, f"wct {' '.join(arguments)}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


def modules() -> None:
    """Import everything there is, and with it the neighbours."""
    import wct_plugin
    from wct_plugin.pipeline.stage import filter_names, find_filter

    for one in pkgutil.walk_packages(wct_plugin.__path__, "wct_plugin."):
        if sys.platform != "win32" or one.name not in NOT_ON_WINDOWS:
            importlib.import_module(one.name)
    for name in filter_names():
        find_filter(name)


def command_line() -> None:
    """Make, measure, repair, fill, improve and run many; whether the goal is met (0) or missed (1) does not matter."""
    assert "part.msh" in wct("demo", "samples", allowed=(0, 1))
    wct("create", "cube", "cube.vtu", "--variant", "84")
    assert json.loads(wct("report", "cube.vtu", "--json", "-"))["cwc"]["count"] == 84
    Path("surface.json").write_text(json.dumps([{"type": "filters.generate_boundary_surface"}]))
    wct("run", "surface.json", "cube.vtu", "surface.stl")
    Path("repair.json").write_text(json.dumps(REPAIR))
    assert wct("run", "repair.json", "surface.stl", "repaired.ply", "--validate").startswith("valid: ")
    wct("run", "repair.json", "surface.stl", "repaired.ply", "--metadata", "repaired.json")
    made = ["--json", "part.json", "--html", "part.html"]
    wct("optimize", "repaired.ply", "part.vtu", "--mesher-edge-length", "0.4", "--goal", "3wc", *made, allowed=(0, 1))
    assert json.loads(Path("part.json").read_text())["after"]["tets"] > 5
    assert "<svg" in Path("part.html").read_text()
    wct("report", "part.vtu", "cube.vtu", "--exact", "--html", "both.html")
    weigh = [{"type": f"filters.{name}"} for name in ("compute_scalar_by_well_centeredness", "compute_power_weights")]
    Path("weigh.json").write_text(json.dumps(weigh))
    wct("run", "weigh.json", "part.vtu", "weighed.vtu")
    assert "compute_power_weights" in json.loads(wct("filters", "--json", "-"))
    assert json.loads(wct("run", "--schema"))["$defs"]
    Path("measure.json").write_text(json.dumps([{"type": "filters.get_quality"}]))
    wct("batch", "measure.json", "cube.vtu", "part.vtu", "-o", "out", "--jobs", "2")
    assert len(Path("out/manifest.jsonl").read_text().splitlines()) == 2


def formats() -> None:
    """Every format of the mesh of tets and back; some are other packages' in their turn."""
    import wct_plugin

    mesh = wct_plugin.read("cube.vtu")
    for suffix in ("vtk", "xdmf", "msh", "med", "mesh", "bdf", "inp", "su2", "ele"):
        wct_plugin.write(f"again.{suffix}", mesh)
        assert wct_plugin.read(f"again.{suffix}").tets.shape == mesh.tets.shape, suffix


def images() -> None:
    """Voxels from a TIFF, here a single one."""
    from PIL import Image

    Image.new("L", (1, 1), 7).save("voxel.tif")
    wct("create", "from_voxels", "voxel.vtu", "--voxels", "voxel.tif")


def accessor() -> None:
    """``.wct`` of pyvista's datasets."""
    import pyvista

    grid = pyvista.read("cube.vtu")
    assert grid.wct.report().tets == (grid.celltypes == pyvista.CellType.TETRA).sum() == 84  # beside tagged facets


def scheduler() -> None:
    """A batch on the worker of a dask scheduler."""
    import distributed

    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        wct("batch", "measure.json", "cube.vtu", "-o", "far", "--scheduler", cluster.scheduler_address)


def main() -> None:
    """Do everything in a folder that goes away."""
    warnings.filterwarnings("error", module=r"wct_plugin\b")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for one in (modules, command_line, formats, images, accessor, scheduler):
            one()
        os.chdir("/")


if __name__ == "__main__":
    main()
