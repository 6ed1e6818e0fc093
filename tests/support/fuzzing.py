"""What tests of the fuzzing share: small meshes, a mesh as a reader gives one, a case of a command over two tets."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from benchmarks.fuzz import random_mesh
from benchmarks.fuzz.command_case import Case
from benchmarks.fuzz.judge.result import Arrays

#: Two tets on one facet, in two regions.
POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
TETS = np.array([[0, 1, 2, 3], [1, 4, 2, 3]])
TWO = Arrays(POINTS, TETS, np.array([1, 2]), np.array([[0, 2, 1], [0, 1, 3]]), np.array([7, 8]))


def six_tets() -> tuple[Any, Any]:
    """Points and tets of a cube of six tets."""
    draw = SimpleNamespace(choice=lambda options: options[0], random=lambda: 0.5)
    return random_mesh._grid(draw, np.random.default_rng(0))  # type: ignore[arg-type]


def read_as(**doctored: Any) -> Any:
    """What has the parts of a mesh that was read, some of them doctored."""
    none: dict[str, Any] = {
        "vertices": np.empty((0, 1), np.int64),
        "tags": np.empty(0, np.int64),
        "data": {},
        "sets": {},
    }
    cells = {"facets": 3, "edges": 2, "nodes": 1}
    parts = {
        what: SimpleNamespace(**{**none, "vertices": np.empty((0, width), np.int64)}) for what, width in cells.items()
    }
    mesh = {"points": POINTS, "tets": TETS, "regions": np.array([1, 2]), "point_data": {}, "cell_data": {}, **parts}
    return SimpleNamespace(**{**mesh, "point_sets": {}, "tet_sets": {}, **doctored})


def command(folder: Path, goal: str = "delaunay") -> Case:
    """A case of ``wct optimize``, whose input is written into the folder."""
    mesh = random_mesh.Made("two", POINTS, TETS, np.array([1, 2]))
    mesh.write(folder / "in.vtu")
    arguments = ("optimize", "in.vtu", "out.vtu", "--json", "report.json", "--goal", "delaunay", "--quiet")
    return Case("optimize", arguments, ("in.vtu",), ("out.vtu", "report.json"), mesh, {"goal": goal})
