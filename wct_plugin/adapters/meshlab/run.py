"""MeshLab, through pymeshlab: any of its filters on a surface, in a process of its own.

An error poisons pymeshlab's process, a wrong index ends it, and it prints at will; so it never runs in ours. This file
is the parent's side; the other is :mod:`wct_plugin.adapters.meshlab.child`.
"""

import json
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from wct_plugin.adapters import child_process
from wct_plugin.adapters.meshlab import script
from wct_plugin.adapters.meshlab.carry import COLOUR, QUALITY, carry
from wct_plugin.errors import InputError, NeighbourError, OptionError
from wct_plugin.mesh import SurfaceMesh

Log = list[dict[str, Any]]


@dataclass(frozen=True)
class Step:
    """One filter to run: by its pymeshlab name, or, ``from_script``, by MeshLab's display name with texts."""

    filter: str
    where: str  #: how a message begins
    arguments: dict[str, Any] = field(default_factory=dict)
    from_script: bool = False


def read_script(path: str | Path) -> list[Step]:
    """The steps of an .mlx file; :class:`InputError` if it is missing, garbage or empty."""
    return [
        Step(name, f"{path}, filter {number} ({name!r})", arguments, from_script=True)
        for number, (name, arguments) in enumerate(script.read(Path(path)), 1)
    ]


def check(runs: Sequence[Sequence[Step]]) -> list[str]:
    """Ask pymeshlab for every filter, argument, type and declared range or choice, without a mesh.

    Gives for each of the ``runs`` its first fault, in one line that says what is allowed, or an empty text. Ranges that
    depend on the mesh (lengths, qualities) are checked when the filter's turn comes in :func:`run`.
    """
    with tempfile.TemporaryDirectory(prefix="wct_") as folder:
        faults: list[str] = _ask(runs, Path(folder), None, "filters.meshlab")["faults"]
    return faults


def run(surface: SurfaceMesh, steps: Sequence[Step], timeout: float | None = None) -> tuple[SurfaceMesh, Log]:
    """Run the steps one after the other on a surface.

    Parameters
    ----------
    surface : SurfaceMesh
        Quality (``quality``) and colour (``red green blue alpha``, 0..255) per point and triangle go along.
    steps : sequence of Step
        All are checked before the first runs.
    timeout : float or None
        Seconds after which MeshLab is ended; None waits for ever.

    Returns
    -------
    tuple of SurfaceMesh and list of dict
        The surface of the last step, with what :func:`wct_plugin.adapters.meshlab.carry.carry` could carry; and per
        step ``filter``, ``arguments`` (all that were used, lengths in the mesh's unit) and ``measures`` (what the
        filter returned).

    Raises
    ------
    OptionError
        For an unknown filter or argument and for a value it cannot take.
    NeighbourError
        If a filter fails, crashes, runs out of time or gives no surface or several.
    """
    with tempfile.TemporaryDirectory(prefix="wct_") as name:
        folder = Path(name)
        try:
            np.savez(folder / "given.npz", **_arrays(surface))
        except OSError as error:
            raise NeighbourError(f"MeshLab cannot be given the surface: {folder}: {error.strerror or error}") from error
        log: Log = _ask([steps], folder, timeout, steps[0].where if len(steps) == 1 else "filters.meshlab")["steps"]
        with np.load(folder / "made.npz") as arrays:
            made = {key: arrays[key] for key in arrays.files}
    what = steps[-1].where
    try:
        bare = SurfaceMesh(made.pop("points"), made.pop("triangles"), source=surface.source)
    except InputError as error:
        raise NeighbourError(f"{what} gave an unusable surface: {error}") from error
    return carry(surface, bare, made, what), log


def _ask(runs: Sequence[Sequence[Step]], folder: Path, timeout: float | None, who: str) -> dict[str, Any]:
    """Run the child in ``folder``; it does the one run on the surface there, and only checks where there is none."""
    content = [[asdict(step) for step in steps] for steps in runs]
    (folder / "runs.json").write_text(json.dumps(content), encoding="utf-8")
    # Without -P the working directory would be the first place to look for modules.
    command = [sys.executable, "-P", "-m", "wct_plugin.adapters.meshlab.child"]
    child_process.run(command, folder, timeout, who)
    try:
        answer: dict[str, Any] = json.loads((folder / "answer.json").read_text(encoding="utf-8"))
    except OSError as error:
        raise NeighbourError("MeshLab ended without a result") from error
    if "refused" in answer:
        raise OptionError(answer["refused"])
    if "failed" in answer:
        raise NeighbourError(answer["failed"])
    return answer


def _arrays(surface: SurfaceMesh) -> dict[str, Any]:
    """What MeshLab itself knows of: the surface, ``point quality``, ``triangle colour`` and so on, as it wants them."""
    out: dict[str, Any] = {"points": surface.points, "triangles": surface.triangles}
    for kind, data in (("point", surface.point_data), ("triangle", surface.cell_data)):
        quality = data.get(QUALITY)
        if quality is not None and quality.ndim == 1 and quality.dtype.kind in "fiu":
            out[f"{kind} quality"] = quality.astype(np.float64)
        bands = [data[name] for name in COLOUR if name in data]
        if all(name in data for name in COLOUR[:3]) and all(band.dtype == np.uint8 for band in bands):
            opaque = [np.full(len(bands[0]), 255)] * (4 - len(bands))
            out[f"{kind} colour"] = np.column_stack([*bands, *opaque]) / 255.0
    return out
