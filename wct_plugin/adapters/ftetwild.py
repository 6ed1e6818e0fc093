"""FTetWild, through pytetwild: tetrahedra from a triangle surface, in a process of its own.

The native code ends the whole process on some inputs, prints at will, runs for minutes and hears no Ctrl-C, so it
never runs in ours. This file is both sides: the parent calls :func:`tetrahedralize`, which starts the file as
``python -m wct_plugin.adapters.ftetwild IN OUT OPTIONS``.
"""

import json
import re
import shutil
import sys
import tempfile
import warnings
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from types import ModuleType

import numpy as np

from wct_plugin.adapters import child_process
from wct_plugin.adapters.option_ranges import check_at_least, check_between, check_limit
from wct_plugin.adapters.solid_surface import check_thick, label
from wct_plugin.errors import InputError, NeighbourError, WctWarning
from wct_plugin.exact import predicates
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.types import Floats, Ints


def tetrahedralize(
    surface: SurfaceMesh,
    *,
    edge_length: float = 0.05,
    epsilon: float = 1e-3,
    stop_energy: float = 10.0,
    num_opt_iter: int = 80,
    coarsen: bool = False,
    timeout: float | None = None,
    heard: Callable[[str], object] | None = None,
) -> TetMesh:
    """Fill a surface with tetrahedra by fTetWild.

    fTetWild is not reproducible: the same call gives another mesh each time, even on one thread. Its surface is
    near the given one, within ``epsilon``, but not on it; the given surface is kept as the result's ``reference``.

    Parameters
    ----------
    surface : SurfaceMesh
        What to fill; holes, self-intersections and gaps are tolerated, but it must not lie in one plane.
    edge_length : float
        Target edge length as a fraction of the bounding box's diagonal, above 0, at most 1.
    epsilon : float
        Greatest distance from the surface as a fraction of the diagonal, above 0, at most 1.
    stop_energy : float
        Optimisation stops when the AMIPS energy of every tet is below; at least 3, the energy of a regular tet.
    num_opt_iter : int
        At most so many optimisation passes, at least 1.
    coarsen : bool
        Make tets as large as quality allows.
    timeout : float or None
        Seconds after which the mesher is stopped; None waits for ever.
    heard : callable, optional
        Told about every second where it stands, in a few words.

    Returns
    -------
    TetMesh
        Positively oriented, with ``reference`` and ``source`` set.

    Warns
    -----
    WctWarning
        If the surface has several tags, which fTetWild cannot keep.

    Raises
    ------
    OptionError
        For an option out of range.
    InputError
        For a planar surface.
    NeighbourError
        If fTetWild crashes, runs out of time or fills nothing.
    """
    check_between("edge_length", edge_length, 1.0)
    check_between("epsilon", epsilon, 1.0)
    check_at_least("stop_energy", stop_energy, 3.0)
    check_at_least("num_opt_iter", num_opt_iter, 1)
    check_limit("timeout", timeout, "seconds")
    check_thick(surface, "fTetWild")
    if len(tags := np.unique(surface.tags)) > 1:
        warnings.warn(
            f"{label(surface)}fTetWild drops the tags of the surface's triangles ({len(tags)} different ones); mesher "
            "'tetgen' keeps them",
            WctWarning,
            stacklevel=2,
        )
    options = {
        "edge_length_fac": float(edge_length),
        "epsilon": float(epsilon),
        "stop_energy": float(stop_energy),
        "num_opt_iter": int(num_opt_iter),
        "coarsen": bool(coarsen),
    }
    with tempfile.TemporaryDirectory(prefix="wct_") as folder:
        given, made = Path(folder, "surface.npz"), Path(folder, "tets.npz")
        # fTetWild dies of a segmentation fault on points that no triangle uses.
        used, triangles = np.unique(surface.triangles, return_inverse=True)
        try:
            np.savez(given, points=surface.points[used], triangles=triangles.reshape(-1, 3))
        except OSError as error:
            raise NeighbourError(f"fTetWild cannot be given the surface: {given}: {error.strerror or error}") from error
        _run([str(given), str(made), json.dumps(options)], folder, timeout, heard)
        if not made.exists():
            raise NeighbourError("fTetWild ended without a result")
        with np.load(made) as arrays:
            points, tets = arrays["points"], arrays["tets"]
    return _mesh(points, tets, surface)


def version() -> str:
    """Whose fTetWild is used; it does not tell its own version."""
    return f"(Python package pytetwild {metadata.version('pytetwild')})"


def _run(
    arguments: list[str], folder: str | Path, timeout: float | None, heard: Callable[[str], object] | None = None
) -> None:
    """Run the child in ``folder``: fTetWild leaves a file __tracked_surface.stl in its working directory."""
    # Without -P the working directory would be the first place to look for modules.
    lines = ["stdbuf", "-oL"] if shutil.which("stdbuf") else []  # or what it says comes when it has ended
    command = [*lines, sys.executable, "-P", "-m", "wct_plugin.adapters.ftetwild", *arguments]
    advice = "a larger epsilon or edge_length, fewer num_opt_iter or a repaired surface is faster"
    told = None if heard is None else lambda said: heard(_standing(said))
    child_process.run(command, folder, timeout, "fTetWild", advice=advice, heard=told)


def _standing(said: str) -> str:
    """Where fTetWild stands by what it printed: its pass, and the energy that it ends below ``stop_energy``."""
    passes = re.findall(r"/+ (?:pass (\d+)|(\w+)) /+", said)
    energies = re.findall(r"max_energy = (\S+)\n", said)
    words = [f"pass {int(passes[-1][0]) + 1}" if passes[-1][0] else passes[-1][1]] if passes else []
    return ", ".join([*words, *(f"worst energy {float(one):.3g}" for one in energies[-1:])])


def _mesh(points: Floats, tets: Ints, surface: SurfaceMesh) -> TetMesh:
    if not len(tets):
        raise NeighbourError("fTetWild filled nothing: is the surface open, or thinner than epsilon?")
    # Every tet of fTetWild comes negatively oriented. It is turned here, so that the mesh's count of repairs
    # is about the user's own data.
    used, tets = np.unique(predicates.turned(points, tets)[0], return_inverse=True)
    try:
        return TetMesh(points[used], tets.reshape(-1, 4), reference=surface, source=surface.source)
    except InputError as error:
        raise NeighbourError(f"fTetWild gave an unusable mesh: {error}") from error


def _child(given: str, made: str, options: str) -> None:
    # pytetwild imports pyvista for an accessor that is of no use here, and fails without it: an empty module will do.
    sys.modules["pyvista"] = ModuleType("pyvista")
    from pytetwild import pytetwild

    with np.load(given) as arrays:
        points, triangles = arrays["points"], arrays["triangles"].astype(np.int32)
    points, tets = pytetwild.tetrahedralize(points, triangles, quiet=False, **json.loads(options))
    np.savez(made, points=points, tets=tets.astype(np.int64))


if __name__ == "__main__":
    _child(*sys.argv[1:])
